//! A staircase from lists.

use terrace_crs::{Bounds, Cost, Evaluation};

use crate::cells::Cells;
use crate::error::check_steps;
use crate::{ParameterError, TestCost};

/// A staircase of one axis, given by its borders and values: recorded ones, and those drawn by
/// [`RandomStaircase`](crate::RandomStaircase).
///
/// * Formula: f(x) = vᵢ for bᵢ ≤ x < bᵢ₊₁, i = 0 … *n* - 1.
/// * Domain: [b₀, bₙ], where bₙ belongs to the last step; outside, the outermost steps go on.
/// * Optimum: the lowest vᵢ; of equal ones the first is told as the place.
/// * Steps: *n*. Neighbours with the same value stay two steps.
///
/// ```
/// use terrace_crs::{Cost, Evaluation};
/// use terrace_staircases::{Staircase, TestCost};
///
/// let mut cost = Staircase::new(vec![0.0, 0.5, 0.75, 1.0], vec![2.0, -1.0, 3.0])?;
/// assert_eq!(cost.evaluate(&[0.5]), Evaluation::interval(-1.0, 0.5..0.75));
/// assert_eq!((cost.minimum(), cost.minimiser(), cost.step_count()), (-1.0, vec![0.5], 3));
/// # Ok::<(), terrace_staircases::ParameterError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Staircase {
    borders: Vec<f64>,
    values: Vec<f64>,
    cells: Cells,
    bounds: Bounds,
    lowest: usize,
}

impl Staircase {
    /// The staircase with `values[i]` on `[borders[i], borders[i + 1])`.
    ///
    /// # Errors
    ///
    /// No values, or more than ten million; not one border more than values; borders that are not finite and rising, or
    /// so far apart that their distance overflows; a value that is not finite.
    pub fn new(borders: Vec<f64>, values: Vec<f64>) -> Result<Self, ParameterError> {
        check_steps(values.len())?;
        if borders.len() != values.len() + 1 {
            return Err(ParameterError::Lengths { borders: borders.len(), values: values.len() });
        }
        let mut previous = f64::NEG_INFINITY;
        for (index, &border) in borders.iter().enumerate() {
            if !(border.is_finite() && previous < border) {
                return Err(ParameterError::Border { index, border, previous });
            }
            previous = border;
        }
        let mut lowest = 0;
        for (index, &value) in values.iter().enumerate() {
            if !value.is_finite() {
                return Err(ParameterError::Value { index, value });
            }
            if value < values[lowest] {
                lowest = index;
            }
        }
        let bounds = Bounds::interval(borders[0], previous)?;
        let cells = Cells::new(vec![borders[1..values.len()].to_vec()]);
        Ok(Self { borders, values, cells, bounds, lowest })
    }

    /// The borders, one more than there are values.
    pub fn borders(&self) -> &[f64] {
        &self.borders
    }

    /// The value of each step, in the order of the borders.
    pub fn values(&self) -> &[f64] {
        &self.values
    }
}

impl Cost for Staircase {
    fn evaluate(&mut self, x: &[f64]) -> Evaluation {
        self.cells.evaluate(x, |cell| cell.index.iter().map(|&k| self.values[k]).sum())
    }

    fn dimension(&self) -> Option<usize> {
        Some(1)
    }
}

impl TestCost for Staircase {
    fn name(&self) -> String {
        "staircase".into()
    }

    fn bounds(&self) -> Bounds {
        self.bounds.clone()
    }

    fn minimum(&self) -> f64 {
        self.values[self.lowest]
    }

    fn minimiser(&self) -> Vec<f64> {
        vec![self.borders[self.lowest]]
    }

    fn step_count(&self) -> u128 {
        self.values.len() as u128
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_border_belongs_to_the_last_step() {
        let mut cost = Staircase::new(vec![-1.0, 0.0, 1.0], vec![5.0, 5.0]).unwrap();
        assert_eq!(cost.evaluate(&[1.0]), Evaluation::interval(5.0, 0.0..f64::INFINITY));
        assert_eq!((cost.minimiser(), cost.step_count()), (vec![-1.0], 2));
    }

    #[test]
    fn a_single_step_is_everywhere() {
        let mut cost = Staircase::new(vec![0.0, 1.0], vec![7.0]).unwrap();
        assert_eq!(cost.evaluate(&[0.3]), Evaluation::interval(7.0, f64::NEG_INFINITY..f64::INFINITY));
    }

    #[test]
    fn wrong_lists_name_the_entry() {
        assert_eq!(Staircase::new(vec![0.0], vec![]), Err(ParameterError::NoSteps));
        let error = Staircase::new(vec![0.0, 1.0], vec![1.0, 2.0]);
        assert_eq!(error, Err(ParameterError::Lengths { borders: 2, values: 2 }));
        let error = Staircase::new(vec![0.0, 0.0], vec![1.0]);
        assert_eq!(error, Err(ParameterError::Border { index: 1, border: 0.0, previous: 0.0 }));
        for border in [f64::NAN, f64::INFINITY] {
            let error = Staircase::new(vec![0.0, border], vec![1.0]);
            assert!(matches!(error, Err(ParameterError::Border { index: 1, .. })));
        }
        let error = Staircase::new(vec![0.0, 1.0, 2.0], vec![1.0, f64::INFINITY]);
        assert_eq!(error, Err(ParameterError::Value { index: 1, value: f64::INFINITY }));
        let error = Staircase::new(vec![-f64::MAX, f64::MAX], vec![1.0]);
        assert!(matches!(error, Err(ParameterError::Bounds(_))));
    }
}
