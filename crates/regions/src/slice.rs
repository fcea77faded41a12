//! Slices through clutter: planes that points go on beyond.

use crate::field::Field;
use crate::grow::Region;

/// Points within so many standard deviations of a plane are of it, and those up to the second number lie just beyond.
const WITHIN: f64 = 3.0;
const BEYOND: f64 = 9.0;
/// A surface has fewer points just beyond it, on both sides together, than this share of its own. Through clutter of even density there
/// are twice as many.
const MOST_BEYOND: f64 = 0.5;
/// Of regions that scatter by no more than this, in units of the variance of errors, no point is clutter.
const FLAT: f64 = 2.0;
/// Columns are two cells wide: wide enough not to be empty by chance.
const COLUMN: u32 = 1;
/// So many cells say enough: of regions of more, some of the columns are looked at.
const ENOUGH: usize = 512;

/// The cells of all regions that are as flat as errors say.
pub(crate) struct Surfaces(Vec<bool>);

impl Surfaces {
    pub(crate) fn of(field: &Field, regions: &[Region]) -> Self {
        let mut of = vec![false; field.cells.len()];
        for region in regions.iter().filter(|region| region.fitted.reduced_chi_squared <= FLAT) {
            region.cells.iter().for_each(|cell| of[*cell as usize] = true);
        }
        Self(of)
    }

    /// Whether a region is a slice: over its own columns points go on beyond it as if it were not there. In front of a surface there is
    /// air, or it would not have been seen, and behind it nothing is seen; or from elsewhere another surface, as of a thin wall.
    pub(crate) fn is_slice(&self, field: &Field, region: &Region) -> bool {
        let [within, beyond] = counted(field, region, &self.0);
        beyond > MOST_BEYOND * within
    }
}

/// The points of the columns of a region within its scatter, and just beyond it as far as the coarsest groups around it reach, but for those
/// of surfaces.
fn counted(field: &Field, region: &Region, surfaces: &[bool]) -> [f64; 2] {
    let (plane, fitted) = (&region.fitted.plane, &region.fitted);
    let normal = plane.normal;
    let axis = (0..3).max_by(|a, b| normal[*a].abs().total_cmp(&normal[*b].abs())).unwrap_or(2);
    let share = (region.cells.len() / ENOUGH).max(1).ilog2();
    let column_of = |cell: u32| {
        let key = field.keys[cell as usize];
        let column = [key[(axis + 1) % 3] >> COLUMN, key[(axis + 2) % 3] >> COLUMN];
        is_drawn(column, share).then_some(column)
    };
    let mut columns: Vec<[i32; 2]> = region.cells.iter().filter_map(|cell| column_of(*cell)).collect();
    columns.sort_unstable();
    columns.dedup();
    let Some(level) = field.levels.last() else { return [0.0; 2] };
    let mut groups: Vec<u32> = region.cells.iter().map(|cell| level.group(*cell as usize)).collect();
    // Most follow each other.
    groups.dedup();
    groups.sort_unstable();
    groups.dedup();
    let near: Vec<u32> = groups.iter().flat_map(|group| level.near(*group as usize)).copied().collect();
    groups.extend(near);
    groups.sort_unstable();
    groups.dedup();
    let [thickness, ..] = fitted.fit.variances;
    let deviation = thickness.max(fitted.variance).sqrt();
    let mut points = [0.0; 2];
    for cell in groups.iter().flat_map(|group| level.cells(*group as usize)) {
        let Some(column) = column_of(cell) else { continue };
        let sums = &field.cells[cell as usize];
        let off = plane.distance(sums.mean).abs();
        let is_beyond = off >= WITHIN * deviation;
        let is_counted = off < BEYOND * deviation && !(is_beyond && surfaces[cell as usize]);
        if is_counted && columns.binary_search(&column).is_ok() {
            points[usize::from(is_beyond)] += sums.points;
        }
    }
    points
}

