//! Products and directions of 3-vectors.

use std::ops::RangeInclusive;

/// Squared lengths at which no square was lost that counts, and none overflowed.
const SAFE_SQUARES: RangeInclusive<f64> = 1e-200..=1e200;

/// Scalar product.
pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Vector product.
pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// `a − b`.
pub(crate) fn difference(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// The unit vector along `v`, and the length of `v`; `None` when `v` is zero, subnormal, or an entry or the length is
/// not finite.
pub(crate) fn direction(v: [f64; 3]) -> Option<([f64; 3], f64)> {
    let square = dot(v, v);
    if SAFE_SQUARES.contains(&square) {
        let length = square.sqrt();
        return Some((v.map(|x| x / length), length));
    }
    let largest = v.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
    // `max` passes over NaN.
    if !largest.is_normal() || v.iter().any(|x| x.is_nan()) {
        return None;
    }
    // Squares of very small and very large entries would be lost.
    let scaled = v.map(|x| x / largest);
    let length = dot(scaled, scaled).sqrt();
    let whole = largest * length;
    whole.is_finite().then(|| (scaled.map(|x| x / length), whole))
}
