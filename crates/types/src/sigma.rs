//! Standard errors of the points of a scan.

/// Standard errors of the points of one scan, in metres, in the frame of its points.
///
/// The paper ("An Optimization Approach for 3D Environment Mapping using Normal Vector Uncertainty", III-A) takes one
/// σ for all three axes; an error per axis is accepted as well.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Sigma {
    /// Nothing is known about the errors. Estimates then rest on the scatter of the points alone.
    #[default]
    Unknown,
    /// One σ for every point and axis.
    Uniform(f64),
    /// One σ per point, the same along each axis.
    PerPoint(Vec<f64>),
    /// σ along x, y and z for each point.
    PerAxis(Vec<[f64; 3]>),
}

/// Why standard errors were refused.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum SigmaError {
    /// A standard error is negative, NaN or infinite. Zero is allowed: a point known exactly.
    #[error("the standard error {value} of point {point} is not a finite number of metres from 0 up")]
    NotAStandardError {
        /// Index of the point, 0 for a uniform error.
        point: usize,
        /// The value found.
        value: f64,
    },
    /// There are more or fewer standard errors than points.
    #[error("{sigmas} standard errors were given for {points} points")]
    CountMismatch {
        /// Number of standard errors.
        sigmas: usize,
        /// Number of points.
        points: usize,
    },
}

impl Sigma {
    /// Whether `value` can be a standard error: finite and not negative.
    pub fn is_valid(value: f64) -> bool {
        value.is_finite() && value >= 0.0
    }

    /// The standard error of the point at `index` along each axis; `None` when errors are unknown, and beyond the end.
    pub fn of(&self, index: usize) -> Option<[f64; 3]> {
        match self {
            Self::Unknown => None,
            Self::Uniform(sigma) => Some([*sigma; 3]),
            Self::PerPoint(sigmas) => sigmas.get(index).map(|s| [*s; 3]),
            Self::PerAxis(sigmas) => sigmas.get(index).copied(),
        }
    }

    /// Checks the errors against the points they belong to; those of absent points (NaN) may be anything.
    pub(crate) fn check(&self, points: &[[f64; 3]]) -> Result<(), SigmaError> {
        let count = match self {
            Self::Unknown => return Ok(()),
            Self::Uniform(value) if Self::is_valid(*value) => return Ok(()),
            Self::Uniform(value) => return Err(SigmaError::NotAStandardError { point: 0, value: *value }),
            Self::PerPoint(sigmas) => sigmas.len(),
            Self::PerAxis(sigmas) => sigmas.len(),
        };
        if count != points.len() {
            return Err(SigmaError::CountMismatch { sigmas: count, points: points.len() });
        }
        for (point, position) in points.iter().enumerate() {
            if !position.iter().all(|x| x.is_finite()) {
                continue;
            }
            if let Some(value) = self.of(point).and_then(|s| s.into_iter().find(|v| !Self::is_valid(*v))) {
                return Err(SigmaError::NotAStandardError { point, value });
            }
        }
        Ok(())
    }
}
