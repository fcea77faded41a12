//! The covariance of a point.

use std::ops::Add;

use crate::vector::{direction, dot};

/// The covariance of a point in the world, in m²: symmetric, positive semidefinite up to rounding.
///
/// Independent errors add:
///
/// ```
/// use terrace_noise::Covariance;
///
/// let both = Covariance::isotropic(0.03) + Covariance::diagonal([0.0, 0.0, 0.04]);
/// assert!((both.along([0.0, 0.0, 5.0]).unwrap().sqrt() - 0.05).abs() < 1e-15);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Covariance([f64; 6]);

impl Covariance {
    /// A point without error.
    pub const ZERO: Self = Self([0.0; 6]);

    /// The same standard deviation, in metres, in every direction. It is not checked.
    pub fn isotropic(sigma: f64) -> Self {
        Self::diagonal([sigma; 3])
    }

    /// Uncorrelated errors with these standard deviations, in metres, along x, y and z. They are not checked.
    pub fn diagonal([x, y, z]: [f64; 3]) -> Self {
        Self([x * x, 0.0, 0.0, y * y, 0.0, z * z])
    }

    /// `v vᵀ`: an error along `v`, whose standard deviation is the length of `v`.
    pub(crate) fn outer([x, y, z]: [f64; 3]) -> Self {
        Self([x * x, x * y, x * z, y * y, y * z, z * z])
    }

    /// `I − u uᵀ` for a unit `u`.
    pub(crate) fn across([x, y, z]: [f64; 3]) -> Self {
        // For a unit vector 1 − x² = y² + z², which cannot become negative by rounding.
        Self([y * y + z * z, -x * y, -x * z, x * x + z * z, -y * z, x * x + y * y])
    }

    /// From entries in the order of [`entries`](Self::entries).
    pub(crate) fn of_entries(entries: [f64; 6]) -> Self {
        Self(entries)
    }

    /// This covariance times a number.
    pub(crate) fn scaled(self, factor: f64) -> Self {
        Self(self.0.map(|x| factor * x))
    }

    /// Itself when all entries are finite.
    pub(crate) fn finite(self) -> Option<Self> {
        self.0.iter().all(|x| x.is_finite()).then_some(self)
    }

    /// The six different entries, `xx, xy, xz, yy, yz, zz`.
    pub fn entries(&self) -> [f64; 6] {
        self.0
    }

    /// The three rows.
    pub fn rows(&self) -> [[f64; 3]; 3] {
        let [xx, xy, xz, yy, yz, zz] = self.0;
        [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
    }

    /// Standard deviations along x, y and z, in metres. Their correlation is lost.
    pub fn deviations(&self) -> [f64; 3] {
        // Rounding may leave a variance of zero a little below it; `max` would make 0 of NaN too.
        [self.0[0], self.0[3], self.0[5]].map(|variance| if variance < 0.0 { 0.0 } else { variance.sqrt() })
    }

    /// The variance along a direction of any length, in m²; `None` when it is zero or not finite.
    pub fn along(&self, along: [f64; 3]) -> Option<f64> {
        let (unit, _) = direction(along)?;
        let variance = dot(unit, self.rows().map(|row| dot(row, unit)));
        // Rounding may leave a variance of zero a little below it.
        variance.is_finite().then_some(variance.max(0.0))
    }
}

impl Add for Covariance {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let mut sum = self.0;
        for (entry, more) in sum.iter_mut().zip(other.0) {
            *entry += more;
        }
        Self(sum)
    }
}
