//! Lidars and laser scanners.

use crate::parameter::{ParameterError, deviation};
use crate::{Covariance, PointNoise, Sight};

/// A lidar or laser scanner: a range along a beam whose direction is known to an angle.
///
/// * axial: `σ_r = a + b r`, with the range `r`, a constant part `a` and a proportional part `b` (0 unless set), added
///   as data sheets state them ("2 mm + 10 ppm");
/// * lateral: `r σ_α`, with the standard deviation `σ_α` of the direction of the beam in each of the two directions
///   across.
///
/// *Source*: first-order propagation of polar coordinates, as for terrestrial laser scanners in Hartzell et al.,
/// "Rigorous error propagation for terrestrial laser scanning with application to snow volume uncertainty", Journal
/// of Glaciology 61 (2015); the numbers are those of a data sheet. *Validity*: any range; angles of some hundredths
/// of a radian at most, for which an arc is straight; beyond, the formula is used as it stands. *Not in it*:
/// footprints that meet two surfaces, and the growth of the range noise with the incidence angle and with weak
/// returns. Azimuth and elevation are taken as equally uncertain *across* the beam: an encoder's error in azimuth
/// shrinks towards the zenith, which this does not show.
///
/// ```
/// use terrace_noise::{Lidar, Sight};
///
/// let lidar = Lidar::from_radians(0.02, 0.001)?.with_proportional(0.0001)?;
/// let sight = Sight::new([0.0; 3], [30.0, 40.0, 0.0]).unwrap();
/// let noise = lidar.at(&sight).unwrap();
/// assert!((noise.axial - 0.025).abs() < 1e-15);
/// assert!((noise.lateral - 0.05).abs() < 1e-15);
/// # Ok::<(), terrace_noise::ParameterError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lidar {
    range: f64,
    proportional: f64,
    angle: f64,
}

impl Lidar {
    /// From the standard deviations of a range, in metres, and of the direction of a beam, in radians.
    ///
    /// # Errors
    /// [`ParameterError`] when one is negative or not finite.
    pub fn from_radians(range: f64, angle: f64) -> Result<Self, ParameterError> {
        Ok(Self { range: deviation("range", range)?, proportional: 0.0, angle: deviation("angle", angle)? })
    }

    /// From the standard deviations of a range, in metres, and of the direction of a beam, in degrees.
    ///
    /// # Errors
    /// [`ParameterError`] when one is negative or not finite.
    pub fn from_degrees(range: f64, angle: f64) -> Result<Self, ParameterError> {
        // Checked first, so that an error names the degrees.
        Self::from_radians(range, deviation("angle", angle)?.to_radians())
    }

    /// With a part of the standard deviation of a range that grows with it, in metres per metre.
    ///
    /// # Errors
    /// [`ParameterError`] when it is negative or not finite.
    pub fn with_proportional(self, proportional: f64) -> Result<Self, ParameterError> {
        Ok(Self { proportional: deviation("proportional", proportional)?, ..self })
    }

    /// The constant part of the standard deviation of a range, in metres.
    pub fn range(&self) -> f64 {
        self.range
    }

    /// The proportional part of the standard deviation of a range, in metres per metre.
    pub fn proportional(&self) -> f64 {
        self.proportional
    }

    /// The standard deviation of the direction of a beam, in radians.
    pub fn angle(&self) -> f64 {
        self.angle
    }

    /// Both standard deviations of a point; an optical axis is not looked at. `None` when it is too far for a finite
    /// error.
    pub fn at(&self, sight: &Sight) -> Option<PointNoise> {
        let (axial, lateral) = (self.range + self.proportional * sight.range(), self.angle * sight.range());
        (axial.is_finite() && lateral.is_finite()).then_some(PointNoise { axial, lateral })
    }

    /// The covariance of a point; `None` as for [`at`](Self::at).
    pub fn covariance(&self, sight: &Sight) -> Option<Covariance> {
        self.at(sight)?.covariance(sight.ray())
    }
}
