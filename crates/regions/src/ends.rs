//! Where planes end at each other.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::LazyLock;

use glam::DVec3;
use rayon::prelude::*;

use crate::cell::{Noise, Sums};
use crate::field::{COARSE, Field};
use crate::flat::Flat;
use crate::grow::Region;
use crate::level::Level;

/// A plane ends at another when this share of its points near it lies on one side.
const ONE_SIDED: f64 = 0.95;
/// Planes with a smaller sine of the angle between them do not end at each other.
const STEEPEST: f64 = 0.3;

/// The side of a plane on which another is that ends there: 1 where its normal points, else -1.
#[derive(Debug, Default)]
pub(crate) struct Ends {
    /// By the plane that ends and the one it ends at.
    side: BTreeMap<(u32, u32), f64>,
}

/// The regions of each of some groups.
struct Held {
    regions: Vec<u32>,
    starts: Vec<usize>,
}

impl Held {
    fn of(level: &Level, groups: Range<usize>, region_of: &[Option<u32>]) -> Self {
        let (mut regions, mut starts): (Vec<u32>, Vec<usize>) = (Vec::new(), vec![0]);
        for group in groups {
            let first = regions.len();
            for region in level.cells(group).filter_map(|cell| region_of[cell as usize]) {
                if !regions[first..].contains(&region) {
                    regions.push(region);
                }
            }
            starts.push(regions.len());
        }
        Self { regions, starts }
    }

    fn of_group(&self, at: usize) -> &[u32] {
        &self.regions[self.starts[at]..self.starts[at + 1]]
    }
}

impl Ends {
    /// Looks at the cells of each region near those of another, off its plane by at least an error.
    pub(crate) fn of(field: &Field, noise: Noise, region_of: &[Option<u32>], regions: &[Region]) -> Self {
        let level = &field.levels[COARSE];
        // As many parts as threads: what they found is put together in the end, in sums of whole numbers.
        let at_once = level.len().div_ceil(rayon::current_num_threads()).max(1);
        let parts = || (0..level.len()).into_par_iter().step_by(at_once);
        let part = |first: usize| first..(first + at_once).min(level.len());
        let held: Vec<Held> = parts().map(|first| Held::of(level, part(first), region_of)).collect();
        let of_group = |group: usize| held[group / at_once].of_group(group % at_once);
        let of_part = |first: usize| {
            let mut sides: BTreeMap<(u32, u32), [f64; 2]> = BTreeMap::new();
            let mut here: Vec<u32> = Vec::new();
            for group in part(first) {
                let [own, ..] = of_group(group) else { continue };
                here.clear();
                here.push(*own);
                let around =
                    std::iter::once(group).chain(level.near(group).iter().map(|near| *near as usize));
                for region in around.flat_map(of_group) {
                    if !here.contains(region) {
                        here.push(*region);
                    }
                }
                if here.len() < 2 {
                    continue;
                }
                for cell in level.cells(group) {
                    let (Some(own), sums) = (region_of[cell as usize], &field.cells[cell as usize]) else {
                        continue;
                    };
                    for other in here.iter().filter(|other| **other != own) {
                        let plane = &regions[*other as usize].fitted.plane;
                        let off = plane.distance(sums.mean);
                        if off * off > noise.variance(sums, plane.normal) {
                            sides.entry((own, *other)).or_default()[usize::from(off > 0.0)] += sums.points;
                        }
                    }
                }
            }
            sides
        };
        let mut sides: BTreeMap<(u32, u32), [f64; 2]> = BTreeMap::new();
        for (pair, more) in parts().map(of_part).collect::<Vec<_>>().into_iter().flatten() {
            let all = sides.entry(pair).or_default();
            *all = [all[0] + more[0], all[1] + more[1]];
        }
        let one_sided = |[below, above]: [f64; 2]| {
            let least = ONE_SIDED * (below + above);
            if above > least { Some(1.0) } else { (below > least).then_some(-1.0) }
        };
        Self { side: sides.into_iter().filter_map(|(pair, of)| Some((pair, one_sided(of)?))).collect() }
    }