/// Whether a column is among one in 2ˢ, spread without a pattern.
fn is_drawn([x, y]: [i32; 2], share: u32) -> bool {
    let mixed = (x.wrapping_mul(0x2c1b_3c6d) ^ y.wrapping_mul(0x297a_2d39)).wrapping_mul(0x1656_67b1);
    mixed.cast_unsigned().leading_zeros() >= share
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::around::Arounds;
    use crate::grow::{Growth, grow};
    use crate::scene::{NOISE, field, square};
    use crate::seeds::Seed;
    use proptest::prelude::*;

    const SPREAD: Growth = Growth { noise: NOISE, spread: 3.0, without: None };

    fn region(field: &Field, cells: Vec<u32>) -> Option<Region> {
        let fitted = field.fit(&cells, NOISE)?;
        Some(Region { cells, fitted, seed: Seed { level: 0, group: 0 } })
    }

    /// Counts of points, which are whole.
    fn whole(counts: [f64; 2]) -> [u32; 2] {
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "as many as there are points"
        )]
        counts.map(|count| count as u32)
    }

    /// A cube with an edge of 1.2 m.
    fn clutter(points: u32) -> Vec<[f64; 3]> {
        let place = |k: u32, by: f64| 1.2 * (f64::from(k) * by).fract();
        (0..points).map(|k| [0.8192, 0.6711, 0.5497].map(|by| place(k, by))).collect()
    }

    fn layer(field: &Field, heights: std::ops::Range<i32>) -> Vec<u32> {
        (0..).zip(&field.keys).filter(|(_, key)| heights.contains(&key[2])).map(|(cell, _)| cell).collect()
    }

    #[test]
    fn nothing_is_beyond_a_surface() {
        let mut points = square(|x, y| [x, y, 0.05 + 0.2 * x]);
        let seen = |points: &[[f64; 3]]| {
            let field = field(points);
            let regions = grow(&mut Arounds::of(&field), SPREAD);
            let none = vec![false; field.cells.len()];
            (whole(counted(&field, &regions[0], &none)), Surfaces(none).is_slice(&field, &regions[0]))
        };
        assert_eq!(seen(&points), ([3600, 0], false));
        // Points that are there twice.
        assert_eq!(seen(&[&points[..], &points].concat()), ([7200, 0], false));
        // A second surface behind it, and things on a tenth of it.
        points.extend(square(|x, y| [x, y, 0.45 + 0.2 * x]).iter().filter(|[x, ..]| *x < 0.12));
        let ([_, beyond], slice) = seen(&points);
        assert!(beyond <= 400 && !slice, "{beyond}");
    }

    #[test]
    fn a_layer_of_clutter_is_a_slice() {
        let field = field(&clutter(30_000));
        let layer = region(&field, layer(&field, 5..7)).unwrap();
        let none = vec![false; field.cells.len()];
        let [within, beyond] = counted(&field, &layer, &none);
        assert!((1.4..2.2).contains(&(beyond / within)), "{within} {beyond}");
        assert!(Surfaces(none).is_slice(&field, &layer));
    }

    #[test]
    fn the_faces_of_a_thin_wall_are_no_slices() {
        // Up and down by an error from point to point, and seven errors apart.
        let face = |height: f64| {
            square(|x, y| [x, y, height + 0.02 * ((x + y) * 50.0 * std::f64::consts::PI).cos().signum()])
        };
        let field = field(&[face(0.05), face(0.19)].concat());
        let faces: Vec<Region> = [0..1, 1..2].map(|keys| region(&field, layer(&field, keys)).unwrap()).into();
        let none = Surfaces(vec![false; field.cells.len()]);
        assert!(faces.iter().all(|face| none.is_slice(&field, face)));
        let both = Surfaces::of(&field, &faces);
        assert!(!faces.iter().any(|face| both.is_slice(&field, face)));
    }

    #[test]
    fn one_column_in_so_many_is_drawn() {
        for share in 0..5 {
            let drawn = (0..200 * 200).filter(|k| is_drawn([k % 200 - 90, k / 200 - 90], share)).count();
            let expected = f64::from((200 * 200) >> share);
            assert!((drawn as f64 / expected - 1.0).abs() < 0.1, "{share} {drawn}");
        }
    }

    #[test]
    fn one_cell_is_counted_and_points_in_a_line_are_no_region() {
        let one = field(&[[0.01, 0.01, 0.05], [0.09, 0.01, 0.05], [0.01, 0.09, 0.05], [0.09, 0.09, 0.05]]);
        assert_eq!(whole(counted(&one, &region(&one, vec![0]).unwrap(), &[false])), [4, 0]);
        let line: Vec<[f64; 3]> = (0..100).map(|k| [0.01 * f64::from(k), 0.05, 0.05]).collect();
        let line = field(&line);
        assert!(region(&line, (0..10).collect()).is_none() && region(&line, Vec::new()).is_none());
    }

    proptest! {
        #[test]
        fn what_is_counted_is_what_a_look_at_all_cells_finds(
            points in prop::collection::vec(prop::array::uniform3(0.0..1.2_f64), 50..400),
            first in 0..10_i32,
            surfaces in prop::collection::vec(any::<bool>(), 400),
        ) {
            let field = field(&points);
            let Some(layer) = region(&field, layer(&field, first..first + 2)) else { return Ok(()) };
            let plane = layer.fitted.plane;
            let axis = plane.normal.abs().max_position();
            let column = |cell: u32| [1, 2].map(|i| field.keys[cell as usize][(axis + i) % 3].div_euclid(2));
            let deviation = layer.fitted.fit.variances[0].max(layer.fitted.variance).sqrt();
            let mut expected = [0.0; 2];
            for (cell, sums) in (0..).zip(&field.cells) {
                let off = plane.distance(sums.mean).abs() / deviation;
                let counts = off < WITHIN || !surfaces[cell as usize];
                if off < BEYOND && counts && layer.cells.iter().any(|own| column(*own) == column(cell)) {
                    expected[usize::from(off >= WITHIN)] += sums.points;
                }
            }
            prop_assert_eq!(whole(counted(&field, &layer, &surfaces)), whole(expected));
        }
    }
}
