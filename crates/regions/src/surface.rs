//! What the labelled points of a region look like: area and bend.

use foldhash::fast::FixedState;
use glam::DVec3;
use hashbrown::HashMap;

use crate::bend::{Bend, Column};
use crate::field::Field;
use crate::flat::Fitted;
use crate::labels::{Piece, Whereabouts};

/// Points and the sum of their places from the centroid.
#[derive(Default, Clone, Copy)]
struct Sum {
    points: f64,
    place: DVec3,
}

/// The points of a region in columns along the main axis of its normal, each as wide as a cell.
pub(crate) struct Looks {
    columns: Vec<Column>,
    pub(crate) points: u64,
    /// Their mean, in metres.
    pub(crate) centroid: DVec3,
    /// Their root mean square distance from the plane, in metres.
    pub(crate) rms: f64,
    /// In m².
    pub(crate) area: f64,
}

/// Columns of cells by their keys, and their numbers in the order in which they are met.
type Numbers = HashMap<[i32; 2], usize, FixedState>;

/// How many columns of single cells are covered. `is_wide` tells by number whether a wide cell is in a column: it covers four, from this one
/// on, whose keys are even.
fn covered(columns: &Numbers, is_wide: &[bool]) -> usize {
    let of_each = |([a, b], number): (&[i32; 2], &usize)| {
        let is_wide = |number: &usize| is_wide[*number];
        if is_wide(number) {
            return 4;
        }
        usize::from(!columns.get(&[a & !1, b & !1]).is_some_and(is_wide))
    };
    columns.iter().map(of_each).sum()
}

impl Looks {
    pub(crate) fn of(field: &Field, fitted: &Fitted, pieces: &[(Piece, Whereabouts)]) -> Self {
        let normal = fitted.plane.normal;
        let axis = (0..3).max_by(|a, b| normal[*a].abs().total_cmp(&normal[*b].abs())).unwrap_or(2);
        let column_of = |piece: &Piece| {
            let key = field.keys[piece.cell as usize];
            [key[(axis + 1) % 3], key[(axis + 2) % 3]]
        };
        let mut numbers = Numbers::default();
        let (mut all, mut squares) = (0, 0.0);
        let (mut columns, mut is_wide): (Vec<Sum>, Vec<bool>) = (Vec::new(), Vec::new());
        for (piece, points_are) in pieces {
            let number = *numbers.entry(column_of(piece)).or_insert(columns.len());
            if number == columns.len() {
                columns.push(Sum::default());
                is_wide.push(false);
            }
            is_wide[number] |= field.is_wide(piece.cell as usize);
            let anchor = field.anchors[piece.cell as usize] - fitted.plane.point;
            let points = f64::from(piece.points);
            if let Some(column) = columns.get_mut(number) {
                column.points += points;
                column.place += points_are.sum + anchor * points;
            }
            all += u64::from(piece.points);
            squares += points_are.squares;
        }
        let covered = if is_wide.contains(&true) { covered(&numbers, &is_wide) } else { columns.len() };
        let area = covered as f64 * field.edge * field.edge / normal[axis].abs();
        let [u, v] = fitted.fit.axes.map(DVec3::from);
        let column = |sum: &Sum| {
            let mean = sum.place / sum.points;
            Column { points: sum.points, place: [mean.dot(u), mean.dot(v)], height: mean.dot(normal) }
        };
        let off: DVec3 = columns.iter().map(|column| column.place).sum();
        Self {
            columns: columns.iter().map(column).collect(),
            points: all,
            centroid: fitted.plane.point + off / all as f64,
            rms: (squares / all as f64).sqrt(),
            area,
        }
    }

    /// How the surface is bent, with this variance of a point's error along the normal, in m².
    pub(crate) fn bend(&self, variance: f64) -> Option<Bend> {
        Bend::of(&self.columns, variance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeSet;

    proptest! {
        #[test]
        fn columns_are_covered_once(
            cells in prop::collection::vec((prop::array::uniform2(-4..4_i32), any::<bool>()), 0..40),
        ) {
            let (mut numbers, mut wide, mut all) = (Numbers::default(), Vec::new(), BTreeSet::new());
            for (key, is_wide) in cells {
                let key = if is_wide { key.map(|k| k & !1) } else { key };
                let number = *numbers.entry(key).or_insert(wide.len());
                wide.resize(wide.len().max(number + 1), false);
                wide[number] |= is_wide;
                let wide = if is_wide { 4 } else { 1 };
                all.extend((0..wide).map(|step| [key[0] + step % 2, key[1] + step / 2]));
            }
            prop_assert_eq!(covered(&numbers, &wide), all.len());
        }
    }
}
