//! Regions grown again, where errors are not all there is.

use std::cmp::Reverse;

use rayon::prelude::*;

use crate::Step;
use crate::around::Arounds;
use crate::cell::Noise;
use crate::field::{COARSE, Field};
use crate::grow::{Growing, Growth, Region};
use crate::slice::Surfaces;

/// How often: each time less is held by regions that come to nothing.
const TIMES: usize = 2;
/// Scatter of the means of coarser cells beyond the errors of their points, in units of the variance of those, that says nothing yet.
const USUAL_SHARED: f64 = 0.2;

/// Grows all regions again, those with most points first, without those whose orientation is less sure than `tilt`, in radians, and those
/// that are slices through clutter.
///
/// Where cells may scatter, planes can be laid through anything: what the surest seeds have taken, and keep, need not be the largest
/// surface, nor any.
pub(crate) fn grow_again(
    arounds: &mut Arounds,
    growth: Growth,
    mut regions: Vec<Region>,
    tilt: f64,
) -> Vec<Region> {
    let field = arounds.field();
    for _ in 0..TIMES {
        let before = regions.len();
        let flat = Surfaces::of(field, &regions);
        let is_slice = |region: &Region| growth.without != Some(Step::Slices) && flat.is_slice(field, region);
        let holds = |region: &Region| is_sure(field, growth.noise, region, tilt) && !is_slice(region);
        regions = regions.into_par_iter().filter(holds).collect();
        if regions.len() == before {
            break;
        }
        regions.sort_by_key(|region| Reverse(region.fitted.sums.count()));
        let mut growing = Growing::of(arounds, growth);
        regions = regions.iter().filter_map(|region| growing.again(region)).collect();
    }
    regions
}

/// Whether the orientation of a region is known to `tilt`, in radians, by the errors of its points and by what they share.
pub(crate) fn is_sure(field: &Field, noise: Noise, region: &Region, tilt: f64) -> bool {
    region.fitted.tilt <= tilt && shared_tilt(field, noise, region) <= tilt
}

/// Standard error of the orientation where it is least sure, in radians, by what the points of a coarser cell are off together: steps of
/// a sensor, bends, clutter. It goes down with the number of cells, not of points.
fn shared_tilt(field: &Field, noise: Noise, region: &Region) -> f64 {
    let (level, plane) = (&field.levels[COARSE], &region.fitted.plane);
    // In the order of the curve the cells of a group follow each other.
    let mut cells = region.cells.clone();
    cells.sort_unstable();
    let (mut all, mut squares, mut beyond) = (0.0, 0.0, 0.0);
    for group in cells.chunk_by(|a, b| level.group(*a as usize) == level.group(*b as usize)) {
        let (mut points, mut off, mut variance) = (0.0, 0.0, 0.0);
        for cell in group.iter().map(|cell| &field.cells[*cell as usize]) {
            points += cell.points;
            off += cell.points * plane.distance(cell.mean);
            variance += cell.points * noise.variance(cell, plane.normal);
        }
        all += points;
        squares += points * points;
        beyond += off * off / points - variance / points;
    }
    let [_, across, _] = region.fitted.fit.variances;
    let shared = beyond / all - USUAL_SHARED * region.fitted.variance;
    (shared.max(0.0) * squares / (all * all) / across).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grow::grow;
    use crate::scene::{NOISE, field, square};

    const SPREAD: Growth = Growth { noise: NOISE, spread: 3.0, without: None };

    #[test]
    fn errors_of_points_alone_are_not_shared_and_steps_are() {
        let tilt = |height: &dyn Fn(f64, f64) -> f64| {
            let field = field(&square(|x, y| [x, y, 0.05 + height(x, y)]));
            let regions = grow(&mut Arounds::of(&field), SPREAD);
            shared_tilt(&field, NOISE, &regions[0])
        };
        // Up and down by an error from point to point.
        let even = |x: f64, y: f64| 0.02 * ((x + y) * 50.0 * std::f64::consts::PI).cos().signum();
        assert_eq!(tilt(&even).to_bits(), 0.0_f64.to_bits());
        // And from tile to tile of four cells: nine of them, each off by one and a half errors.
        let tiles =
            |x: f64, y: f64| if ((x / 0.4).floor() + (y / 0.4).floor()) % 2.0 == 0.0 { 0.03 } else { -0.03 };
        let found = tilt(&tiles);
        // 36 coarser cells over a square of 1.2 m.
        let expected = (0.03_f64.powi(2) - 0.2 * 0.02_f64.powi(2)).sqrt() / 6.0 / (1.2 / 12.0_f64.sqrt());
        assert!((found / expected - 1.0).abs() < 0.1, "{found} {expected}");
    }

    #[test]
    fn what_an_unsure_region_held_is_given_back() {
        let field = field(&square(|x, y| [x, y, 0.05]));
        let mut arounds = Arounds::of(&field);
        let grown = grow(&mut arounds, SPREAD);
        let [whole] = &grown[..] else { panic!() };
        assert_eq!(grow_again(&mut arounds, SPREAD, grown.clone(), 0.01)[0].cells, whole.cells);
        assert!(grow_again(&mut arounds, SPREAD, grown.clone(), 1e-9).is_empty());
        // One half is held by a region whose orientation is not known.
        let (own, held) = whole.cells.split_at(whole.cells.len() / 2);
        let of = |cells: &[u32]| Region {
            cells: cells.to_vec(),
            fitted: field.fit(cells, NOISE).unwrap(),
            seed: whole.seed,
        };
        let mut unsure = of(held);
        unsure.fitted.tilt = 0.1;
        let again = grow_again(&mut arounds, SPREAD, vec![unsure, of(own)], 0.01);
        let [region] = &again[..] else { panic!() };
        assert_eq!(region.cells.len(), whole.cells.len());
    }
}
