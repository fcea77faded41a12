//! Where a search may look.

use thiserror::Error;

/// The box in which a minimum is looked for: a closed interval `[lo, hi]` for each axis.
///
/// Valid by construction: at least one axis; every end and every width finite; `lo <= hi`. An axis of zero width
/// is allowed and holds that coordinate fixed.
///
/// ```
/// use terrace_crs::Bounds;
///
/// let bounds = Bounds::new([(0.0, 1.0), (-5.0, 5.0)])?;
/// assert_eq!(bounds.dimension(), 2);
/// assert!(bounds.contains(&[1.0, 0.0]));
/// assert!(Bounds::interval(1.0, 0.0).is_err());
/// # Ok::<(), terrace_crs::BoundsError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Bounds {
    axes: Vec<(f64, f64)>,
}

/// Why a box cannot be searched. Axes count from zero.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[non_exhaustive]
pub enum BoundsError {
    /// There is no axis to search along.
    #[error("bounds need at least one axis")]
    Empty,
    /// An end is NaN or infinite: give the largest range that makes sense instead.
    #[error("axis {axis}: the bounds [{lo:?}, {hi:?}] are not finite")]
    NotFinite {
        /// The axis.
        axis: usize,
        /// Its lower end.
        lo: f64,
        /// Its upper end.
        hi: f64,
    },
    /// The ends are in the wrong order.
    #[error("axis {axis}: the lower bound {lo:?} is above the upper bound {hi:?}")]
    Reversed {
        /// The axis.
        axis: usize,
        /// Its lower end.
        lo: f64,
        /// Its upper end.
        hi: f64,
    },
    /// Both ends are finite, but `hi - lo` is more than an `f64` holds: scale the axis down.
    #[error("axis {axis}: the width of the bounds [{lo:?}, {hi:?}] overflows")]
    TooWide {
        /// The axis.
        axis: usize,
        /// Its lower end.
        lo: f64,
        /// Its upper end.
        hi: f64,
    },
}

impl Bounds {
    /// Bounds from the pair `(lo, hi)` of each axis.
    ///
    /// # Errors
    ///
    /// A [`BoundsError`] for the first axis that breaks a rule above.
    pub fn new(axes: impl IntoIterator<Item = (f64, f64)>) -> Result<Self, BoundsError> {
        let axes: Vec<(f64, f64)> = axes.into_iter().collect();
        if axes.is_empty() {
            return Err(BoundsError::Empty);
        }
        for (axis, &(lo, hi)) in axes.iter().enumerate() {
            if !(lo.is_finite() && hi.is_finite()) {
                return Err(BoundsError::NotFinite { axis, lo, hi });
            }
            if lo > hi {
                return Err(BoundsError::Reversed { axis, lo, hi });
            }
            if !(hi - lo).is_finite() {
                return Err(BoundsError::TooWide { axis, lo, hi });
            }
        }
        Ok(Self { axes })
    }

    /// Bounds of a single axis.
    ///
    /// # Errors
    ///
    /// As [`new`](Self::new).
    pub fn interval(lo: f64, hi: f64) -> Result<Self, BoundsError> {
        Self::new([(lo, hi)])
    }

    /// The number of axes, at least one.
    pub fn dimension(&self) -> usize {
        self.axes.len()
    }

    /// The pair `(lo, hi)` of each axis.
    pub fn axes(&self) -> &[(f64, f64)] {
        &self.axes
    }

    /// Whether `x` lies inside; both ends belong to the bounds. A NaN, or another number of axes, never does.
    pub fn contains(&self, x: &[f64]) -> bool {
        x.len() == self.axes.len() && self.outside(x).is_none()
    }

    /// The first axis on which `x` leaves the bounds. Axes that `x` or the bounds lack are not looked at.
    pub(crate) fn outside(&self, x: &[f64]) -> Option<usize> {
        self.axes.iter().zip(x).position(|((lo, hi), x)| !(lo <= x && x <= hi))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn empty_bounds_are_an_error() {
        assert_eq!(Bounds::new([]), Err(BoundsError::Empty));
    }

    #[test]
    fn nan_and_infinite_ends_name_axis_and_values() {
        let error = Bounds::new([(0.0, 1.0), (0.0, f64::INFINITY)]);
        assert_eq!(error, Err(BoundsError::NotFinite { axis: 1, lo: 0.0, hi: f64::INFINITY }));
        let error = Bounds::interval(f64::NAN, 1.0).unwrap_err();
        assert_eq!(error.to_string(), "axis 0: the bounds [NaN, 1.0] are not finite");
    }

    #[test]
    fn reversed_ends_name_axis_and_values() {
        assert_eq!(Bounds::interval(2.0, 1.0), Err(BoundsError::Reversed { axis: 0, lo: 2.0, hi: 1.0 }));
    }

    #[test]
    fn a_width_that_overflows_is_an_error() {
        let (lo, hi) = (-f64::MAX, f64::MAX);
        assert_eq!(Bounds::interval(lo, hi), Err(BoundsError::TooWide { axis: 0, lo, hi }));
    }

    #[test]
    fn zero_width_holds_one_place() {
        let bounds = Bounds::interval(0.3, 0.3).unwrap();
        assert!(bounds.contains(&[0.3]));
        assert!(!bounds.contains(&[0.3_f64.next_up()]));
    }

    #[test]
    fn nan_and_other_dimensions_are_outside() {
        let bounds = Bounds::interval(0.0, 1.0).unwrap();
        assert!(!bounds.contains(&[f64::NAN]));
        assert!(!bounds.contains(&[]));
        assert!(!bounds.contains(&[0.5, 0.5]));
    }
}
