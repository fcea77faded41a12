//! Where a search may look.

use thiserror::Error;

use crate::Axis;

/// The domain in which a minimum is looked for: the allowed values of each [`Axis`].
///
/// Checked when they are made: at least one axis; every end, value and width (`hi - lo`) finite; `lo <= hi`; lists not
/// empty and strictly ascending; whole numbers at most 2⁵³ from zero. An axis of zero width is allowed and holds that
/// coordinate fixed.
///
/// ```
/// use terrace_crs::{Axis, Bounds};
///
/// let bounds = Bounds::new([(0.0, 1.0), (-5.0, 5.0)])?;
/// assert_eq!(bounds.dimension(), 2);
/// assert!(bounds.contains(&[1.0, 0.0]));
/// assert!(Bounds::interval(1.0, 0.0).is_err());
///
/// // A threshold, a number of repeats, and the wells of a laboratory plate, which are 6, 24 or 96.
/// let mixed = Bounds::of([
///     Axis::Real { lo: 0.0, hi: 1.0 },
///     Axis::Integer { lo: 1, hi: 30 },
///     Axis::List(vec![6.0, 24.0, 96.0]),
/// ])?;
/// assert!(mixed.contains(&[0.3, 4.0, 24.0]));
/// assert!(!mixed.contains(&[0.3, 4.5, 24.0]));
/// # Ok::<(), terrace_crs::BoundsError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Bounds {
    axes: Vec<Axis>,
}

/// Why axes do not make [`Bounds`]. Axes count from zero.
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
    /// A list of allowed values has none.
    #[error("axis {axis}: the list of values is empty")]
    EmptyList {
        /// The axis.
        axis: usize,
    },
    /// A value of a list is NaN or infinite.
    #[error("axis {axis}: value {index} of the list is {value:?}, not a finite number")]
    ValueNotFinite {
        /// The axis.
        axis: usize,
        /// Which value of the list.
        index: usize,
        /// The value.
        value: f64,
    },
    /// A list of values must be in rising order and hold each value once.
    #[error("axis {axis}: value {index} of the list, {value:?}, is not above the one before it, {before:?}")]
    NotAscending {
        /// The axis.
        axis: usize,
        /// Which value of the list.
        index: usize,
        /// The value before it.
        before: f64,
        /// The value.
        value: f64,
    },
    /// Places are made of `f64`s, and beyond 2⁵³ from zero an `f64` cannot hold every whole number.
    #[error("axis {axis}: the whole numbers [{lo}, {hi}] reach beyond 2^53 from zero")]
    Inexact {
        /// The axis.
        axis: usize,
        /// Its lowest number.
        lo: i64,
        /// Its highest number.
        hi: i64,
    },
}

impl Bounds {
    /// Bounds of real axes, from the pair `(lo, hi)` of each.
    ///
    /// # Errors
    ///
    /// A [`BoundsError`] for the first axis that breaks a rule of [`Bounds`], or because there is no axis.
    pub fn new(axes: impl IntoIterator<Item = (f64, f64)>) -> Result<Self, BoundsError> {
        Self::of(axes.into_iter().map(|(lo, hi)| Axis::Real { lo, hi }))
    }

    /// Bounds of any axes.
    ///
    /// # Errors
    ///
    /// A [`BoundsError`] for the first axis that breaks a rule of [`Bounds`], or because there is no axis.
    pub fn of(axes: impl IntoIterator<Item = Axis>) -> Result<Self, BoundsError> {
        let axes: Vec<Axis> = axes.into_iter().collect();
        if axes.is_empty() {
            return Err(BoundsError::Empty);
        }
        for (number, axis) in axes.iter().enumerate() {
            axis.check(number)?;
        }
        Ok(Self { axes })
    }

    /// Bounds of a single real axis.
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

    /// The axes, in the order of the coordinates.
    pub fn axes(&self) -> &[Axis] {
        &self.axes
    }

    /// Whether `x` is an allowed place: on each axis an allowed value, both ends included. A NaN, or another number of
    /// axes, never is.
    pub fn contains(&self, x: &[f64]) -> bool {
        x.len() == self.axes.len() && self.outside(x).is_none()
    }

    /// The allowed place nearest to `x` on each axis; see [`Axis::nearest`]. If `x` has fewer coordinates than there
    /// are axes, so has the result; coordinates beyond the last axis are dropped.
    pub fn nearest(&self, x: &[f64]) -> Vec<f64> {
        self.axes.iter().zip(x).map(|(axis, x)| axis.nearest(*x)).collect()
    }

    /// The first axis on which `x` is not allowed. Axes that `x` or the bounds lack are not looked at.
    pub(crate) fn outside(&self, x: &[f64]) -> Option<usize> {
        self.axes.iter().zip(x).position(|(axis, x)| !axis.contains(*x))
    }

    /// Whether `x` lies between the ends on each axis, allowed value or not.
    pub(crate) fn surrounds(&self, x: &[f64]) -> bool {
        self.axes.iter().zip(x).all(|(axis, x)| axis.lo() <= *x && *x <= axis.hi())
    }

    /// Moves `x`, which may have left the bounds or the allowed values, to the nearest allowed place.
    pub(crate) fn snap(&self, x: &mut [f64]) {
        for (axis, x) in self.axes.iter().zip(x) {
            *x = axis.nearest(*x);
        }
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
