//! What cannot be counted.

use thiserror::Error;

/// Why a value was not taken, or two collections do not belong together.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[non_exhaustive]
pub enum CalibrationError {
    /// Errors without a coordinate cannot be too large.
    #[error(
        "errors with {degrees_of_freedom} degrees of freedom have no distribution, there must be at least 1"
    )]
    DegreesOfFreedom {
        /// The degrees of freedom asked for.
        degrees_of_freedom: u32,
    },
    /// The value is no squared Mahalanobis distance.
    #[error("{value} is no squared Mahalanobis distance, which is finite and not negative")]
    Value {
        /// The value as given.
        value: f64,
    },
    /// An error or its bound is not a number, or the bound is negative.
    #[error("whether an error of {error} exceeds a bound of {bound} cannot be said")]
    Bound {
        /// The error as given.
        error: f64,
        /// The bound as given.
        bound: f64,
    },
    /// Values with different degrees of freedom follow different distributions.
    #[error("values with {ours} and with {theirs} degrees of freedom cannot be counted together")]
    Merge {
        /// Degrees of freedom of the collection that was to be extended.
        ours: u32,
        /// Degrees of freedom of the other.
        theirs: u32,
    },
}
