//! How far an estimated plane is from another, as its covariance counts it.

use glam::DVec3;
use terrace::PlaneEstimate;
use terrace_calibration::squared_mahalanobis;
use terrace_types::Plane;

/// The error of an estimate, estimated less true, in the parameters of its covariance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Deviation {
    /// (tilt₁, tilt₂, offset): radians and metres.
    pub tilt_offset: [f64; 3],
    /// Its square in units of the covariance, with three degrees of freedom; `None` for a covariance without an inverse.
    pub squared: Option<f64>,
}

impl Deviation {
    /// From the true plane, whose normal may point to either side. Tilts are ratios of components, so that they grow without
    /// bound towards a right angle.
    pub fn of(estimate: &PlaneEstimate, truth: &Plane) -> Self {
        let normal = DVec3::from(truth.normal());
        let along = normal.dot(DVec3::from(estimate.plane.normal()));
        let tilts = estimate.axes.map(|axis| -normal.dot(DVec3::from(axis)) / along);
        let offset = along.signum() * truth.signed_distance(estimate.centroid);
        let tilt_offset = [tilts[0], tilts[1], offset];
        Self { tilt_offset, squared: squared_mahalanobis(tilt_offset, estimate.tilt_offset) }
    }
}

/// The error of each component of a unit normal; the true normal may point to either side.
pub(crate) fn normal_error(found: [f64; 3], truth: &Plane) -> [f64; 3] {
    let (found, truth) = (DVec3::from(found), DVec3::from(truth.normal()));
    let truth = if found.dot(truth) < 0.0 { -truth } else { truth };
    (found - truth).to_array()
}
