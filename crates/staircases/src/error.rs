//! Parameters that make no test function.

use terrace_crs::BoundsError;
use thiserror::Error;

/// Why a test function cannot be made. Axes, borders, values and items count from zero.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ParameterError {
    /// The bounds that follow from the parameters cannot be searched; with no axes this is [`BoundsError::Empty`].
    #[error(transparent)]
    Bounds(#[from] BoundsError),
    /// A function without steps has no values.
    #[error("at least one step is needed")]
    NoSteps,
    /// More steps on one axis, or more work for the optimum, than this crate is made for.
    #[error("{what} would be {count}, more than {limit}")]
    TooLarge {
        /// What is too large.
        what: &'static str,
        /// How much was asked for.
        count: u128,
        /// The most that is possible.
        limit: u128,
    },
    /// The optimum is in a cell that there is not.
    #[error("axis {axis}: there is no cell {cell} among {cells}")]
    NoCell {
        /// The axis.
        axis: usize,
        /// The cell asked for.
        cell: usize,
        /// The number of cells.
        cells: usize,
    },
    /// The needle is not a proper part of the unit interval.
    #[error("a needle on [{at:?}, {at:?} + {width:?}) is not inside [0, 1]")]
    Needle {
        /// Its lower end.
        at: f64,
        /// Its width.
        width: f64,
    },
    /// The slope of a floor is negative or not finite.
    #[error("the slope {slope:?} is not a finite number of at least zero")]
    Slope {
        /// The slope.
        slope: f64,
    },
    /// Each value has its two ends: there must be one border more than there are values.
    #[error("{values} values need {} borders, not {borders}", values + 1)]
    Lengths {
        /// The number of borders.
        borders: usize,
        /// The number of values.
        values: usize,
    },
    /// Borders must be finite and rise.
    #[error("border {index} is {border:?}, which does not rise from {previous:?}")]
    Border {
        /// Which border.
        index: usize,
        /// The border.
        border: f64,
        /// The one before it.
        previous: f64,
    },
    /// Values must be finite.
    #[error("value {index} is {value:?}, not a finite number")]
    Value {
        /// Which value.
        index: usize,
        /// The value.
        value: f64,
    },
    /// An item of no weight would be taken without limit by the capacity.
    #[error("item {item} weighs nothing")]
    Weightless {
        /// Which item.
        item: usize,
    },
}

/// The most steps along one axis: their borders are kept.
pub(crate) const MOST_STEPS: usize = 10_000_000;

/// Checks the number of steps along one axis.
pub(crate) fn check_steps(steps: usize) -> Result<(), ParameterError> {
    match steps {
        0 => Err(ParameterError::NoSteps),
        1..=MOST_STEPS => Ok(()),
        _ => Err(ParameterError::TooLarge {
            what: "the number of steps along one axis",
            count: steps as u128,
            limit: MOST_STEPS as u128,
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_carry_the_values() {
        let error = ParameterError::Lengths { borders: 3, values: 3 };
        assert_eq!(error.to_string(), "3 values need 4 borders, not 3");
        let error = ParameterError::Border { index: 2, border: 0.5, previous: f64::NAN };
        assert_eq!(error.to_string(), "border 2 is 0.5, which does not rise from NaN");
        let error = check_steps(MOST_STEPS + 1).unwrap_err();
        assert!(error.to_string().contains("10000001"), "{error}");
        assert_eq!(check_steps(0), Err(ParameterError::NoSteps));
    }
}
