//! The error of one measurement, along its ray and across.

use crate::vector::direction;
use crate::{Covariance, Sight};

/// Standard deviations of a measured point, in metres: of its distance, and across.
///
/// ```
/// use terrace_noise::PointNoise;
///
/// let noise = PointNoise { axial: 0.02, lateral: 0.001 };
/// let covariance = noise.covariance([3.0, 0.0, 4.0]).unwrap();
/// assert!((covariance.along([0.6, 0.0, 0.8]).unwrap().sqrt() - 0.02).abs() < 1e-15);
/// assert!((covariance.along([0.0, 1.0, 0.0]).unwrap().sqrt() - 0.001).abs() < 1e-15);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointNoise {
    /// Of the range, or of the depth along the optical axis.
    pub axial: f64,
    /// In each direction perpendicular to the ray, or to the optical axis.
    pub lateral: f64,
}

impl PointNoise {
    /// `axial² r rᵀ + lateral² (I − r rᵀ)` for the ray `r`, given with any length: what is measured is the range.
    ///
    /// `None` when the ray is zero or not finite, and when a variance is not finite.
    pub fn covariance(&self, ray: [f64; 3]) -> Option<Covariance> {
        let (ray, _) = direction(ray)?;
        self.about(ray, ray)
    }

    /// `axial² s sᵀ + lateral² (I − a aᵀ)`: what is measured is the depth and a place in the image.
    ///
    /// `a` is the optical axis. A change of depth by 1 moves the point along its ray by `s = r / (r · a)`, the longer
    /// the farther from the middle of the image; a change of the place in the image moves it perpendicular to `a`.
    /// Without an axis the ray is the axis, and this is [`covariance`](Self::covariance). `None` when the point is not
    /// in front of the camera.
    pub fn covariance_in_image(&self, sight: &Sight) -> Option<Covariance> {
        let Some(axis) = sight.axis() else {
            return self.about(sight.ray(), sight.ray());
        };
        let depth = sight.depth();
        if depth <= 0.0 {
            return None;
        }
        let stretch = sight.range() / depth;
        self.about(sight.ray().map(|x| stretch * x), axis)
    }

    fn about(self, along: [f64; 3], axis: [f64; 3]) -> Option<Covariance> {
        let Self { axial, lateral } = self;
        let across = Covariance::across(axis).scaled(lateral * lateral);
        (Covariance::outer(along.map(|x| axial * x)) + across).finite()
    }
}
