//! A noise model for the points of one scan.

use crate::vector::direction;
use crate::{Covariance, SensorNoise, Sight};

/// A noise model together with where the sensor of a scan stood, and where it looked.
///
/// It answers point by point: nothing is stored, and a scan of any length is gone through once.
///
/// ```
/// use terrace_noise::{ScanNoise, SensorNoise};
///
/// let noise: SensorNoise = "lidar:range=0.02,angle=1mrad".parse()?;
/// let scan = ScanNoise::new(noise, Some([0.0, 0.0, 1.5]))?;
/// let points = [[10.0, 0.0, 1.5], [f64::NAN; 3]];
/// let sigmas: Vec<_> = scan.covariances(points).map(|c| c.map(|c| c.deviations())).collect();
/// assert!((sigmas[0].unwrap()[0] - 0.02).abs() < 1e-15 && (sigmas[0].unwrap()[1] - 0.01).abs() < 1e-15);
/// assert_eq!(sigmas[1], None, "an absent point has no noise");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScanNoise {
    noise: SensorNoise,
    sensor: Option<[f64; 3]>,
    axis: Option<[f64; 3]>,
}

/// Why a noise model does not fit a scan.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ScanNoiseError {
    /// The model depends on the place of the sensor, and that is not known.
    #[error("the noise model {noise} needs the position of the sensor, which is not known")]
    SensorUnknown {
        /// The model.
        noise: SensorNoise,
    },
    /// The position of the sensor is not finite.
    #[error("the sensor position ({}, {}, {}) is not finite", position[0], position[1], position[2])]
    SensorNotFinite {
        /// The position as given.
        position: [f64; 3],
    },
    /// The optical axis is zero or not finite.
    #[error("the optical axis ({}, {}, {}) has no direction", axis[0], axis[1], axis[2])]
    NoAxis {
        /// The axis as given.
        axis: [f64; 3],
    },
}

impl ScanNoise {
    /// From a model and the position of the sensor in the world, in metres.
    ///
    /// # Errors
    /// [`ScanNoiseError`] when the position is not finite, or is not known and the model needs it.
    pub fn new(noise: SensorNoise, sensor: Option<[f64; 3]>) -> Result<Self, ScanNoiseError> {
        match sensor {
            None if noise.needs_sensor() => Err(ScanNoiseError::SensorUnknown { noise }),
            Some(position) if !position.iter().all(|x| x.is_finite()) => {
                Err(ScanNoiseError::SensorNotFinite { position })
            }
            _ => Ok(Self { noise, sensor, axis: None }),
        }
    }

    /// With the optical axis of a camera in the world, of any length, from the camera into the scene. Without it the
    /// depth of a point is its straight distance.
    ///
    /// # Errors
    /// [`ScanNoiseError`] when it is zero or not finite.
    pub fn with_axis(self, axis: [f64; 3]) -> Result<Self, ScanNoiseError> {
        let (axis, _) = direction(axis).ok_or(ScanNoiseError::NoAxis { axis })?;
        Ok(Self { axis: Some(axis), ..self })
    }

    /// The noise model.
    pub fn noise(&self) -> SensorNoise {
        self.noise
    }

    /// The covariance of a point of the world; `None` when the point is not finite or the model has none there.
    pub fn covariance(&self, point: [f64; 3]) -> Option<Covariance> {
        if let Some(constant) = self.noise.constant() {
            return point.iter().all(|x| x.is_finite()).then_some(constant);
        }
        self.noise.covariance(&self.sight(point)?)
    }

    /// The covariance of a point on a surface with this normal (any length, either side), which a Kinect's noise
    /// depends on. A normal that has no direction counts as unknown.
    pub fn covariance_on(&self, point: [f64; 3], normal: [f64; 3]) -> Option<Covariance> {
        match self.sight(point).and_then(|sight| sight.with_normal(normal)) {
            Some(sight) => self.noise.covariance(&sight),
            None => self.covariance(point),
        }
    }

    /// The covariances of points of the world, in their order.
    pub fn covariances<I>(&self, points: I) -> impl Iterator<Item = Option<Covariance>> + use<I>
    where
        I: IntoIterator<Item = [f64; 3]>,
    {
        let scan = *self;
        points.into_iter().map(move |point| scan.covariance(point))
    }

    fn sight(&self, point: [f64; 3]) -> Option<Sight> {
        let sight = Sight::new(self.sensor?, point)?;
        Some(self.axis.map_or(sight, |axis| sight.with_unit_axis(axis)))
    }
}
