//! What cannot be compared.

use thiserror::Error;

/// Why two labelings could not be compared.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[non_exhaustive]
pub enum EvalError {
    /// The labelings are not of the same points.
    #[error("{truth} true labels and {found} found ones are not of the same points")]
    Length {
        /// Number of true labels.
        truth: usize,
        /// Number of found labels.
        found: usize,
    },
    /// Below one half a plane may match several others; from 1 on nothing matches.
    #[error("planes are matched above an IoU of {at_iou}, it must be at least 0.5 and below 1")]
    Threshold {
        /// The IoU asked for.
        at_iou: f64,
    },
    /// At or below one half a plane may be part of several others; above 1 of none.
    #[error("planes are the same at a share of {share}, it must be above 0.5 and at most 1")]
    Share {
        /// The share asked for.
        share: f64,
    },
}
