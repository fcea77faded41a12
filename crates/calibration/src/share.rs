//! Shares with their intervals, and bounds that were exceeded.

use crate::chi_squared::two_sided;
use crate::error::CalibrationError;

/// How many of how many: a share that knows how little it may be worth.
///
/// ```
/// use terrace_calibration::Share;
///
/// let share = Share::new(19, 20).unwrap();
/// let [low, high] = share.interval(0.95).unwrap();
/// assert_eq!(share.value(), 0.95);
/// assert!((low - 0.7639).abs() < 1e-4 && (high - 0.9911).abs() < 1e-4);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Share {
    hits: usize,
    of: usize,
}

impl Share {
    /// `hits` out of `of`; `None` for shares of nothing and for more hits than there are.
    pub fn new(hits: usize, of: usize) -> Option<Self> {
        (of > 0 && hits <= of).then_some(Self { hits, of })
    }

    /// How many.
    pub fn hits(self) -> usize {
        self.hits
    }

    /// Of how many; at least one.
    pub fn of(self) -> usize {
        self.of
    }

    /// The share itself, from 0 to 1.
    pub fn value(self) -> f64 {
        self.hits as f64 / self.of as f64
    }

    /// Wilson's score interval: the probabilities under which a share at least this far off has at least a chance of
    /// 1 − `level` (normal approximation, independent trials). `None` when the level is not above 0 and below 1.
    ///
    /// It contains the share, stays within 0 to 1 and has a width also when there were no hits, or nothing but hits.
    pub fn interval(self, level: f64) -> Option<[f64; 2]> {
        let z = two_sided(level)?;
        let (n, share) = (self.of as f64, self.value());
        let shrink = 1.0 + z * z / n;
        let centre = (share + z * z / (2.0 * n)) / shrink;
        let reach = z / shrink * (share * (1.0 - share) / n + z * z / (4.0 * n * n)).sqrt();
        // Rounding alone could leave the share outside at 0 and 1.
        Some([(centre - reach).clamp(0.0, share), (centre + reach).clamp(share, 1.0)])
    }
}

/// Counts how often an error exceeds the bound stated for it.
///
/// A bound that is to hold with 95 % is exceeded by 5 % of the errors: by more when it is too tight, by fewer when it is
/// wider than it need be.
///
/// ```
/// use terrace_calibration::Exceedance;
///
/// let mut beyond = Exceedance::new();
/// for error in [0.01, -0.03, 0.002, 0.0] {
///     beyond.push_error(error, 0.02)?;
/// }
/// beyond.push(false);
/// assert_eq!(beyond.share().map(|share| (share.hits(), share.of())), Some((1, 5)));
/// # Ok::<(), terrace_calibration::CalibrationError>(())
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Exceedance {
    exceeded: usize,
    count: usize,
}

impl Exceedance {
    /// Nothing counted yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Counts one bound that was exceeded, or was not.
    pub fn push(&mut self, exceeded: bool) {
        self.count += 1;
        self.exceeded += usize::from(exceeded);
    }

    /// Compares the size of an error with its bound, both in the same unit; equal is not exceeded. Tells which it was.
    ///
    /// # Errors
    /// [`CalibrationError::Bound`] when one of them is NaN or the bound is negative; then nothing is counted. (NaN written
    /// as `error.abs() > bound` would count as a bound that held.)
    pub fn push_error(&mut self, error: f64, bound: f64) -> Result<bool, CalibrationError> {
        if error.is_nan() || bound.is_nan() || bound < 0.0 {
            return Err(CalibrationError::Bound { error, bound });
        }
        let exceeded = error.abs() > bound;
        self.push(exceeded);
        Ok(exceeded)
    }

    /// Adds what another has counted.
    pub fn merge(&mut self, other: &Self) {
        self.exceeded += other.exceeded;
        self.count += other.count;
    }

    /// The share of bounds that were exceeded; `None` when none was counted.
    pub fn share(&self) -> Option<Share> {
        Share::new(self.exceeded, self.count)
    }
}

#[cfg(test)]
mod tests {
    use super::{CalibrationError, Exceedance, Share};

    #[test]
    fn no_share_of_nothing() {
        assert_eq!(Share::new(0, 0), None);
        assert_eq!(Share::new(2, 1), None);
        assert_eq!(Exceedance::new().share(), None);
    }

    #[test]
    fn known_intervals() {
        // By 30-digit arithmetic (mpmath); 81 of 263 is the example of Newcombe (1998), who has 0.2553 to 0.3662.
        for (hits, of, low, high) in
            [(0, 10, 0.0, 0.277_532_8), (81, 263, 0.255_288_5, 0.366_209_6), (10, 10, 0.722_467_2, 1.0)]
        {
            let [a, b] = Share::new(hits, of).unwrap().interval(0.95).unwrap();
            assert!((a - low).abs() < 1e-6 && (b - high).abs() < 1e-6, "{hits} of {of}: {a} {b}");
        }
        for level in [0.0, 1.0, -1.0, f64::NAN] {
            assert_eq!(Share::new(1, 2).unwrap().interval(level), None);
        }
    }

    #[test]
    fn what_cannot_be_compared_is_not_counted() {
        let mut beyond = Exceedance::new();
        for (error, bound) in [(f64::NAN, 1.0), (1.0, f64::NAN), (1.0, -1.0)] {
            assert!(matches!(beyond.push_error(error, bound), Err(CalibrationError::Bound { .. })));
        }
        assert_eq!(beyond.share(), None);
        assert_eq!(beyond.push_error(-2.0, 2.0), Ok(false));
        assert_eq!(beyond.push_error(f64::NEG_INFINITY, 2.0), Ok(true));
        let mut both = beyond;
        both.merge(&beyond);
        assert_eq!(both.share(), Share::new(2, 4));
    }
}
