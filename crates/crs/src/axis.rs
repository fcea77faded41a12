//! One direction of the domain: which values a coordinate may take.

use crate::BoundsError;

/// The largest whole number up to which every whole number is an `f64`.
const EXACT: i64 = 1 << f64::MANTISSA_DIGITS;

/// The values one coordinate (one of the numbers that make a place) may take, in the unit of that coordinate.
///
/// It is checked when [`Bounds`](crate::Bounds) are made of it; what is said of the functions below holds for axes
/// that pass this check.
///
/// ```
/// use terrace_crs::Axis;
///
/// // Laboratory plates are sold with 6, 24 or 96 wells.
/// let wells = Axis::List(vec![6.0, 24.0, 96.0]);
/// assert_eq!((wells.lo(), wells.hi()), (6.0, 96.0));
/// assert!(!wells.contains(7.0));
/// assert_eq!(wells.nearest(12.0), 6.0);
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Axis {
    /// Every number of `[lo, hi]`, both ends included. With `lo == hi` the coordinate is held fixed.
    Real {
        /// The lower end.
        lo: f64,
        /// The upper end.
        hi: f64,
    },
    /// Every whole number of `[lo, hi]`, both ends included; at most 2⁵³ from zero, so that an `f64` holds each
    /// exactly.
    Integer {
        /// The lowest.
        lo: i64,
        /// The highest.
        hi: i64,
    },
    /// These values alone, in ascending order, without repetition.
    List(Vec<f64>),
}

impl Axis {
    /// The lowest allowed value; NaN for an empty list, which [`Bounds`](crate::Bounds) refuse.
    #[allow(clippy::cast_precision_loss, reason = "checked whole numbers are exact")]
    pub fn lo(&self) -> f64 {
        match self {
            Self::Real { lo, .. } => *lo,
            Self::Integer { lo, .. } => *lo as f64,
            Self::List(values) => values.first().copied().unwrap_or(f64::NAN),
        }
    }

    /// The highest allowed value; NaN for an empty list, which [`Bounds`](crate::Bounds) refuse.
    #[allow(clippy::cast_precision_loss, reason = "checked whole numbers are exact")]
    pub fn hi(&self) -> f64 {
        match self {
            Self::Real { hi, .. } => *hi,
            Self::Integer { hi, .. } => *hi as f64,
            Self::List(values) => values.last().copied().unwrap_or(f64::NAN),
        }
    }

    /// Whether `x` is an allowed value. A NaN never is.
    pub fn contains(&self, x: f64) -> bool {
        let inside = self.lo() <= x && x <= self.hi();
        match self {
            Self::Real { .. } => inside,
            Self::Integer { .. } => inside && x.fract() == 0.0,
            Self::List(values) => values.get(values.partition_point(|value| *value < x)) == Some(&x),
        }
    }

    /// The allowed value nearest to `x`; of two equally near ones the lower. A NaN gives the lowest.
    pub fn nearest(&self, x: f64) -> f64 {
        let Some(count) = self.count() else { return x.max(self.lo()).min(self.hi()) };
        let above = self.rank(x).min(count.saturating_sub(1));
        let (below, above) = (self.nth(above.saturating_sub(1)), self.nth(above));
        if x - below <= above - x { below } else { above }
    }

    /// The number of allowed values; `None` for a real axis with a positive width, whose values are not counted.
    pub fn count(&self) -> Option<u64> {
        match self {
            Self::Real { lo, hi } => (lo == hi).then_some(1),
            Self::Integer { lo, hi } => Some(hi.abs_diff(*lo).saturating_add(1)),
            Self::List(values) => Some(values.len() as u64),
        }
    }

    /// On an axis with a count: the number of allowed values below `x`.
    #[allow(clippy::cast_possible_truncation, reason = "clamped to checked whole numbers")]
    pub(crate) fn rank(&self, x: f64) -> u64 {
        match self {
            Self::Real { lo, .. } => u64::from(*lo < x),
            Self::Integer { lo, hi } => {
                // Beyond the upper end all values are below; a NaN has none below.
                if x > self.hi() {
                    hi.abs_diff(*lo) + 1
                } else {
                    (x.ceil().max(self.lo()) as i64).abs_diff(*lo)
                }
            }
            Self::List(values) => values.partition_point(|value| *value < x) as u64,
        }
    }

