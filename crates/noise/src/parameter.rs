//! What the parameters of noise models may be.

/// Why a parameter of a noise model was refused. The name is the one `--sensor` texts use.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ParameterError {
    /// A standard deviation is negative, NaN or infinite. Zero is allowed: no such error.
    #[error("{name} is {value}; allowed is any finite number from 0 up")]
    NotADeviation {
        /// The parameter.
        name: &'static str,
        /// The value as given.
        value: f64,
    },
    /// A length that is divided by is zero, negative, NaN or infinite.
    #[error("{name} is {value}; allowed is any finite number above 0")]
    NotPositive {
        /// The parameter.
        name: &'static str,
        /// The value as given.
        value: f64,
    },
}

/// A standard deviation: finite and not negative.
pub(crate) fn deviation(name: &'static str, value: f64) -> Result<f64, ParameterError> {
    if value.is_finite() && value >= 0.0 {
        Ok(value)
    } else {
        Err(ParameterError::NotADeviation { name, value })
    }
}

/// A divisor: finite and positive.
pub(crate) fn positive(name: &'static str, value: f64) -> Result<f64, ParameterError> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(ParameterError::NotPositive { name, value })
    }
}
