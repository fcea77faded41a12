//! A standard deviation for each axis of the world.

use crate::Covariance;
use crate::parameter::{ParameterError, deviation};

/// The same three standard deviations, along the axes of the world, for every point.
///
/// *Source*: none; numbers of a survey, such as those for horizontal place and height. *Validity*: wherever those
/// numbers were found; they are used everywhere.
///
/// ```
/// use terrace_noise::PerAxis;
///
/// let survey = PerAxis::from_metres([0.5, 0.5, 0.25])?;
/// assert_eq!(survey.covariance().along([0.0, 0.0, 1.0]), Some(0.0625));
/// # Ok::<(), terrace_noise::ParameterError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PerAxis {
    sigma: [f64; 3],
}

impl PerAxis {
    /// From standard deviations along x, y and z of the world, in metres.
    ///
    /// # Errors
    /// [`ParameterError`] when one is negative or not finite.
    pub fn from_metres([x, y, z]: [f64; 3]) -> Result<Self, ParameterError> {
        Ok(Self { sigma: [deviation("axes: x", x)?, deviation("axes: y", y)?, deviation("axes: z", z)?] })
    }

    /// The standard deviations in metres.
    pub fn sigma(&self) -> [f64; 3] {
        self.sigma
    }

    /// The covariance of every point.
    pub fn covariance(&self) -> Covariance {
        Covariance::diagonal(self.sigma)
    }
}
