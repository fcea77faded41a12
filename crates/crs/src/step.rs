//! Where a value is known to hold.

use std::fmt;
use std::ops::Range;

/// The places at which one value of a cost is known to hold: an interval, with several axes a box (an interval on
/// each), or a single place.
#[derive(Debug, Clone, PartialEq)]
pub enum Step {
    /// Only the place that was asked for.
    Point,
    /// Every `x` with `lo[i] <= x[i] < hi[i]` on each axis `i`. Either end may be infinite.
    Box {
        /// The lower corner, which belongs to the step.
        lo: Vec<f64>,
        /// The upper corner, which does not.
        hi: Vec<f64>,
    },
}

impl Step {
    /// The step of a cost with one axis.
    pub fn interval(interval: Range<f64>) -> Self {
        Self::Box { lo: vec![interval.start], hi: vec![interval.end] }
    }

    /// Whether the value found at `origin` is known to hold at `x` as well.
    ///
    /// `origin` matters only for [`Step::Point`], which contains `origin` alone. A NaN, or another number of axes, is
    /// never inside.
    ///
    /// ```
    /// use terrace_crs::Step;
    ///
    /// let step = Step::interval(0.0..1.0);
    /// assert!(step.contains(&[0.5], &[0.0]));
    /// assert!(!step.contains(&[0.5], &[1.0]));
    /// assert!(!Step::Point.contains(&[0.5], &[0.6]));
    /// ```
    pub fn contains(&self, origin: &[f64], x: &[f64]) -> bool {
        match self {
            Self::Point => origin == x,
            Self::Box { lo, hi } => {
                lo.len() == x.len()
                    && hi.len() == x.len()
                    && x.iter().zip(lo).zip(hi).all(|((x, lo), hi)| lo <= x && x < hi)
            }
        }
    }
}

/// `x alone`, or the intervals of the axes as `[0, 1) x [2, 3)`.
impl fmt::Display for Step {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Point => f.write_str("x alone"),
            Self::Box { lo, hi } if lo.len() == hi.len() => {
                for (axis, (lo, hi)) in lo.iter().zip(hi).enumerate() {
                    let times = if axis == 0 { "" } else { " x " };
                    write!(f, "{times}[{lo:?}, {hi:?})")?;
                }
                Ok(())
            }
            Self::Box { lo, hi } => write!(f, "box from {lo:?} to {hi:?}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_of_unequal_length_contain_nothing_and_can_be_shown() {
        let step = Step::Box { lo: vec![0.0], hi: vec![1.0, 1.0] };
        assert!(!step.contains(&[0.5], &[0.5]));
        assert!(!step.contains(&[0.5, 0.5], &[0.5, 0.5]));
        assert_eq!(step.to_string(), "box from [0.0] to [1.0, 1.0]");
    }

    #[test]
    fn nan_is_in_no_step() {
        assert!(!Step::Point.contains(&[f64::NAN], &[f64::NAN]));
        assert!(!Step::interval(f64::NEG_INFINITY..f64::INFINITY).contains(&[0.0], &[f64::NAN]));
    }

    #[test]
    fn intervals_are_shown_half_open() {
        let step = Step::Box { lo: vec![0.0, 2.0], hi: vec![1.0, f64::INFINITY] };
        assert_eq!(step.to_string(), "[0.0, 1.0) x [2.0, inf)");
    }
}