    /// On an axis with a count: the allowed value with `rank` values below it; beyond the last, the last.
    #[allow(clippy::cast_precision_loss, reason = "checked whole numbers are exact")]
    pub(crate) fn nth(&self, rank: u64) -> f64 {
        match self {
            Self::Real { lo, .. } => *lo,
            Self::Integer { lo, hi } => lo.saturating_add_unsigned(rank).min(*hi) as f64,
            Self::List(values) => {
                let at = usize::try_from(rank).unwrap_or(usize::MAX).min(values.len().saturating_sub(1));
                values.get(at).copied().unwrap_or(f64::NAN)
            }
        }
    }

    /// The lowest allowed value that is not below `x`.
    pub(crate) fn at_or_above(&self, x: f64) -> Option<f64> {
        match self.count() {
            None => (x <= self.hi()).then(|| x.max(self.lo())),
            Some(count) => Some(self.rank(x)).filter(|rank| *rank < count).map(|rank| self.nth(rank)),
        }
    }

    /// The half-open interval of all allowed values.
    pub(crate) fn span(&self) -> (f64, f64) {
        (self.lo(), self.hi().next_up())
    }

    /// The part of `[lo, hi)` that spans allowed values, or `None` when it holds none. On axes with a count the ends
    /// are pulled in to the values themselves, so that equal sets have equal ends.
    pub(crate) fn within(&self, lo: f64, hi: f64) -> Option<(f64, f64)> {
        let (lo, hi) = if self.count().is_none() {
            let (first, end) = self.span();
            (lo.max(first), hi.min(end))
        } else {
            let (first, end) = (self.rank(lo), self.rank(hi));
            if first >= end {
                return None;
            }
            (self.nth(first), self.nth(end - 1).next_up())
        };
        (lo < hi).then_some((lo, hi))
    }

    /// The share of the axis in `[lo, hi)`: of its width, or of its values when they can be counted.
    pub(crate) fn share(&self, lo: f64, hi: f64) -> f64 {
        match self.count() {
            None => (hi.min(self.hi()) - lo.max(self.lo())).max(0.0) / (self.hi() - self.lo()),
            Some(count) => self.rank(hi).saturating_sub(self.rank(lo)) as f64 / count as f64,
        }
    }

    /// The allowed value at the part `at` of the way through `[lo, hi)`, an interval as [`within`](Self::within) gives
    /// it: 0 is its first value, 1 its last.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between zero and the count")]
    pub(crate) fn part(&self, lo: f64, hi: f64, at: f64) -> f64 {
        if self.count().is_none() {
            return (lo + at * (hi.min(self.hi()) - lo)).min(hi.next_down()).max(lo);
        }
        let (first, end) = (self.rank(lo), self.rank(hi));
        let last = end.saturating_sub(first).saturating_sub(1);
        self.nth(first + ((at * last as f64) as u64).min(last))
    }

