//! The first Kinect and structured light like it.

use std::f64::consts::FRAC_PI_2;
use std::ops::RangeInclusive;

use crate::parameter::{ParameterError, positive};
use crate::{Covariance, PointNoise, Sight};

/// The focal length of the depth image of the first Kinect, in pixels of 640×480.
const FOCAL: f64 = 585.0;

/// The first Kinect, and cameras with structured light like it.
///
/// With the depth `z` in metres and the incidence angle `θ` in radians:
///
/// * axial: `σ_z = 0.0012 + 0.0019 (z − 0.4)² + (0.0001/√z) θ²/(π/2 − θ)²` metres; the last term only when θ is known.
/// * lateral: `σ_L = 0.8 + 0.035 θ/(π/2 − θ)` pixels, times `z/f` in metres; θ = 0 when it is not known.
///
/// *Source*: Nguyen, Izadi, Lovell, "Modeling Kinect Sensor Noise for Improved 3D Reconstruction and Tracking",
/// 3DIMPVT 2012. Their θ is the angle to the optical axis; here it is the angle to the ray, which is the same in the
/// middle of the image. They fitted the axial noise without its last term for 10° to
/// 60°, and add that term for steeper angles; here it is there at every known angle, so that the noise has no jump at
/// 60°: it adds 0.03 mm at 30° and 0.4 mm at 60°, at 1 m. *Validity*: depths of about 0.4 to 5 m. Outside, the
/// formula is used as it stands: below 0.4 m the axial noise grows again, to 1.5 mm at the sensor. *Not in it*: the
/// distortion of the depth, which does not average out (see [`CommonNoise`](crate::CommonNoise)).
///
/// ```
/// use terrace_noise::{Kinect, Sight};
///
/// let kinect = Kinect::default();
/// assert_eq!(kinect.axial(0.4, None), Some(0.0012));
/// assert!((kinect.axial(2.4, None).unwrap() - 0.0088).abs() < 1e-15);
/// assert!((kinect.lateral(1.17, None).unwrap() - 0.0016).abs() < 1e-15);
///
/// let sight = Sight::new([0.0; 3], [0.0, 0.0, 2.4]).unwrap();
/// let covariance = kinect.covariance(&sight).unwrap();
/// assert!((covariance.along([0.0, 0.0, 1.0]).unwrap().sqrt() - 0.0088).abs() < 1e-15);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kinect {
    focal: f64,
}

impl Default for Kinect {
    /// A focal length of 585 pixels.
    fn default() -> Self {
        Self { focal: FOCAL }
    }
}

impl Kinect {
    /// With this focal length in pixels.
    ///
    /// # Errors
    /// [`ParameterError`] when it is not positive and finite.
    pub fn from_focal_pixels(focal: f64) -> Result<Self, ParameterError> {
        Ok(Self { focal: positive("focal", focal)? })
    }

    /// The focal length in pixels.
    pub fn focal(&self) -> f64 {
        self.focal
    }

    /// Depths the model was made for, in metres.
    pub fn valid_depths(&self) -> RangeInclusive<f64> {
        0.4..=5.0
    }

    /// The standard deviation of a depth `z`, in metres, on a surface at `incidence`, in radians.
    ///
    /// `None` when `z` is not positive and finite, or the incidence is not from 0 to below π/2: a surface that is seen
    /// from its edge is not seen.
    pub fn axial(&self, z: f64, incidence: Option<f64>) -> Option<f64> {
        let ratio = ratio(z, incidence)?;
        let in_front = 0.0012 + 0.0019 * (z - 0.4) * (z - 0.4);
        // Without a ratio the slow root is of nothing.
        finite(if ratio > 0.0 { in_front + 0.0001 / z.sqrt() * ratio * ratio } else { in_front })
    }

    /// The standard deviation, in metres, in each direction across the optical axis. `None` as for
    /// [`axial`](Self::axial).
    pub fn lateral(&self, z: f64, incidence: Option<f64>) -> Option<f64> {
        finite((0.8 + 0.035 * ratio(z, incidence)?) * z / self.focal)
    }

    /// Both standard deviations of a point; `None` as for [`axial`](Self::axial).
    pub fn at(&self, sight: &Sight) -> Option<PointNoise> {
        let (z, incidence) = (sight.depth(), sight.incidence());
        Some(PointNoise { axial: self.axial(z, incidence)?, lateral: self.lateral(z, incidence)? })
    }

    /// The covariance of a point; `None` as for [`axial`](Self::axial).
    pub fn covariance(&self, sight: &Sight) -> Option<Covariance> {
        self.at(sight)?.covariance_in_image(sight)
    }
}

/// `θ/(π/2 − θ)`, 0 for an unknown θ; `None` for a depth or angle without a noise.
fn ratio(z: f64, incidence: Option<f64>) -> Option<f64> {
    let incidence = incidence.unwrap_or(0.0);
    let seen = z > 0.0 && z.is_finite() && (0.0..FRAC_PI_2).contains(&incidence);
    seen.then(|| incidence / (FRAC_PI_2 - incidence))
}

fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}
