//! Sums of points, in the frame of the camera.

use glam::DVec3;
use terrace_stats::{Moments, Stats, SymmetricMatrix3};

const NUMBERS: usize = 16;

/// How many points, Σ p, Σ p pᵀ, and the covariances of their errors, added up. About the camera itself: a scene is so small
/// that squares lose nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sum([f64; NUMBERS]);

impl Sum {
    pub(crate) const ZERO: Self = Self([0.0; NUMBERS]);

    /// `second` as xx, xy, xz, yy, yz, zz.
    pub(crate) fn of(points: f64, sum: [f64; 3], second: [f64; 6]) -> Self {
        let mut numbers = [0.0; NUMBERS];
        numbers[0] = points;
        numbers[1..4].copy_from_slice(&sum);
        numbers[4..10].copy_from_slice(&second);
        Self(numbers)
    }

    /// With this as the covariance of the error of each point, in m².
    pub(crate) fn with_noise(mut self, covariance: [f64; 6]) -> Self {
        let points = self.0[0];
        self.0[10..].copy_from_slice(&covariance.map(|entry| points * entry));
        self
    }

    pub(crate) fn points(&self) -> f64 {
        self.0[0]
    }

    #[inline]
    pub(crate) fn add(&mut self, other: &Self) {
        for (sum, more) in self.0.iter_mut().zip(&other.0) {
            *sum += more;
        }
    }

    /// Mean of the points, in metres.
    pub(crate) fn mean(&self) -> DVec3 {
        DVec3::new(self.0[1], self.0[2], self.0[3]) / self.0[0]
    }

    /// Scatter of the points about their mean, in m².
    pub(crate) fn covariance(&self) -> [f64; 6] {
        let [n, x, y, z, xx, xy, xz, yy, yz, zz, ..] = self.0;
        let share = 1.0 / n;
        let [x, y, z] = [x, y, z].map(|s| s * share);
        [
            (xx * share - x * x).max(0.0),
            xy * share - x * y,
            xz * share - x * z,
            (yy * share - y * y).max(0.0),
            yz * share - y * z,
            (zz * share - z * z).max(0.0),
        ]
    }

    /// Mean covariance of the errors, in m².
    pub(crate) fn noise(&self) -> [f64; 6] {
        let share = 1.0 / self.0[0];
        [10, 11, 12, 13, 14, 15].map(|i| self.0[i] * share)
    }

    pub(crate) fn stats(&self) -> Stats {
        let [n, x, y, z, a, b, c, d, e, f, noise @ ..] = self.0;
        // Points are counted in whole numbers.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let count = n as u64;
        let second = SymmetricMatrix3([a, b, c, d, e, f]);
        Stats::from_moments([0.0; 3], Moments::from_sums(count, [x, y, z], second, SymmetricMatrix3(noise)))
    }
}

/// nᵀ C n, C given as xx, xy, xz, yy, yz, zz.
#[inline]
pub(crate) fn along([xx, xy, xz, yy, yz, zz]: [f64; 6], n: DVec3) -> f64 {
    xx * n.x * n.x
        + yy * n.y * n.y
        + zz * n.z * n.z
        + 2.0 * (xy * n.x * n.y + xz * n.x * n.z + yz * n.y * n.z)
}

#[cfg(test)]
impl Sum {
    /// Whether all numbers are the same but for rounding.
    pub(crate) fn is_near(&self, other: &Self, by: f64) -> bool {
        self.0.iter().zip(&other.0).all(|(a, b)| (a - b).abs() <= by)
    }
}
