//! What is minimised: a [`Cost`] answers with a value and the step on which it holds.

use std::ops::Range;

use crate::Step;

/// A cost to be minimised, asked for its value at one place (one number per axis) at a time.
///
/// # Contract
///
/// * The value is finite, and the same whenever it is asked for at the same `x`.
/// * The [`Step`] contains `x`, and the value holds at *every* place of it. A smaller step than the true one is
///   allowed and only costs evaluations; a larger one is wrong. When nothing is known, [`Step::Point`] is right.
///
/// A search checks this as far as its own questions show it; a breach is a [`CostError`](crate::CostError) that names
/// `x`. The functions take `&mut self` so that a cost may keep buffers and counters.
///
/// On an axis of whole numbers or listed values a step is an interval `[lo, hi)` too, and covers the allowed values in
/// it; [`Step::Point`] covers that one value.
///
/// Functions and closures become costs by [`from_fn`], [`from_line`] and [`from_stairs`], and by
/// [`in_parallel`](crate::in_parallel) when they may run on several threads.
///
/// # Examples
///
/// The sum of squares of rounded numbers, in any number of axes: each step is a box with sides of length 1.
///
/// ```
/// use terrace_crs::{Cost, Evaluation, Step};
///
/// struct Rounded;
///
/// impl Cost for Rounded {
///     fn evaluate(&mut self, x: &[f64]) -> Evaluation {
///         let lo: Vec<f64> = x.iter().map(|v| v.floor()).collect();
///         let hi = lo.iter().map(|v| v + 1.0).collect();
///         let value = lo.iter().map(|v| v * v).sum();
///         Evaluation { value, step: Step::Box { lo, hi } }
///     }
/// }
///
/// assert_eq!(Rounded.evaluate(&[1.5, -0.5]).value, 2.0);
/// ```
pub trait Cost {
    /// The value at `x`, and the step around `x` on which it is known to hold.
    fn evaluate(&mut self, x: &[f64]) -> Evaluation;

    /// As [`evaluate`](Self::evaluate), but may give up as soon as it knows that the value is not below `ceiling`,
    /// which is at or above the lowest value of the search so far.
    ///
    /// A sum of parts that are never negative, for one, can stop adding when it reaches `ceiling`. Only the methods
    /// that look for a proof ask this way ([`Sweep`](crate::Sweep) and [`CertifiedSearch`](crate::CertifiedSearch)).
    /// The default never gives up.
    ///
    /// ```
    /// use terrace_crs::{Answer, Bounds, Cost, Evaluation, StopReason, Sweep};
    ///
    /// /// A cost of two parts; imagine that the second takes long to compute.
    /// struct Parts;
    ///
    /// impl Parts {
    ///     fn cheap(x: &[f64]) -> Evaluation {
    ///         let lo = x[0].floor();
    ///         Evaluation::interval((lo - 7.0).abs(), lo..lo + 1.0)
    ///     }
    /// }
    ///
    /// impl Cost for Parts {
    ///     fn evaluate(&mut self, x: &[f64]) -> Evaluation {
    ///         let cheap = Self::cheap(x);
    ///         Evaluation { value: cheap.value + 0.5, ..cheap }
    ///     }
    ///
    ///     fn evaluate_below(&mut self, x: &[f64], ceiling: f64) -> Answer {
    ///         let cheap = Self::cheap(x);
    ///         if cheap.value >= ceiling { Answer::AtLeast(cheap) } else { Answer::Exact(self.evaluate(x)) }
    ///     }
    /// }
    ///
    /// let minimum = Sweep::default().minimise(&mut Parts, &Bounds::interval(0.0, 10.0)?)?;
    /// assert_eq!((minimum.value, minimum.stop), (0.5, StopReason::Certified));
    /// assert!(minimum.trace.iter().any(|trial| trial.source.is_bound()));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    fn evaluate_below(&mut self, x: &[f64], ceiling: f64) -> Answer {
        let _ = ceiling;
        Answer::Exact(self.evaluate(x))
    }

    /// The answers at several places, in their order; each must be as [`evaluate`](Self::evaluate) would give it.
    ///
    /// For costs that can share work or threads between places; the default asks one after another.
    fn evaluate_many(&mut self, xs: &[Vec<f64>]) -> Vec<Evaluation> {
        xs.iter().map(|x| self.evaluate(x)).collect()
    }

    /// The number of axes this cost is made for; `None` (the default) when it takes any.
    ///
    /// A search refuses bounds with another number of axes before it asks for a value.
    fn dimension(&self) -> Option<usize> {
        None
    }
}

impl<C: Cost + ?Sized> Cost for &mut C {
    fn evaluate(&mut self, x: &[f64]) -> Evaluation {
        (**self).evaluate(x)
    }

    fn evaluate_below(&mut self, x: &[f64], ceiling: f64) -> Answer {
        (**self).evaluate_below(x, ceiling)
    }

