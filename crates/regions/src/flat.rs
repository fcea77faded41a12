//! A plane by a point and its normal.

use glam::DVec3;
use terrace_normals::{PlaneFit, fit_plane};
use terrace_stats::Stats;

use crate::cell::Noise;

/// A plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Flat {
    pub(crate) normal: DVec3,
    pub(crate) point: DVec3,
}

impl Flat {
    pub(crate) fn of(fit: &PlaneFit) -> Self {
        Self { normal: fit.normal.into(), point: fit.centroid.into() }
    }

    pub(crate) fn distance(&self, place: DVec3) -> f64 {
        self.normal.dot(place - self.point)
    }

    /// The angle between two planes, whichever way their normals point, in radians.
    pub(crate) fn angle(&self, other: &Self) -> f64 {
        self.normal.cross(other.normal).length().atan2(self.normal.dot(other.normal).abs())
    }
}

/// The plane of least squares of some points, and how well it fits.
#[derive(Debug, Clone)]
pub(crate) struct Fitted {
    pub(crate) plane: Flat,
    pub(crate) fit: PlaneFit,
    pub(crate) sums: Stats,
    /// Mean variance of the error of a point along the normal, in m².
    pub(crate) variance: f64,
    /// Mean squared distance of the points in units of that.
    pub(crate) reduced_chi_squared: f64,
    /// Standard error of the orientation where it is least sure, in radians.
    pub(crate) tilt: f64,
}

impl Fitted {
    /// `None` when the points determine no plane.
    pub(crate) fn of(sums: Stats, noise: Noise) -> Option<Self> {
        let fit = fit_plane(&sums).ok()?;
        let points = sums.count() as f64;
        let stated = sums.moments().noise().quadratic_form(fit.normal) / points;
        let variance = (noise.scale * stated).max(noise.floor);
        let [thickness, across, _] = fit.variances;
        let tilt = (thickness.max(variance) / (points * across)).sqrt();
        (variance > 0.0 && tilt.is_finite()).then(|| Self {
            plane: Flat::of(&fit),
            fit,
            sums,
            variance,
            reduced_chi_squared: thickness / variance,
            tilt,
        })
    }

    pub(crate) fn points(&self) -> f64 {
        self.sums.count() as f64
    }
}
