//! Two numbers for the error of a pose, and the texts that name them.

use std::fmt;
use std::str::FromStr;

use crate::grammar::{angle, has_unit};
use crate::keys::number;
use crate::parameter::{ParameterError, deviation};
use crate::{ParseNoiseError, PoseNoise};

/// One standard deviation for the translation of a pose along each axis, and one for its rotation about each axis;
/// uncorrelated. As text `T,R`: metres, and a number with `deg`, `mrad` or `rad` behind it.
///
/// The unit of the rotation must be there: half a degree taken for half a radian would go unseen. What is written by
/// [`Display`](fmt::Display) reads back as the same, to the last bit.
///
/// ```
/// use terrace_noise::{PoseNoise, PoseSigma};
///
/// let sigma: PoseSigma = "0.02,5mrad".parse()?;
/// assert_eq!((sigma.translation(), sigma.rotation()), (0.02, 0.005));
/// assert_eq!(sigma.to_string(), "0.02,0.005rad");
/// assert_eq!(PoseNoise::from(sigma), PoseNoise::from_radians(0.02, 0.005)?);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseSigma {
    translation: f64,
    rotation: f64,
}

impl PoseSigma {
    /// From standard deviations in metres and in radians.
    ///
    /// # Errors
    /// [`ParameterError`] when one is negative or not finite.
    pub fn from_radians(translation: f64, rotation: f64) -> Result<Self, ParameterError> {
        Ok(Self {
            translation: deviation("translation", translation)?,
            rotation: deviation("rotation", rotation)?,
        })
    }

    /// The standard deviation of the translation along each axis, in metres.
    pub fn translation(&self) -> f64 {
        self.translation
    }

    /// The standard deviation of the rotation about each axis, in radians.
    pub fn rotation(&self) -> f64 {
        self.rotation
    }
}

impl From<PoseSigma> for PoseNoise {
    fn from(sigma: PoseSigma) -> Self {
        Self::of_deviations(sigma.translation, sigma.rotation)
    }
}

impl FromStr for PoseSigma {
    type Err = ParseNoiseError;

    fn from_str(text: &str) -> Result<Self, ParseNoiseError> {
        let wrong = || ParseNoiseError::NotAPoseSigma { found: text.to_owned() };
        let (translation, rotation) = text.split_once(',').ok_or_else(wrong)?;
        let (translation, rotation) = (translation.trim(), rotation.trim());
        if rotation.contains(',') {
            return Err(wrong());
        }
        let translation = number("translation", translation)?;
        if !has_unit(rotation) {
            return Err(ParseNoiseError::NotANumber {
                name: "rotation",
                found: rotation.to_owned(),
                allowed: "a number with deg, mrad or rad behind it",
            });
        }
        Ok(Self::from_radians(translation, angle("rotation", rotation)?)?)
    }
}

impl fmt::Display for PoseSigma {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{},{}rad", self.translation, self.rotation)
    }
}
