//! Rastrigin's function on cells.

use std::f64::consts::TAU;

use terrace_crs::{Bounds, Cost, Evaluation};

use crate::grid::Grid;
use crate::{ParameterError, TestCost};

/// Rastrigin's function, quantised and shifted: a bowl with a lattice of local minima about 1 apart.
///
/// * Formula: f(x) = Σ (tᵢ² + 10 - 10 cos 2πtᵢ), with tᵢ = cᵢ - sᵢ. Each axis is cut into *n* equal cells; cᵢ is the
///   centre of the cell that holds xᵢ, and sᵢ the centre of cell number ⌊*n* frac(i φ)⌋, φ = (√5 - 1) / 2, i = 1 … *d*, or another one
///   that is asked for.
/// * Domain: [-5.12, 5.12]ᵈ; outside, the outermost steps go on.
/// * Optimum: exactly 0, on the cell around s, which lies off the middle by another share on each axis.
/// * Steps: *n*ᵈ. The local minima are seen when a cell is narrower than about half a unit, *n* > 20.
/// * Source: L. A. Rastrigin, *Systems of Extremal Control*, Nauka, 1974 (in Russian), for *d* = 2; for any *d*
///   H. Mühlenbein, M. Schomisch, J. Born, *The parallel genetic algorithm as function optimizer*, Parallel Computing
///   17, 619-632, 1991, [doi:10.1016/S0167-8191(05)80052-3](https://doi.org/10.1016/S0167-8191(05)80052-3). The cells
///   and the shift are of this crate.
///
/// ```
/// use terrace_crs::Cost;
/// use terrace_staircases::{Rastrigin, TestCost};
///
/// let mut cost = Rastrigin::new(2, 64)?;
/// assert_eq!((cost.minimum(), cost.step_count()), (0.0, 4096));
/// assert_eq!(cost.evaluate(&cost.minimiser()).value, 0.0);
/// # Ok::<(), terrace_staircases::ParameterError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Rastrigin {
    grid: Grid,
}

impl Rastrigin {
    /// The function of `dimension` axes with `cells` cells along each.
    ///
    /// # Errors
    ///
    /// No axes, no cells, or more than ten million cells along an axis.
    pub fn new(dimension: usize, cells: usize) -> Result<Self, ParameterError> {
        Ok(Self { grid: Grid::new(dimension, 5.12, cells)? })
    }

    /// The function with one axis for each entry of `optimum`: the number of the cell, from zero, whose centre is sᵢ.
    ///
    /// # Errors
    ///
    /// As [`new`](Self::new); and a number that is not below `cells`.
    pub fn with_optimum(cells: usize, optimum: &[usize]) -> Result<Self, ParameterError> {
        Ok(Self { grid: Grid::with_optimum(5.12, cells, optimum.to_vec())? })
    }
}

impl Cost for Rastrigin {
    fn evaluate(&mut self, x: &[f64]) -> Evaluation {
        let term = |t: f64| t * t + 10.0 * (1.0 - (TAU * t).cos());
        self.grid.cells().evaluate(x, |cell| self.grid.offsets(cell).map(term).sum())
    }

    fn dimension(&self) -> Option<usize> {
        Some(self.grid.cells().dimension())
    }
}

impl TestCost for Rastrigin {
    fn name(&self) -> String {
        format!("rastrigin-{}", self.grid.cells_per_axis())
    }

    fn bounds(&self) -> Bounds {
        self.grid.bounds().clone()
    }

    fn minimum(&self) -> f64 {
        0.0
    }

    fn minimiser(&self) -> Vec<f64> {
        self.grid.optimum()
    }

    fn step_count(&self) -> u128 {
        self.grid.cells().count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn with_narrow_cells_it_is_the_smooth_function() {
        let mut cost = Rastrigin::new(2, 1_000_000).unwrap();
        let best = cost.minimiser();
        for (a, b) in [(0.0, 0.0), (0.5, 0.0), (1.0, -1.0), (-2.3, 0.4), (0.25, 0.75)] {
            let smooth: f64 = [a, b].iter().map(|t: &f64| t * t + 10.0 - 10.0 * (TAU * t).cos()).sum();
            // A cell is 1e-5 wide and the slope at most 2·5 + 20π on each axis.
            assert!((cost.evaluate(&[best[0] + a, best[1] + b]).value - smooth).abs() < 1e-3, "({a}, {b})");
        }
    }

    #[test]
    fn one_cell_is_the_constant_zero() {
        let mut cost = Rastrigin::new(3, 1).unwrap();
        assert_eq!((cost.evaluate(&[5.0, -5.0, 0.0]).value, cost.step_count()), (0.0, 1));
    }
}
