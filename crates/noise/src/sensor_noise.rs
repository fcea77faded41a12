//! One of the noise models.

use std::ops::RangeInclusive;

use crate::{Covariance, Kinect, Lidar, PerAxis, Sight, Stereo, Uniform};

/// The noise model of a sensor, as read from a text such as `lidar:range=0.02,angle=0.1deg`.
///
/// # Text
/// | Text | Keys | Model |
/// | --- | --- | --- |
/// | `uniform:0.01` | a standard deviation in metres | [`Uniform`] |
/// | `axes:0.01,0.01,0.02` | standard deviations along x, y, z of the world, in metres | [`PerAxis`] |
/// | `kinect`, `kinect:focal=525` | `focal` in pixels, 585 if left out | [`Kinect`] |
/// | `stereo:fb=80,disparity=0.2,focal=700` | `fb` in px m, `disparity` and `focal` in px; `pixel` in px, 0.5 if left out | [`Stereo`] |
/// | `lidar:range=0.02,angle=0.1deg` | `range` in metres, `angle` in `deg`, `mrad` or `rad` (also without a unit); `proportional` in m/m, 0 if left out | [`Lidar`] |
///
/// Keys come in any order, each once at most; blanks around names and values are passed over. What is written by
/// [`Display`](std::fmt::Display) reads back as the same model, to the last bit.
///
/// ```
/// use terrace_noise::{SensorNoise, Sight};
///
/// let noise: SensorNoise = "stereo:fb=80,disparity=0.2,focal=700".parse()?;
/// let sight = Sight::new([0.0; 3], [0.0, 0.0, 4.0]).unwrap();
/// let covariance = noise.covariance(&sight).unwrap();
/// assert!((covariance.along([0.0, 0.0, 1.0]).unwrap().sqrt() - 0.04).abs() < 1e-15);
/// assert_eq!(noise.to_string(), "stereo:fb=80,disparity=0.2,focal=700");
/// # Ok::<(), terrace_noise::ParseNoiseError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum SensorNoise {
    /// One standard deviation.
    Uniform(Uniform),
    /// One standard deviation for each axis of the world.
    PerAxis(PerAxis),
    /// The first Kinect and structured light like it.
    Kinect(Kinect),
    /// A stereo camera.
    Stereo(Stereo),
    /// A lidar or laser scanner.
    Lidar(Lidar),
}

impl SensorNoise {
    /// The covariance of a point that was seen so; `None` when the model has none there: a point that a camera could
    /// not see, or so far that the variance is not finite.
    pub fn covariance(&self, sight: &Sight) -> Option<Covariance> {
        match self {
            Self::Uniform(model) => model.covariance().finite(),
            Self::PerAxis(model) => model.covariance().finite(),
            Self::Kinect(model) => model.covariance(sight),
            Self::Stereo(model) => model.covariance(sight),
            Self::Lidar(model) => model.covariance(sight),
        }
    }

    /// The covariance that all points share, whatever the place of the sensor; `None` for models that depend on it.
    pub fn constant(&self) -> Option<Covariance> {
        match self {
            Self::Uniform(model) => model.covariance().finite(),
            Self::PerAxis(model) => model.covariance().finite(),
            Self::Kinect(_) | Self::Stereo(_) | Self::Lidar(_) => None,
        }
    }

    /// Whether the place of the sensor must be known.
    pub fn needs_sensor(&self) -> bool {
        matches!(self, Self::Kinect(_) | Self::Stereo(_) | Self::Lidar(_))
    }

    /// The depths (for a lidar: ranges), in metres, for which the model was made. Outside, its formula is used as it
    /// stands.
    pub fn valid_depths(&self) -> RangeInclusive<f64> {
        match self {
            Self::Uniform(_) | Self::PerAxis(_) | Self::Lidar(_) => 0.0..=f64::INFINITY,
            Self::Kinect(model) => model.valid_depths(),
            Self::Stereo(model) => model.valid_depths(),
        }
    }
}
