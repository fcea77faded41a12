//! Where the points of a cell can be.

use glam::DVec3;

use crate::field::Field;
use crate::near::Near;

/// What rounding, of places too, may add to a distance, as a share of it.
const ROUNDING: f32 = 1e-3;

/// A cube that all points of a cell are in, seen from the anchor of the cell.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cube {
    middle: [f32; 3],
    /// From the middle to a face.
    half: f32,
}

impl Cube {
    pub(crate) fn of(field: &Field, cell: usize, anchor: DVec3) -> Self {
        let (middle, half) = if field.is_wide(cell) {
            // The anchor of a wide cell is its middle.
            (DVec3::ZERO, field.edge)
        } else if field.are_parts {
            let half = 0.5 * field.edge;
            (DVec3::from(field.keys[cell].map(|k| if k & 1 == 0 { -half } else { half })), half)
        } else {
            // Points are no farther from their mean than the cell is wide.
            (field.cells[cell].mean - anchor, field.edge)
        };
        // As places are.
        #[allow(clippy::cast_possible_truncation)]
        let (middle, half) = (middle.to_array().map(|x| x as f32), half as f32);
        Self { middle, half }
    }

    /// Whether all points are within the reach of a region: no standard errors.
    pub(crate) fn is_within(&self, near: &Near, reach: f32) -> bool {
        let (middle, half) = self.errors(near);
        (middle + half) * (1.0 + ROUNDING) <= reach
    }

    /// Whether none is.
    pub(crate) fn is_beyond(&self, near: &Near, reach: f32) -> bool {
        let (middle, half) = self.errors(near);
        middle > (reach + half) * (1.0 + ROUNDING)
    }

    /// How far the middle is from a region, and how much farther a corner can be, in standard errors.
    fn errors(&self, near: &Near) -> (f32, f32) {
        let ([a, b, c], [x, y, z]) = (near.normal, self.middle);
        let middle = a * x + b * y + c * z + near.offset;
        (middle.abs(), (a.abs() + b.abs() + c.abs()) * self.half)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]

    use super::*;
    use crate::{Cell, Cells};
    use proptest::prelude::*;
    use terrace_stats::{Stats, UncertainVector};

    const EDGE: f64 = 0.3;

    /// Cells that are told about the middle of the wide cell whose part they are.
    struct Parts(Vec<Cell>);

    impl Cells for Parts {
        fn count(&self) -> usize {
            self.0.len()
        }

        fn key(&self, at: usize) -> [i32; 3] {
            self.0[at].key
        }

        fn is_wide(&self, at: usize) -> bool {
            self.0[at].is_wide
        }

        fn stats(&self, at: usize) -> Stats {
            self.0[at].stats
        }

        fn are_parts(&self) -> bool {
            true
        }
    }

    #[test]
    fn the_cube_of_a_part_is_an_eighth_of_the_wide_cell() {
        // All parts of a wide cell with a point near one corner each, and a wide cell beside.
        let middle = [-EDGE, EDGE, 5.0 * EDGE];
        let part = |k: i32| {
            let key = [k >> 2, k >> 1 & 1, k & 1];
            let mut stats = Stats::new(middle);
            let place = key.map(|k| if k == 0 { -0.99 } else { 0.01 } * EDGE);
            stats.push(&UncertainVector::exact([0, 1, 2].map(|i| middle[i] + place[i])));
            Cell { key: [key[0] - 2, key[1], key[2] + 4], is_wide: false, stats }
        };
        let mut wide = Stats::new([EDGE, EDGE, 5.0 * EDGE]);
        wide.push(&UncertainVector::exact([0.0, 0.0, 4.0 * EDGE]));
        let beside = Cell { key: [0, 0, 4], is_wide: true, stats: wide };
        let cells: Vec<Cell> = (0..8).map(part).chain([beside]).collect();
        let field = Field::of_each(&Parts(cells), EDGE).unwrap();
        for (cell, anchor) in field.anchors.iter().enumerate() {
            let Cube { middle, half } = Cube::of(&field, cell, *anchor);
            let own = (field.cells[cell].mean - *anchor).to_array();
            let off = (0..3).map(|i| (own[i] - f64::from(middle[i])).abs());
            let farthest = off.fold(0.0, f64::max);
            let expected = if field.is_wide(cell) { [EDGE, EDGE] } else { [0.5 * EDGE, 0.49 * EDGE] };
            let found = [f64::from(half), farthest];
            assert!((0..2).all(|i| (found[i] - expected[i]).abs() < 1e-6), "{found:?} {expected:?}");
        }
    }

    #[test]
    fn a_plane_beside_a_cube_is_beyond() {
        let near = Near { region: 0, normal: [100.0, 0.0, 0.0], offset: -20.0, prior: 0.0, ends: (0, 0) };
        let cube = Cube { middle: [0.1, 0.0, 0.0], half: 0.05 };
        // From 5 to 15 errors away.
        assert!(!cube.is_beyond(&near, 5.1) && cube.is_beyond(&near, 4.9));
        assert!(!cube.is_within(&near, 14.9) && cube.is_within(&near, 15.1));
        let unknown = Near { offset: f32::NAN, ..near };
        assert!(!cube.is_beyond(&unknown, 5.0) && !cube.is_within(&unknown, 5.0));
    }

    proptest! {
        #[test]
        fn points_are_where_the_cube_says(
            normal in prop::array::uniform3(-200.0..200.0_f32),
            middle in prop::array::uniform3(-0.1..0.1_f32),
            point in prop::array::uniform3(-1.0..=1.0_f32),
            (offset, half, reach) in (-60.0..60.0_f32, 0.0..0.2_f32, 0.0..8.0_f32),
        ) {
            let near = Near { region: 0, normal, offset, prior: 0.0, ends: (0, 0) };
            let cube = Cube { middle, half };
            let point = [0, 1, 2].map(|i| middle[i] + half * point[i]);
            let reached = near.errors(point, reach).is_some();
            prop_assert!(!(cube.is_beyond(&near, reach) && reached));
            prop_assert!(!cube.is_within(&near, reach) || reached);
        }
    }
}