    fn evaluate_many(&mut self, xs: &[Vec<f64>]) -> Vec<Evaluation> {
        (**self).evaluate_many(xs)
    }

    fn dimension(&self) -> Option<usize> {
        (**self).dimension()
    }
}

/// The answer of a [`Cost`] that may give up early.
#[derive(Debug, Clone, PartialEq)]
pub enum Answer {
    /// The value, and where it holds.
    Exact(Evaluation),
    /// The cost gave up: nowhere on the step is it below the value given, a finite number at or above the ceiling it
    /// was asked with.
    AtLeast(Evaluation),
}

/// The answer of a [`Cost`]: a value, and where it holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Evaluation {
    /// The cost at the place asked for.
    pub value: f64,
    /// The places, that one included, at which `value` is known to hold.
    pub step: Step,
}

impl Evaluation {
    /// A value known only at the place it was asked for.
    pub fn point(value: f64) -> Self {
        Self { value, step: Step::Point }
    }

    /// A value known on an interval of a single axis, the start included and the end not.
    pub fn interval(value: f64, interval: Range<f64>) -> Self {
        Self { value, step: Step::interval(interval) }
    }
}

/// A cost of any number of axes from a function that knows no steps.
///
/// ```
/// use terrace_crs::{Cost, from_fn};
///
/// let mut squares = from_fn(|x| x.iter().map(|v| v * v).sum());
/// assert_eq!(squares.evaluate(&[3.0, 4.0]).value, 25.0);
/// ```
pub fn from_fn<F: FnMut(&[f64]) -> f64>(function: F) -> impl Cost {
    struct Points<F>(F);
    impl<F: FnMut(&[f64]) -> f64> Cost for Points<F> {
        fn evaluate(&mut self, x: &[f64]) -> Evaluation {
            Evaluation::point((self.0)(x))
        }
    }
    Points(function)
}

/// A cost of one axis from a function that knows no steps.
///
/// ```
/// use terrace_crs::{Cost, Step, from_line};
///
/// let mut cost = from_line(|x| x.round().abs());
/// let answer = cost.evaluate(&[2.4]);
/// assert_eq!((answer.value, answer.step), (2.0, Step::Point));
/// ```
pub fn from_line<F: FnMut(f64) -> f64>(mut function: F) -> impl Cost {
    Axis(move |x| Evaluation::point(function(x)))
}

/// A cost of one axis from a function that returns its value and the interval on which the value holds.
///
/// ```
/// use terrace_crs::{Cost, Step, from_stairs};
///
/// let mut cost = from_stairs(|x| (x.floor().abs(), x.floor()..x.floor() + 1.0));
/// let answer = cost.evaluate(&[2.4]);
/// assert_eq!((answer.value, answer.step), (2.0, Step::interval(2.0..3.0)));
/// ```
pub fn from_stairs<F: FnMut(f64) -> (f64, Range<f64>)>(mut function: F) -> impl Cost {
    Axis(move |x| {
        let (value, interval) = function(x);
        Evaluation::interval(value, interval)
    })
}

struct Axis<F>(F);

impl<F: FnMut(f64) -> Evaluation> Cost for Axis<F> {
    fn evaluate(&mut self, x: &[f64]) -> Evaluation {
        // Searches check `dimension` first; for a direct call with another length NaN is the honest answer.
        match x {
            [x] => (self.0)(*x),
            _ => Evaluation::point(f64::NAN),
        }
    }

    fn dimension(&self) -> Option<usize> {
        Some(1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cost_of_one_axis_has_no_value_at_other_places() {
        let mut cost = from_stairs(|x| (x, x..f64::INFINITY));
        assert_eq!(cost.dimension(), Some(1));
        assert!(cost.evaluate(&[]).value.is_nan());
        assert!(cost.evaluate(&[1.0, 2.0]).value.is_nan());
    }

    #[test]
    fn a_borrowed_or_boxed_cost_is_a_cost() {
        fn ask(mut cost: impl Cost) -> (f64, Answer, usize, Option<usize>) {
            let many = cost.evaluate_many(&[vec![1.0], vec![2.0]]).len();
            (cost.evaluate(&[3.0]).value, cost.evaluate_below(&[4.0], 0.0), many, cost.dimension())
        }
        let mut cost = from_line(|x| x);
        let expected = (3.0, Answer::Exact(Evaluation::point(4.0)), 2, Some(1));
        assert_eq!(ask(&mut cost), expected);
        let object: &mut dyn Cost = &mut cost;
        assert_eq!(ask(object), expected);
    }

    #[test]
    fn closures_may_keep_state() {
        let mut asked = 0;
        let mut cost = from_fn(|_| {
            asked += 1;
            0.0
        });
        cost.evaluate(&[0.0]);
        cost.evaluate(&[0.0]);
        drop(cost);
        assert_eq!(asked, 2);
    }
}
