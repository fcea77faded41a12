//! What the labelled points of a region look like: area and bend.

use foldhash::fast::FixedState;
use glam::DVec3;
use hashbrown::HashMap;

use crate::bend::{Bend, Column};
use crate::field::Field;
use crate::flat::Fitted;
use crate::labels::Piece;

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

/// How many columns of single cells are covered; a wide one covers four, from its own on.
fn covered(columns: impl Iterator<Item = ([i32; 2], bool)>) -> usize {
    let of_each = |([a, b], is_wide): ([i32; 2], bool)| {
        let all = [[a, b], [a + 1, b], [a, b + 1], [a + 1, b + 1]];
        all.into_iter().take(if is_wide { 4 } else { 1 })
    };
    let mut covered: Vec<[i32; 2]> = columns.flat_map(of_each).collect();
    covered.sort_unstable();
    covered.dedup();
    covered.len()
}

impl Looks {
    pub(crate) fn of<'p>(field: &Field, fitted: &Fitted, pieces: impl Iterator<Item = &'p Piece>) -> Self {
        let normal = fitted.plane.normal;
        let axis = (0..3).max_by(|a, b| normal[*a].abs().total_cmp(&normal[*b].abs())).unwrap_or(2);
        let pieces: Vec<&Piece> = pieces.collect();
        let column_of = |piece: &Piece| {
            let key = field.keys[piece.cell as usize];
            [key[(axis + 1) % 3], key[(axis + 2) % 3]]
        };
        // In the order in which they are met.
        let mut numbers: HashMap<[i32; 2], usize, FixedState> = HashMap::default();
        let (mut all, mut squares) = (0, 0.0);
        let mut columns: Vec<Sum> = Vec::new();
        for piece in &pieces {
            let number = *numbers.entry(column_of(piece)).or_insert(columns.len());
            if number == columns.len() {
                columns.push(Sum::default());
            }
            let anchor = field.anchors[piece.cell as usize] - fitted.plane.point;
            let points = f64::from(piece.points);
            if let Some(column) = columns.get_mut(number) {
                column.points += points;
                column.place += piece.sum + anchor * points;
            }
            all += u64::from(piece.points);
            squares += piece.squares;
        }
        let covered = if pieces.iter().any(|piece| field.is_wide(piece.cell as usize)) {
            covered(pieces.iter().map(|piece| (column_of(piece), field.is_wide(piece.cell as usize))))
        } else {
            columns.len()
        };
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
