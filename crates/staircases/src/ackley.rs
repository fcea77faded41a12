//! Ackley's function on cells.

use std::f64::consts::{E, TAU};

use terrace_crs::{Bounds, Cost, Evaluation};

use crate::grid::Grid;
use crate::{ParameterError, TestCost};

/// Ackley's function, quantised and shifted: an almost flat, rippled plain around one steep hole.
///
/// * Formula: f(x) = 20 + e - 20 exp(-0.2 √(Σtᵢ² / d)) - exp(Σ cos 2πtᵢ / d), with tᵢ = cᵢ - sᵢ. Each axis is cut into
///   *n* equal cells; cᵢ is the centre of the cell that holds xᵢ, and sᵢ the centre of cell number ⌊*n* frac(i φ)⌋,
///   φ = (√5 - 1) / 2, i = 1 … *d*, or another one
///   that is asked for.
/// * Domain: [-32.768, 32.768]ᵈ; outside, the outermost steps go on.
/// * Optimum: exactly 0, on the cell around s, which lies off the middle by another share on each axis.
/// * Steps: *n*ᵈ. The ripples, one unit apart, are seen when a cell is narrower than about half a unit, *n* > 130.
/// * Source: D. H. Ackley, *A Connectionist Machine for Genetic Hillclimbing*, Kluwer, 1987, for *d* = 2; for any *d*
///   T. Bäck, *Evolutionary Algorithms in Theory and Practice*, Oxford University Press, 1996. The cells and the shift
///   are of this crate.
///
/// ```
/// use terrace_crs::Cost;
/// use terrace_staircases::{Ackley, TestCost};
///
/// let mut cost = Ackley::new(2, 256)?;
/// assert_eq!((cost.minimum(), cost.step_count()), (0.0, 65_536));
/// assert_eq!(cost.evaluate(&cost.minimiser()).value, 0.0);
/// # Ok::<(), terrace_staircases::ParameterError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Ackley {
    grid: Grid,
}

impl Ackley {
    /// The function of `dimension` axes with `cells` cells along each.
    ///
    /// # Errors
    ///
    /// No axes, no cells, or more than ten million cells along an axis.
    pub fn new(dimension: usize, cells: usize) -> Result<Self, ParameterError> {
        Ok(Self { grid: Grid::new(dimension, 32.768, cells)? })
    }

    /// The function with one axis for each entry of `optimum`: the number of the cell, from zero, whose centre is sᵢ.
    ///
    /// # Errors
    ///
    /// As [`new`](Self::new); and a number that is not below `cells`.
    pub fn with_optimum(cells: usize, optimum: &[usize]) -> Result<Self, ParameterError> {
        Ok(Self { grid: Grid::with_optimum(32.768, cells, optimum.to_vec())? })
    }
}

impl Cost for Ackley {
    fn evaluate(&mut self, x: &[f64]) -> Evaluation {
        self.grid.cells().evaluate(x, |cell| {
            let mean = |term: fn(f64) -> f64| {
                let offsets = self.grid.offsets(cell);
                let share = 1.0 / offsets.len() as f64;
                offsets.map(term).sum::<f64>() * share
            };
            let distance = mean(|t| t * t).sqrt();
            // cos 2πt - 1 and exp - 1, so that no rounding is left at the optimum.
            let ripple = mean(|t| (TAU * t).cos() - 1.0);
            -20.0 * (-0.2 * distance).exp_m1() - E * ripple.exp_m1()
        })
    }

    fn dimension(&self) -> Option<usize> {
        Some(self.grid.cells().dimension())
    }
}

impl TestCost for Ackley {
    fn name(&self) -> String {
        format!("ackley-{}", self.grid.cells_per_axis())
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
        let mut cost = Ackley::new(2, 10_000_000).unwrap();
        let best = cost.minimiser();
        for (a, b) in [(0.0, 0.0), (0.5, 0.0), (1.0, -1.0), (-12.3, 0.4), (0.25, 0.75)] {
            let (a, b): (f64, f64) = (a, b);
            let distance = f64::midpoint(a * a, b * b).sqrt();
            let ripple = f64::midpoint((TAU * a).cos(), (TAU * b).cos());
            let smooth = 20.0 + E - 20.0 * (-0.2 * distance).exp() - ripple.exp();
            // A cell is 6.6e-6 wide and the slope at most 4 + 2πe.
            assert!((cost.evaluate(&[best[0] + a, best[1] + b]).value - smooth).abs() < 1e-3, "({a}, {b})");
        }
    }

    #[test]
    fn one_cell_is_the_constant_zero() {
        let mut cost = Ackley::new(3, 1).unwrap();
        assert_eq!((cost.evaluate(&[5.0, -5.0, 0.0]).value, cost.step_count()), (0.0, 1));
    }
}
