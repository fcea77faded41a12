//! A cost that keeps its steps to itself.

use terrace_crs::{Bounds, Cost, Evaluation};

use crate::TestCost;

/// Any cost, with the steps of its answers left out: what a method without them would see.
///
/// ```
/// use terrace_crs::{Cost, Step};
/// use terrace_staircases::{DeJong, TestCost, WithoutSteps};
///
/// let mut cost = DeJong::new(1)?.without_steps();
/// let answer = cost.evaluate(&[2.5]);
/// assert_eq!((answer.value, answer.step), (2.0, Step::Point));
/// # Ok::<(), terrace_staircases::ParameterError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct WithoutSteps<C>(pub C);

impl<C: Cost> Cost for WithoutSteps<C> {
    fn evaluate(&mut self, x: &[f64]) -> Evaluation {
        Evaluation::point(self.0.evaluate(x).value)
    }

    fn dimension(&self) -> Option<usize> {
        self.0.dimension()
    }
}

impl<C: TestCost> TestCost for WithoutSteps<C> {
    fn name(&self) -> String {
        self.0.name()
    }

    fn bounds(&self) -> Bounds {
        self.0.bounds()
    }

    fn minimum(&self) -> f64 {
        self.0.minimum()
    }

    fn minimiser(&self) -> Vec<f64> {
        self.0.minimiser()
    }

    fn step_count(&self) -> u128 {
        self.0.step_count()
    }
}