    /// Where `plane` ends at `at`, seen from a cell; `None` when it does not.
    pub(crate) fn between(
        &self,
        (number, plane): (u32, &Flat),
        (at_number, at): (u32, &Flat),
        (cell, anchor): (&Sums, DVec3),
        noise: Noise,
    ) -> Option<End> {
        let side = self.side.get(&(number, at_number))?;
        let cosine = plane.normal.dot(at.normal);
        let sine = (1.0 - cosine * cosine).sqrt();
        if sine < STEEPEST {
            return None;
        }
        // In the plane, across the line in which both meet.
        let across = (at.normal - plane.normal * cosine) / sine;
        let inside = (at.distance(anchor) - cosine * plane.distance(anchor)) / sine;
        let per_error = side / noise.variance(cell, across).sqrt();
        // In single precision, as places are.
        #[allow(clippy::cast_possible_truncation)]
        let single = |x: f64| (x * per_error) as f32;
        Some(End { across: across.to_array().map(single), inside: single(inside) })
    }
}

/// The end of a plane as seen from the anchor of a cell: how far a place is inside it, in standard errors of a point.
#[derive(Debug, Clone, Copy)]
pub(crate) struct End {
    across: [f32; 3],
    inside: f32,
}

impl End {
    /// The logarithm of the probability that a point measured there is of a place inside.
    #[inline]
    pub(crate) fn ln_inside(&self, [x, y, z]: [f32; 3]) -> f32 {
        let [a, b, c] = self.across;
        let place = (self.inside + (a * x + b * y + c * z)).clamp(LOWEST, HIGHEST);
        let at = (place - LOWEST) * PER_UNIT;
        // From 0 to the number of steps: clamped above.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let step = at as usize;
        match LN_NORMAL.get(step..) {
            Some([below, above, ..]) => below + (above - below) * (at - step as f32),
            _ => 0.0,
        }
    }
}

/// Between these the logarithm is read from a table with so many steps a unit, straight between them: to 1.3·10⁻⁴.
const LOWEST: f32 = -7.0;
const HIGHEST: f32 = 5.0;
const PER_UNIT: f32 = 32.0;
static LN_NORMAL: LazyLock<Vec<f32>> = LazyLock::new(|| {
    // In single precision, as it is used.
    #[allow(clippy::cast_possible_truncation)]
    let at = |step: u16| ln_normal(f64::from(LOWEST + f32::from(step) / PER_UNIT)) as f32;
    (0..12 * 32).map(at).chain([0.0]).collect()
});

/// ln Φ of the standard normal distribution; not below that of 7 standard deviations, so that no point is ruled out by one end.
fn ln_normal(x: f64) -> f64 {
    if x > 5.0 { 0.0 } else { (0.5 * libm::erfc(-x.max(-7.0) / std::f64::consts::SQRT_2)).ln() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probabilities_are_those_of_tables() {
        for (x, probability) in
            [(0.0, 0.5), (1.0, 0.841_344_746), (-1.0, 0.158_655_254), (-3.0, 0.001_349_898)]
        {
            assert!((ln_normal(x).exp() - probability).abs() < 1e-9, "{x}");
        }
        assert_eq!(ln_normal(40.0).to_bits(), 0.0_f64.to_bits());
        assert!(ln_normal(-1e9).is_finite());
    }

    #[test]
    fn the_table_is_as_close_as_it_says() {
        for k in -9000..7000_i16 {
            let inside = f32::from(k) / 1000.0;
            let end = End { across: [0.0; 3], inside };
            let exact = ln_normal(f64::from(inside));
            let off = (f64::from(end.ln_inside([0.0; 3])) - exact).abs();
            assert!(off < 1.3e-4, "{off} at {inside}");
        }
    }
}
