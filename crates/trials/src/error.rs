//! What trials refuse.

use terrace::{ExtractError, InsertError, ParamsError};
use terrace_calibration::CalibrationError;
use terrace_synth::{MisplacedError, StatedError, SynthError};

/// Why no trial could be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TrialError {
    /// The points have no errors of their own, and no model of a sensor was given.
    #[error("the scans tell no standard errors to draw noise from; name a sensor")]
    NoErrors,
    /// Outcomes of different places cannot be added.
    #[error("outcomes of the planes {ours:?} and {theirs:?} cannot be counted together")]
    Places {
        /// Names of the known planes of the outcome that was to be extended.
        ours: Vec<String>,
        /// Those of the other.
        theirs: Vec<String>,
    },
    /// The points of a scan are not points of the map it is held against.
    #[error("a scan has the points {first} to {end} of a map, which has {points} points")]
    Unlabelled {
        /// Its first point.
        first: usize,
        /// The point after its last.
        end: usize,
        /// The points of the map.
        points: usize,
    },
    /// A scene could not be scanned so.
    #[error(transparent)]
    Synth(#[from] SynthError),
    /// The model of the sensor does not fit the scans.
    #[error(transparent)]
    Stated(#[from] StatedError),
    /// A scan has no pose that could be wrong.
    #[error(transparent)]
    Misplaced(#[from] MisplacedError),
    /// The parameters were refused.
    #[error(transparent)]
    Params(#[from] ParamsError),
    /// A scan was refused.
    #[error(transparent)]
    Insert(#[from] InsertError),
    /// No planes could be extracted.
    #[error(transparent)]
    Extract(#[from] ExtractError),
    /// A squared error was refused.
    #[error(transparent)]
    Calibration(#[from] CalibrationError),
}
