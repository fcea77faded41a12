//! What is known of a test function.

use terrace_crs::{Bounds, Cost};

use crate::WithoutSteps;

/// A cost of which everything is known beforehand.
///
/// # Contract
///
/// * No place within [`bounds`](Self::bounds) has a value below [`minimum`](Self::minimum), and
///   [`minimiser`](Self::minimiser) has exactly it.
/// * The steps it answers with are exact: two places have the same box or disjoint ones, and there are
///   [`step_count`](Self::step_count) of them.
///
/// The trait can be used as `dyn TestCost`, so that a list can hold functions of several types:
///
/// ```
/// use terrace_staircases::{DeJong, Needle, TestCost};
///
/// let costs: Vec<Box<dyn TestCost>> = vec![Box::new(DeJong::new(5)?), Box::new(Needle::flat(1, 0.3, 0.01)?)];
/// let known: Vec<_> = costs.iter().map(|cost| (cost.name(), cost.minimum(), cost.step_count())).collect();
/// assert_eq!(known, [("de-jong".into(), -30.0, 248_832), ("needle".into(), 0.0, 3)]);
/// # Ok::<(), terrace_staircases::ParameterError>(())
/// ```
pub trait TestCost: Cost {
    /// A short name, without the number of axes.
    fn name(&self) -> String;

    /// Where it is to be minimised.
    fn bounds(&self) -> Bounds;

    /// The lowest value within the bounds.
    fn minimum(&self) -> f64;

    /// One place within the bounds at which the lowest value is taken; with the step there, often many.
    fn minimiser(&self) -> Vec<f64>;

    /// The number of steps within the bounds; `u128::MAX` if there are more.
    fn step_count(&self) -> u128;

    /// The same function for methods that know no steps: it answers with [`Step::Point`](terrace_crs::Step::Point).
    fn without_steps(self) -> WithoutSteps<Self>
    where
        Self: Sized,
    {
        WithoutSteps(self)
    }
}
