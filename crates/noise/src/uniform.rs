//! One standard deviation for every point.

use crate::Covariance;
use crate::parameter::{ParameterError, deviation};

/// The same standard deviation for every point and direction.
///
/// *Source*: none; a number from a data sheet or a repeated measurement. *Validity*: wherever that number was found;
/// it is used everywhere.
///
/// ```
/// use terrace_noise::Uniform;
///
/// assert_eq!(Uniform::from_metres(0.5)?.covariance().entries(), [0.25, 0.0, 0.0, 0.25, 0.0, 0.25]);
/// # Ok::<(), terrace_noise::ParameterError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Uniform {
    sigma: f64,
}

impl Uniform {
    /// From a standard deviation in metres.
    ///
    /// # Errors
    /// [`ParameterError`] when it is negative or not finite.
    pub fn from_metres(sigma: f64) -> Result<Self, ParameterError> {
        Ok(Self { sigma: deviation("uniform", sigma)? })
    }

    /// The standard deviation in metres.
    pub fn sigma(&self) -> f64 {
        self.sigma
    }

    /// The covariance of every point.
    pub fn covariance(&self) -> Covariance {
        Covariance::isotropic(self.sigma)
    }
}
