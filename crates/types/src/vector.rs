//! Products and lengths of small vectors.

#[inline]
pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The vector of length 1 in this direction; `None` when all entries are zero or subnormal, or one is not finite.
pub(crate) fn direction<const N: usize>(v: [f64; N]) -> Option<[f64; N]> {
    const EXPONENT: u64 = 0x7ff0_0000_0000_0000;
    if !v.iter().all(|x| x.is_finite()) {
        return None;
    }
    let largest = v.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
    if !largest.is_normal() {
        return None;
    }
    // Squares of very small and very large entries would be lost; dividing by a power of two first is exact.
    let scale = f64::from_bits(largest.to_bits() & EXPONENT);
    let scaled = v.map(|x| x / scale);
    let length = scaled.iter().map(|x| x * x).sum::<f64>().sqrt();
    Some(scaled.map(|x| x / length))
}
