//! A needle in a floor.

use terrace_crs::{Bounds, Cost, Evaluation};

use crate::cells::{Cell, Cells};
use crate::error::check_steps;
use crate::{ParameterError, TestCost};

/// One low box, the needle, in a floor that says nothing of where it is, or leads away from it.
///
/// * Formula: f(x) = 0 if a ≤ xᵢ < a + w on every axis. Elsewhere f(x) = 1 + s · (l₁ + … + l_d) / d, with lᵢ the lower
///   end of the step around xᵢ: a flat floor for the slope s = 0, otherwise a flight of stairs that falls to the corner
///   of the axes' lower ends.
/// * Domain: [0, 1]ᵈ; outside, the outermost steps go on.
/// * Optimum: 0, on the needle alone, a share of wᵈ of the domain; every other value is at least 1.
/// * Steps: on each axis the borders are a, a + w, and those of *n* equal cells which do not fall into the needle; a
///   flat floor has *n* = 1 and so three steps on each axis, two if the needle lies at an end.
/// * Source: the 'needle in a haystack' of the literature on genetic algorithms; with s > 0 it is deceptive in the
///   sense of D. E. Goldberg, *Simple genetic algorithms and the minimal, deceptive problem*, in L. Davis (ed.),
///   *Genetic Algorithms and Simulated Annealing*, 1987. The form is of this crate.
///
/// A method that does not know its steps can do no better on a flat floor than to try places until one hits.
///
/// ```
/// use terrace_crs::{Cost, Evaluation};
/// use terrace_staircases::{Needle, TestCost};
///
/// let mut cost = Needle::flat(1, 0.75, 0.0625)?;
/// assert_eq!(cost.evaluate(&[0.8]), Evaluation::interval(0.0, 0.75..0.8125));
/// assert_eq!(cost.evaluate(&[0.3]), Evaluation::interval(1.0, f64::NEG_INFINITY..0.75));
/// assert_eq!(cost.step_count(), 3);
///
/// let mut cost = Needle::sloped(1, 0.75, 0.0625, 2.0, 4)?;
/// assert_eq!(cost.evaluate(&[0.3]), Evaluation::interval(1.5, 0.25..0.5));
/// # Ok::<(), terrace_staircases::ParameterError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Needle {
    cells: Cells,
    bounds: Bounds,
    at: f64,
    end: f64,
    slope: f64,
}

impl Needle {
    /// A needle on `[at, at + width)` of each of `dimension` axes, in a flat floor.
    ///
    /// # Errors
    ///
    /// No axes; or a needle that is empty, not inside [0, 1], or all of it.
    pub fn flat(dimension: usize, at: f64, width: f64) -> Result<Self, ParameterError> {
        Self::sloped(dimension, at, width, 0.0, 1)
    }

    /// A needle on `[at, at + width)` of each of `dimension` axes, in a floor of `cells` cells along each axis that rises
    /// by less than `slope` in all.
    ///
    /// # Errors
    ///
    /// As [`flat`](Self::flat); and a slope that is negative or not finite, no cells, or more than ten million.
    pub fn sloped(
        dimension: usize,
        at: f64,
        width: f64,
        slope: f64,
        cells: usize,
    ) -> Result<Self, ParameterError> {
        check_steps(cells)?;
        let end = at + width;
        // Written so that NaN fails as well.
        if !(0.0 <= at && at < end && end <= 1.0 && (at, end) != (0.0, 1.0)) {
            return Err(ParameterError::Needle { at, width });
        }
        if !(slope.is_finite() && slope >= 0.0) {
            return Err(ParameterError::Slope { slope });
        }
        let bounds = Bounds::new(vec![(0.0, 1.0); dimension])?;
        let mut borders: Vec<f64> = (1..cells).map(|k| k as f64 / cells as f64).collect();
        borders.retain(|border| !(at..=end).contains(border));
        let needle = borders.partition_point(|&border| border < at);
        borders.splice(needle..needle, [at, end].into_iter().filter(|&border| 0.0 < border && border < 1.0));
        Ok(Self { cells: Cells::new(vec![borders; dimension]), bounds, at, end, slope })
    }

    fn value(&self, cell: &Cell) -> f64 {
        let corner = cell.lo.iter().map(|lo| lo.max(0.0));
        if corner.clone().all(|lo| lo >= self.at) && cell.hi.iter().all(|hi| hi.min(1.0) <= self.end) {
            return 0.0;
        }
        1.0 + self.slope * (corner.sum::<f64>() / cell.lo.len() as f64)
    }
}

impl Cost for Needle {
    fn evaluate(&mut self, x: &[f64]) -> Evaluation {
        self.cells.evaluate(x, |cell| self.value(cell))
    }

    fn dimension(&self) -> Option<usize> {
        Some(self.cells.dimension())
    }
}

impl TestCost for Needle {
    fn name(&self) -> String {
        (if self.slope > 0.0 { "needle-sloped" } else { "needle" }).into()
    }

    fn bounds(&self) -> Bounds {
        self.bounds.clone()
    }

    fn minimum(&self) -> f64 {
        0.0
    }

    fn minimiser(&self) -> Vec<f64> {
        vec![self.at; self.cells.dimension()]
    }

    fn step_count(&self) -> u128 {
        self.cells.count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn needles_at_the_ends_have_one_border() {
        let mut low = Needle::flat(2, 0.0, 0.25).unwrap();
        assert_eq!((low.step_count(), low.evaluate(&[0.0, 0.2]).value), (4, 0.0));
        assert_eq!(low.evaluate(&[0.0, 0.25]).value, 1.0);
        let mut high = Needle::flat(1, 0.75, 0.25).unwrap();
        assert_eq!((high.step_count(), high.evaluate(&[1.0]).value), (2, 0.0));
    }

    #[test]
    fn borders_of_the_floor_do_not_cut_the_needle() {
        // 0.5 falls into the needle, 0.25 on its end: of the borders of 8 cells five are left.
        let cost = Needle::sloped(1, 0.25, 0.3, 1.0, 8).unwrap();
        assert_eq!(cost.step_count(), 8 - 3 + 2);
    }

    #[test]
    fn the_floor_rises_with_the_lower_ends_of_the_steps() {
        let mut cost = Needle::sloped(2, 0.9, 0.05, 3.0, 10).unwrap();
        assert_eq!(cost.evaluate(&[0.05, 0.05]).value, 1.0);
        assert_eq!(cost.evaluate(&[0.55, 0.05]).value, 1.0 + 3.0 * (0.5 / 2.0));
        assert_eq!(cost.evaluate(&[0.92, 0.05]).value, 1.0 + 3.0 * (0.9 / 2.0));
    }

    #[test]
    fn wrong_needles_and_slopes_are_errors() {
        for (at, width) in [(-0.1, 0.2), (0.5, 0.0), (0.5, 0.6), (0.0, 1.0), (f64::NAN, 0.1), (0.5, f64::NAN)]
        {
            assert!(matches!(Needle::flat(1, at, width), Err(ParameterError::Needle { .. })), "{at} {width}");
        }
        for slope in [-1.0, f64::NAN, f64::INFINITY] {
            let error = Needle::sloped(1, 0.5, 0.1, slope, 3);
            assert!(matches!(error, Err(ParameterError::Slope { .. })), "{slope}");
        }
        assert_eq!(Needle::sloped(1, 0.5, 0.1, 1.0, 0), Err(ParameterError::NoSteps));
    }
}
