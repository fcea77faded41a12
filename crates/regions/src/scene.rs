//! Cells of surfaces without noise, for the tests of what works on them.

use std::collections::BTreeMap;

use terrace_stats::{Stats, UncertainVector};

use crate::Cell;
use crate::cell::Noise;
use crate::field::Field;

/// In metres.
pub(crate) const EDGE: f64 = 0.1;
/// The error of a point that is stated, in metres.
pub(crate) const SIGMA: f64 = 0.02;
/// Taken as it is stated.
pub(crate) const NOISE: Noise = Noise { scale: 1.0, floor: 1e-4 };

/// A square of 1.2 m, points 2 cm apart and not along the cells.
pub(crate) fn square(place: impl Fn(f64, f64) -> [f64; 3]) -> Vec<[f64; 3]> {
    let at = |k: i32| 0.02 * f64::from(k) + 0.007;
    (0..60 * 60).map(|k| place(at(k % 60), at(k / 60))).collect()
}

/// The cells that points are in, by their keys.
pub(crate) fn field(points: &[[f64; 3]]) -> Field {
    let mut field = ungrown(points);
    field.begin_growth();
    field
}

/// The same before growth begins.
pub(crate) fn ungrown(points: &[[f64; 3]]) -> Field {
    let mut cells: BTreeMap<[i32; 3], Stats> = BTreeMap::new();
    for point in points {
        #[allow(clippy::cast_possible_truncation, reason = "squares are small")]
        let key = point.map(|x| (x / EDGE).floor() as i32);
        let anchor = key.map(|k| (f64::from(k) + 0.5) * EDGE);
        let stats = cells.entry(key).or_insert_with(|| Stats::new(anchor));
        stats.push(&UncertainVector::isotropic(*point, SIGMA));
    }
    let cells: Vec<Cell> =
        cells.into_iter().map(|(key, stats)| Cell { key, is_wide: false, stats }).collect();
    Field::of(&cells, EDGE).unwrap()
}
