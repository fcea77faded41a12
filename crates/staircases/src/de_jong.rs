//! De Jong's step function.

use terrace_crs::{Bounds, Cost, Evaluation};

use crate::cells::Cells;
use crate::{ParameterError, TestCost};

const HALF: f64 = 5.12;

/// De Jong's step function: a flight of stairs down into one corner.
///
/// * Formula: f(x) = ⌊x₁⌋ + … + ⌊x_d⌋
/// * Domain: [-5.12, 5.12]ᵈ; outside, the outermost steps go on.
/// * Optimum: -6 *d*, on all of [-5.12, -5)ᵈ: a share of 0.012 of each axis.
/// * Steps: 12ᵈ, whole numbers apart.
/// * Source: K. A. De Jong, *An Analysis of the Behavior of a Class of Genetic Adaptive Systems*, doctoral
///   dissertation, University of Michigan, 1975: function F3, there with *d* = 5. (Some texts add 6 *d*, so that the
///   optimum is 0.)
///
/// ```
/// use terrace_crs::{Cost, Step};
/// use terrace_staircases::{DeJong, TestCost};
///
/// let mut cost = DeJong::new(2)?;
/// let answer = cost.evaluate(&[1.5, -0.5]);
/// assert_eq!(answer.value, 0.0);
/// assert_eq!(answer.step, Step::Box { lo: vec![1.0, -1.0], hi: vec![2.0, 0.0] });
/// assert_eq!((cost.minimum(), cost.step_count()), (-12.0, 144));
/// # Ok::<(), terrace_staircases::ParameterError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct DeJong {
    cells: Cells,
    bounds: Bounds,
}

impl DeJong {
    /// The function of `dimension` axes.
    ///
    /// # Errors
    ///
    /// No axes.
    pub fn new(dimension: usize) -> Result<Self, ParameterError> {
        let bounds = Bounds::new(vec![(-HALF, HALF); dimension])?;
        let borders: Vec<f64> = (-5..=5).map(f64::from).collect();
        Ok(Self { cells: Cells::new(vec![borders; dimension]), bounds })
    }
}

impl Cost for DeJong {
    fn evaluate(&mut self, x: &[f64]) -> Evaluation {
        // The first cell, number 0, is that of -6.
        self.cells.evaluate(x, |cell| cell.index.iter().map(|&k| k as f64 - 6.0).sum())
    }

    fn dimension(&self) -> Option<usize> {
        Some(self.cells.dimension())
    }
}

impl TestCost for DeJong {
    fn name(&self) -> String {
        "de-jong".into()
    }

    fn bounds(&self) -> Bounds {
        self.bounds.clone()
    }

    fn minimum(&self) -> f64 {
        -6.0 * self.cells.dimension() as f64
    }

    fn minimiser(&self) -> Vec<f64> {
        vec![-HALF; self.cells.dimension()]
    }

    fn step_count(&self) -> u128 {
        self.cells.count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_value_is_the_sum_of_the_whole_parts_below() {
        let mut cost = DeJong::new(3).unwrap();
        for i in 0..1000 {
            let t = f64::from(i) / 999.0;
            let x = [-HALF + 2.0 * HALF * t, HALF - 2.0 * HALF * t, (7.0 * t).sin() * HALF];
            assert_eq!(cost.evaluate(&x).value, x.iter().map(|x| x.floor()).sum::<f64>(), "{x:?}");
        }
    }

    #[test]
    fn outside_the_outermost_steps_go_on() {
        let mut cost = DeJong::new(1).unwrap();
        assert_eq!((cost.evaluate(&[-1e300]).value, cost.evaluate(&[1e300]).value), (-6.0, 5.0));
    }

    #[test]
    fn no_axes_are_an_error() {
        assert!(DeJong::new(0).is_err());
    }
}
