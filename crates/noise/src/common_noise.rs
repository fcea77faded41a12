//! Errors that all points of a scan share.

use crate::parameter::{ParameterError, deviation};
use crate::{Covariance, PoseNoise};

/// What does not average out over the points of a scan: an uncertain pose, and a floor.
///
/// The floor is a standard deviation, in metres and in every direction, of whatever is systematic in the sensor:
/// distortion, calibration, scale. It is taken as one unknown shift of the whole scan. Real distortion bends a plane
/// as well as moving it; a floor that covers the bend is the largest distance between a true plane and its points'
/// mean surface.
///
/// ```
/// use terrace_noise::{CommonNoise, PoseNoise};
///
/// let common = CommonNoise::new(Some(PoseNoise::from_degrees(0.02, 0.1)?), Some(0.005))?;
/// let covariance = common.at([0.0; 3], [0.0, 10.0, 0.0]).unwrap();
/// let along_the_ray = covariance.along([0.0, 1.0, 0.0]).unwrap().sqrt();
/// assert!((along_the_ray - 0.02_f64.hypot(0.005)).abs() < 1e-15);
/// # Ok::<(), terrace_noise::ParameterError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CommonNoise {
    pose: Option<PoseNoise>,
    floor: Option<f64>,
}

impl CommonNoise {
    /// From the noise of a pose, and a floor in metres; `None` for what is taken as exact.
    ///
    /// # Errors
    /// [`ParameterError`] when the floor is negative or not finite.
    pub fn new(pose: Option<PoseNoise>, floor: Option<f64>) -> Result<Self, ParameterError> {
        Ok(Self { pose, floor: floor.map(|sigma| deviation("floor", sigma)).transpose()? })
    }

    /// The noise of the pose.
    pub fn pose(&self) -> Option<PoseNoise> {
        self.pose
    }

    /// The floor in metres.
    pub fn floor(&self) -> Option<f64> {
        self.floor
    }

    /// The covariance of a point of the world, with the sensor at `sensor`; `None` when a place or a variance is not
    /// finite.
    pub fn at(&self, sensor: [f64; 3], point: [f64; 3]) -> Option<Covariance> {
        if !sensor.iter().chain(&point).all(|x| x.is_finite()) {
            return None;
        }
        let pose = self.pose.map_or(Some(Covariance::ZERO), |pose| pose.at(sensor, point))?;
        (pose + Covariance::isotropic(self.floor.unwrap_or(0.0))).finite()
    }
}
