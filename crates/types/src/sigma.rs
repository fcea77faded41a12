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
    /// The covariance of each point in m², `xx, xy, xz, yy, yz, zz`: errors along a ray, say.
    Covariance(Vec<[f64; 6]>),
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
    /// A covariance is not finite, or not positive semidefinite: some combination of errors would have a negative
    /// variance.
    #[error(
        "the covariance {entries:?} of point {point} (xx, xy, xz, yy, yz, zz) is not finite and positive semidefinite"
    )]
    NotACovariance {
        /// Index of the point.
        point: usize,
        /// The entries found.
        entries: [f64; 6],
    },
}

/// What rounding may leave of a determinant that is zero, as a share of the variances in it.
const ROUNDING: f64 = 1e-9;

impl Sigma {
    /// Whether `value` can be a standard error: finite and not negative.
    pub fn is_valid(value: f64) -> bool {
        is_error(value)
    }

    /// Whether these entries `xx, xy, xz, yy, yz, zz` can be a covariance: finite and, up to rounding, positive
    /// semidefinite.
    pub fn is_valid_covariance([xx, xy, xz, yy, yz, zz]: [f64; 6]) -> bool {
        let at_least_zero = |minor: f64, of: f64| minor >= -ROUNDING * of;
        let minors = [(xx * yy, xy), (yy * zz, yz), (xx * zz, xz)];
        let determinant = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
        [xx, xy, xz, yy, yz, zz].iter().all(|x| x.is_finite())
            && xx.min(yy).min(zz) >= 0.0
            && minors.into_iter().all(|(product, off)| at_least_zero(product - off * off, product))
            && at_least_zero(determinant, xx * yy * zz)
    }

    /// The standard error of the point at `index` along each axis; `None` when errors are unknown, and beyond the end.
    pub fn of(&self, index: usize) -> Option<[f64; 3]> {
        match self {
            Self::Unknown => None,
            Self::Uniform(sigma) => Some([*sigma; 3]),
            Self::PerPoint(sigmas) => sigmas.get(index).map(|s| [*s; 3]),
            Self::PerAxis(sigmas) => sigmas.get(index).copied(),
            Self::Covariance(all) => all.get(index).map(|c| [c[0], c[3], c[5]].map(f64::sqrt)),
        }
    }

    /// The covariance of the point at `index`, `xx, xy, xz, yy, yz, zz` in m²; `None` when errors are unknown or given as
    /// standard errors, and beyond the end.
    pub fn covariance_of(&self, index: usize) -> Option<[f64; 6]> {
        match self {
            Self::Covariance(all) => all.get(index).copied(),
            _ => None,
        }
    }

    /// Whether those of all points are valid, whether or not these are present.
    fn are_all_valid(&self) -> bool {
        // Counted without a branch, several at a time.
        let all = |values: &[f64]| values.iter().map(|v| u64::from(!is_error(*v))).sum::<u64>() == 0;
        match self {
            Self::Unknown => true,
            Self::Uniform(value) => is_error(*value),
            Self::PerPoint(sigmas) => all(sigmas),
            Self::PerAxis(sigmas) => all(sigmas.as_flattened()),
            // Of many scans some are absent, and without.
            Self::Covariance(_) => false,
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
            Self::Covariance(all) => all.len(),
        };
        if count != points.len() {
            return Err(SigmaError::CountMismatch { sigmas: count, points: points.len() });
        }
        if self.are_all_valid() {
            return Ok(());
        }
        for (point, position) in points.iter().enumerate() {
            if !position.iter().all(|x| x.is_finite()) {
                continue;
            }
            if let Some(entries) = self.covariance_of(point) {
                if !Self::is_valid_covariance(entries) {
                    return Err(SigmaError::NotACovariance { point, entries });
                }
                continue;
            }
            if let Some(value) = self.of(point).and_then(|s| s.into_iter().find(|v| !Self::is_valid(*v))) {
                return Err(SigmaError::NotAStandardError { point, value });
            }
        }
        Ok(())
    }
}

/// Finite and not negative.
#[inline]
#[allow(clippy::manual_range_contains, clippy::needless_bitwise_bool, reason = "without a branch")]
fn is_error(value: f64) -> bool {
    (value >= 0.0) & (value < f64::INFINITY)
}
