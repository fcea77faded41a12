//! What cannot be tuned.

use terrace_crs::{BoundsError, SearchError};
use terrace_eval::EvalError;

use crate::tune::TuneAxis;
use crate::{ExtractError, InsertError, ParamsError};

/// Why settings could not be tuned.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TuneError {
    /// A setting that is not one, of the parameters or the space.
    #[error(transparent)]
    Params(#[from] ParamsError),
    /// There is no value to choose from.
    #[error("there is no value of {axis} to choose from")]
    NoValue {
        /// The setting.
        axis: TuneAxis,
    },
    /// The ends of a range are in the wrong order.
    #[error("the range of {axis} ends at {hi}, below its beginning, {lo}")]
    Reversed {
        /// The setting.
        axis: TuneAxis,
        /// Where the range begins.
        lo: f64,
        /// Where it ends.
        hi: f64,
    },
    /// A search needs one evaluation for the settings in use, and one to find better ones.
    #[error("{evaluations} evaluations are too few for a search, 2 are needed")]
    Evaluations {
        /// The evaluations asked for.
        evaluations: usize,
    },
    /// The labels are not of the points of the scans.
    #[error("{labels} labels do not fit {points} points")]
    Labels {
        /// Number of labels.
        labels: usize,
        /// Number of points of all scans, absent ones included.
        points: usize,
    },
    /// No point has a true plane: every result would be as good as any other.
    #[error("none of the {labels} labels is that of a plane")]
    NoTruePlanes {
        /// Number of labels.
        labels: usize,
    },
    /// The measure of quality cannot be used.
    #[error(transparent)]
    Eval(#[from] EvalError),
    /// A scan could not be inserted.
    #[error(transparent)]
    Insert(#[from] InsertError),
    /// Planes could not be extracted.
    #[error(transparent)]
    Extract(#[from] ExtractError),
    /// The space cannot be searched.
    #[error(transparent)]
    Bounds(#[from] BoundsError),
    /// The search was refused.
    #[error(transparent)]
    Search(#[from] SearchError),
}
