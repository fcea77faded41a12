//! The collection of squared Mahalanobis distances, and what their mean says.

use crate::chi_squared::{chi_squared_cdf, chi_squared_quantile, tails, two_sided};
use crate::error::CalibrationError;
use crate::share::Share;

/// The probabilities at which coverage is usually stated.
pub const LEVELS: [f64; 4] = [0.5, 0.68, 0.95, 0.99];

/// Squared Mahalanobis distances of errors, by which predicted covariances are judged.
///
/// All errors have the same number of coordinates, the *degrees of freedom* `D`. If predictions are right and errors
/// Gaussian, the values are χ² variables with `D` degrees of freedom. All are kept (8 bytes each).
///
/// ```
/// use terrace_calibration::{Calibration, squared_mahalanobis};
///
/// let mut found = Calibration::new(2)?;
/// for error in [[0.1, -0.2], [0.0, 0.1], [-0.3, 0.1], [0.2, 0.2]] {
///     let covariance = [[0.04, 0.0], [0.0, 0.01]];
///     found.push(squared_mahalanobis(error, covariance).ok_or("no covariance")?)?;
/// }
/// // The mean of 4.25, 1, 3.25 and 5, over two degrees of freedom. Above 1, but of four values that says nothing.
/// assert!((found.nees().unwrap() - 1.6875).abs() < 1e-12);
/// let [low, high] = found.nees_band(0.95).unwrap();
/// assert!(low < 0.3 && high > 2.1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Calibration {
    degrees_of_freedom: u32,
    values: Vec<f64>,
    refused: usize,
}

impl Calibration {
    /// No values yet, of errors with this number of coordinates.
    ///
    /// # Errors
    /// [`CalibrationError::DegreesOfFreedom`] for 0.
    pub fn new(degrees_of_freedom: u32) -> Result<Self, CalibrationError> {
        if degrees_of_freedom == 0 {
            return Err(CalibrationError::DegreesOfFreedom { degrees_of_freedom });
        }
        Ok(Self { degrees_of_freedom, values: Vec::new(), refused: 0 })
    }

    /// Takes one squared Mahalanobis distance.
    ///
    /// # Errors
    /// [`CalibrationError::Value`] for a negative number, infinity and NaN; it is counted as [refused](Self::refused).
    pub fn push(&mut self, nees: f64) -> Result<(), CalibrationError> {
        if !nees.is_finite() || nees < 0.0 {
            self.refused += 1;
            return Err(CalibrationError::Value { value: nees });
        }
        self.values.push(nees);
        Ok(())
    }

    /// Counts a prediction that could not be judged, such as one without a positive definite covariance.
    pub fn refuse(&mut self) {
        self.refused += 1;
    }

    /// Adds the values of another collection.
    ///
    /// # Errors
    /// [`CalibrationError::Merge`] when its errors have another number of coordinates; then nothing changes.
    pub fn merge(&mut self, other: &Self) -> Result<(), CalibrationError> {
        let (ours, theirs) = (self.degrees_of_freedom, other.degrees_of_freedom);
        if ours != theirs {
            return Err(CalibrationError::Merge { ours, theirs });
        }
        self.values.extend_from_slice(&other.values);
        self.refused += other.refused;
        Ok(())
    }

    /// Coordinates of each error.
    pub fn degrees_of_freedom(&self) -> u32 {
        self.degrees_of_freedom
    }

    /// The values, in the order in which they came.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// How many values there are.
    pub fn count(&self) -> usize {
        self.values.len()
    }

    /// How many were refused. Where there are many, those that are left may say little.
    pub fn refused(&self) -> usize {
        self.refused
    }

    /// The normalised estimation error squared per degree of freedom: the mean of the values over `D`.
    ///
    /// It is 1 on average when the predicted covariances are right, above 1 when they are too small (overconfident) and
    /// below when too large: variances that are all too small by a factor of 2 give 2. `None` without values.
    pub fn nees(&self) -> Option<f64> {
        Some(self.mean()? / self.dimension())
    }

    /// Where [`nees`](Self::nees) falls with this probability when the predictions are right and the errors Gaussian and
    /// independent of each other: quantiles of χ² with `n·D` degrees of freedom, over `n·D`.
    ///
    /// `None` without values, or when the level is not above 0 and below 1. With dependent errors the true band is wider.
    pub fn nees_band(&self, level: f64) -> Option<[f64; 2]> {
        let [low, high] = tails(level)?;
        if self.values.is_empty() {
            return None;
        }
        let total = self.count() as f64 * self.dimension();
        Some([chi_squared_quantile(total, low)? / total, chi_squared_quantile(total, high)? / total])
    }

    /// Confidence interval of [`nees`](Self::nees) from the scatter of the values themselves.
    ///
    /// Where [`nees_band`](Self::nees_band) asks what right predictions would give, this asks how well the mean is known,
    /// whatever the distribution. Normal approximation: it is too narrow for few values or heavy tails. `None` with less
    /// than two values, or when the level is not above 0 and below 1.
    pub fn nees_interval(&self, level: f64) -> Option<[f64; 2]> {
        let reach = two_sided(level)?;
        let (mean, n) = (self.mean()?, self.count() as f64);
        if n < 2.0 {
            return None;
        }
        let squares: f64 = self.values.iter().map(|v| (v - mean) * (v - mean)).sum();
        let half = reach * (squares / (n - 1.0) / n).sqrt();
        Some([mean - half, mean + half].map(|x| x / self.dimension()))
    }

    /// The share of errors within the region that is to hold them with probability `level`: of values at most the `level`
    /// quantile of χ² with `D` degrees of freedom. Right predictions give `level` on average.
    ///
    /// `None` without values, or when the level is not above 0 and below 1.
    pub fn coverage(&self, level: f64) -> Option<Share> {
        let edge = chi_squared_quantile(self.dimension(), level)?;
        Share::new(self.values.iter().filter(|v| **v <= edge).count(), self.count())
    }

    /// `D`, as a number to reckon with.
    pub(crate) fn dimension(&self) -> f64 {
        f64::from(self.degrees_of_freedom)
    }

    /// The probability of a value at most this one, were the predictions right.
    pub(crate) fn probability(&self, value: f64) -> Option<f64> {
        chi_squared_cdf(self.dimension(), value)
    }

    /// The values from the least to the greatest.
    pub(crate) fn sorted(&self) -> Vec<f64> {
        let mut values = self.values.clone();
        values.sort_unstable_by(f64::total_cmp);
        values
    }

    fn mean(&self) -> Option<f64> {
        let n = self.count() as f64;
        // Divided first: the sum of large values could overflow.
        (n > 0.0).then(|| self.values.iter().map(|v| v / n).sum())
    }
}

/// Takes those that are squared Mahalanobis distances and counts the others as refused.
impl Extend<f64> for Calibration {
    fn extend<I: IntoIterator<Item = f64>>(&mut self, values: I) {
        for value in values {
            // What was refused has been counted; there is nobody to report it to.
            let _counted = self.push(value);
        }
    }
}
