//! A tile with what is asked of it again and again.

use glam::DVec3;

use crate::flat::{Flat, Noise};
use crate::sum::{Sum, along};

/// Pixels of a tile that lie in one place, as far as its sums tell.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tile {
    pub(crate) points: f64,
    pub(crate) mean: DVec3,
    scatter: [f64; 6],
    noise: [f64; 6],
}

impl Tile {
    /// `None` without a point.
    pub(crate) fn of(sum: &Sum) -> Option<Self> {
        (sum.points() > 0.0).then(|| Self {
            points: sum.points(),
            mean: sum.mean(),
            scatter: sum.covariance(),
            noise: sum.noise(),
        })
    }

    /// Mean squared distance of the points from a plane, in m².
    #[inline]
    pub(crate) fn mean_square(&self, plane: &Flat) -> f64 {
        let off = plane.distance(self.mean);
        along(self.scatter, plane.normal).max(0.0) + off * off
    }

    /// Variance of the error of a point along a direction, in m².
    #[inline]
    pub(crate) fn variance(&self, noise: Noise, direction: DVec3) -> f64 {
        noise.variance(self.noise, self.mean.z, direction)
    }
}
