//! A tile with what is asked of it again and again.

use glam::DVec3;
use terrace_stats::{Moments, SymmetricMatrix3};

use crate::flat::Noise;

/// Pixels of a tile that lie in one place, as far as its sums tell.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tile {
    pub(crate) points: f64,
    pub(crate) mean: DVec3,
    pub(crate) scatter: SymmetricMatrix3,
    pub(crate) noise: SymmetricMatrix3,
}

impl Tile {
    /// `None` without a point.
    pub(crate) fn of(sum: &Moments) -> Option<Self> {
        Some(Self {
            points: sum.weight(),
            mean: sum.mean()?.into(),
            scatter: sum.covariance()?,
            noise: sum.mean_noise()?,
        })
    }

    /// Variance of the error of a point along a direction, in m².
    #[inline]
    pub(crate) fn variance(&self, noise: Noise, direction: DVec3) -> f64 {
        noise.variance(&self.noise, self.mean.z, direction)
    }
}
