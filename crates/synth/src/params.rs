//! What a caller may choose, and what is refused.

use terrace_types::{PlaneError, PoseError};

/// The most points one call makes.
pub const MAX_POINTS: usize = 1_000_000_000;

/// The largest standard error accepted, in metres.
pub const MAX_SIGMA: f64 = 1_000.0;

/// How a scene is scanned. `None` leaves the choice to the scene.
///
/// ```
/// use terrace_synth::{Params, Scene};
///
/// let noise_free = Params { points: Some(1_000), sigma: Some(0.0), ..Params::default() };
/// assert_eq!(Scene::table().generate(&noise_free)?.points(), 1_000);
/// # Ok::<(), terrace_synth::SynthError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Params {
    /// Number of points over all scans, exactly; from 1 to [`MAX_POINTS`].
    /// By default [`SceneKind::default_points`](crate::SceneKind::default_points).
    pub points: Option<usize>,
    /// One standard error for all points in metres, from 0 to [`MAX_SIGMA`], instead of the sensor's own model.
    pub sigma: Option<f64>,
    /// The seed of all randomness. The same seed gives the same bits.
    pub seed: u64,
}

/// Why no scan was made.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum SynthError {
    /// Zero points were asked for. Ask for at least one.
    #[error("a scan of 0 points was asked for")]
    NoPoints,
    /// More than [`MAX_POINTS`] points were asked for. Make several scans with different seeds.
    #[error("{points} points were asked for; at most {MAX_POINTS} are made")]
    TooManyPoints {
        /// The number asked for.
        points: usize,
    },
    /// The standard error is negative, not a number or above [`MAX_SIGMA`].
    #[error("the standard error {value} is not a number of metres from 0 to {MAX_SIGMA}")]
    Sigma {
        /// The value given.
        value: f64,
    },
    /// A motion took a sensor pose out of the range of numbers.
    #[error("the moved pose is no pose: {0}")]
    Pose(#[from] PoseError),
    /// A motion took a plane out of the range of numbers.
    #[error("the moved plane is no plane: {0}")]
    Plane(#[from] PlaneError),
}

impl Params {
    /// The number of points to make, with the scene's own number when none was chosen.
    pub(crate) fn checked_points(&self, default: usize) -> Result<usize, SynthError> {
        match self.points.unwrap_or(default) {
            0 => Err(SynthError::NoPoints),
            points if points > MAX_POINTS => Err(SynthError::TooManyPoints { points }),
            points => Ok(points),
        }
    }

    pub(crate) fn checked_sigma(&self) -> Result<Option<f64>, SynthError> {
        match self.sigma {
            Some(value) if !(0.0..=MAX_SIGMA).contains(&value) => Err(SynthError::Sigma { value }),
            sigma => Ok(sigma),
        }
    }
}