    pub(crate) fn check(&self, axis: usize) -> Result<(), BoundsError> {
        let (lo, hi) = (self.lo(), self.hi());
        match self {
            Self::Integer { lo: first, hi: last } => {
                if !(-EXACT..=EXACT).contains(first) || !(-EXACT..=EXACT).contains(last) {
                    return Err(BoundsError::Inexact { axis, lo: *first, hi: *last });
                }
            }
            Self::List(values) => {
                if values.is_empty() {
                    return Err(BoundsError::EmptyList { axis });
                }
                if let Some(index) = values.iter().position(|value| !value.is_finite()) {
                    return Err(BoundsError::ValueNotFinite { axis, index, value: values[index] });
                }
                if let Some(index) = values.windows(2).position(|pair| pair[0] >= pair[1]) {
                    let (before, value) = (values[index], values[index + 1]);
                    return Err(BoundsError::NotAscending { axis, index: index + 1, before, value });
                }
            }
            Self::Real { .. } => {}
        }
        if !(lo.is_finite() && hi.is_finite()) {
            return Err(BoundsError::NotFinite { axis, lo, hi });
        }
        if lo > hi {
            return Err(BoundsError::Reversed { axis, lo, hi });
        }
        if !(hi - lo).is_finite() {
            return Err(BoundsError::TooWide { axis, lo, hi });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn integers() -> Axis {
        Axis::Integer { lo: -2, hi: 3 }
    }

    #[test]
    fn ranks_and_values_are_inverse() {
        for axis in [integers(), Axis::List(vec![-1.5, 0.0, 0.25, 7.0]), Axis::Real { lo: 2.0, hi: 2.0 }] {
            let count = axis.count().unwrap();
            for rank in 0..count {
                let value = axis.nth(rank);
                assert!(axis.contains(value));
                assert_eq!(axis.rank(value), rank);
                assert_eq!(axis.rank(value.next_up()), rank + 1);
                assert_eq!(axis.nearest(value), value);
            }
            assert_eq!((axis.rank(f64::NEG_INFINITY), axis.rank(f64::INFINITY)), (0, count));
            assert_eq!(axis.nth(count + 5), axis.hi());
        }
    }

    #[test]
    fn the_nearest_value_is_the_lower_one_of_two() {
        assert_eq!(integers().nearest(0.5), 0.0);
        assert_eq!(integers().nearest(0.5_f64.next_up()), 1.0);
        assert_eq!((integers().nearest(-9.0), integers().nearest(9.0)), (-2.0, 3.0));
        assert_eq!(integers().nearest(f64::NAN), -2.0);
        assert_eq!(Axis::Real { lo: 0.0, hi: 1.0 }.nearest(f64::NAN), 0.0);
    }

    #[test]
    fn intervals_are_pulled_in_to_values() {
        assert_eq!(integers().within(-0.5, 1.0), Some((0.0, 0.0_f64.next_up())));
        assert_eq!(integers().within(0.1, 0.9), None);
        assert_eq!(integers().share(f64::NEG_INFINITY, 0.5), 0.5);
        assert_eq!(integers().part(-2.0, 3.0_f64.next_up(), 0.5), 0.0);
        let real = Axis::Real { lo: 0.0, hi: 1.0 };
        assert_eq!(real.within(-1.0, 9.0), Some((0.0, 1.0_f64.next_up())));
        assert_eq!(real.share(0.75, 9.0), 0.25);
        assert_eq!(real.part(1.0, 1.0_f64.next_up(), 0.5), 1.0);
    }

    #[test]
    fn values_at_or_above() {
        assert_eq!(integers().at_or_above(0.1), Some(1.0));
        assert_eq!(integers().at_or_above(3.1), None);
        assert_eq!(Axis::Real { lo: 0.0, hi: 1.0 }.at_or_above(1.0), Some(1.0));
        assert_eq!(Axis::Real { lo: 0.0, hi: 1.0 }.at_or_above(f64::INFINITY), None);
    }

    #[test]
    fn what_is_no_axis_is_an_error_with_its_values() {
        let check = |axis: Axis| axis.check(1).unwrap_err();
        assert_eq!(check(Axis::List(vec![])), BoundsError::EmptyList { axis: 1 });
        assert_eq!(
            check(Axis::List(vec![0.0, 2.0, 2.0])),
            BoundsError::NotAscending { axis: 1, index: 2, before: 2.0, value: 2.0 }
        );
        assert!(matches!(
            check(Axis::List(vec![0.0, f64::NAN])),
            BoundsError::ValueNotFinite { axis: 1, index: 1, .. }
        ));
        let (lo, hi) = (0, EXACT + 1);
        assert_eq!(check(Axis::Integer { lo, hi }), BoundsError::Inexact { axis: 1, lo, hi });
        assert_eq!(
            check(Axis::Integer { lo: 1, hi: 0 }),
            BoundsError::Reversed { axis: 1, lo: 1.0, hi: 0.0 }
        );
        assert!(Axis::Integer { lo: -EXACT, hi: EXACT }.check(0).is_ok());
    }
}
