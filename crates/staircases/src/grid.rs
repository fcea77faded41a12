//! A smooth function made a staircase: equal cells, and the offset of each cell's centre from the optimum.

use terrace_crs::Bounds;

use crate::ParameterError;
use crate::cells::{Cell, Cells};
use crate::error::check_steps;

/// `cells` equal cells along each axis of `[-half, half]`, one of whose centres is the optimum.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Grid {
    cells: Cells,
    bounds: Bounds,
    centres: Vec<f64>,
    /// The cell of the optimum on each axis.
    optimum: Vec<usize>,
}

impl Grid {
    pub(crate) fn new(dimension: usize, half: f64, cells: usize) -> Result<Self, ParameterError> {
        Self::with_optimum(half, cells, (0..dimension).map(|axis| off_centre(axis, cells)).collect())
    }

    /// The optimum at the centres of the cells given for each axis.
    pub(crate) fn with_optimum(half: f64, cells: usize, optimum: Vec<usize>) -> Result<Self, ParameterError> {
        check_steps(cells)?;
        let dimension = optimum.len();
        let bounds = Bounds::new(vec![(-half, half); dimension])?;
        if let Some(axis) = optimum.iter().position(|&cell| cell >= cells) {
            return Err(ParameterError::NoCell { axis, cell: optimum[axis], cells });
        }
        let at = |share: f64| -half + 2.0 * half * (share / cells as f64);
        let borders: Vec<f64> = (1..cells).map(|k| at(k as f64)).collect();
        let centres = (0..cells).map(|k| at(k as f64 + 0.5)).collect();
        Ok(Self { cells: Cells::new(vec![borders; dimension]), bounds, centres, optimum })
    }

    pub(crate) fn cells(&self) -> &Cells {
        &self.cells
    }

    pub(crate) fn bounds(&self) -> &Bounds {
        &self.bounds
    }

    pub(crate) fn cells_per_axis(&self) -> usize {
        self.centres.len()
    }

    pub(crate) fn optimum(&self) -> Vec<f64> {
        self.optimum.iter().map(|&k| self.centres[k]).collect()
    }

    /// From the optimum to the centre of `cell`, axis by axis; exactly zero at the optimum.
    pub(crate) fn offsets(&self, cell: &Cell) -> impl ExactSizeIterator<Item = f64> {
        cell.index.iter().zip(&self.optimum).map(|(&k, &best)| self.centres[k] - self.centres[best])
    }
}

/// ⌊*n* frac((axis + 1) φ)⌋ with φ = (√5 - 1) / 2: another share of each axis, and on the first 0.618.
fn off_centre(axis: usize, cells: usize) -> usize {
    // φ in 64 bits after the point; the product wraps to its fractional part.
    let share = 0x9E37_79B9_7F4A_7C15_u64.wrapping_mul((axis as u64).wrapping_add(1));
    let product = u128::from(share) * cells as u128;
    // The high half is below `cells` and so fits.
    usize::try_from(product >> 64).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_optimum_is_off_the_middle_by_the_golden_ratio() {
        let cells: Vec<usize> = (0..5).map(|axis| off_centre(axis, 100)).collect();
        assert_eq!(cells, [61, 23, 85, 47, 9]);
        assert_eq!(off_centre(7, 1), 0);
    }

    #[test]
    fn cells_are_equal_and_hold_their_centres() {
        let grid = Grid::new(1, 5.12, 7).unwrap();
        for (k, &centre) in grid.centres.iter().enumerate() {
            let cell = grid.cells.at(&[centre]).unwrap();
            assert_eq!(cell.index, [k]);
            let (lo, hi) = (cell.lo[0].max(-5.12), cell.hi[0].min(5.12));
            assert!((hi - lo - 10.24 / 7.0).abs() < 1e-14 && (0.5 * (lo + hi) - centre).abs() < 1e-14);
        }
    }

    #[test]
    fn no_cells_and_no_axes_are_errors() {
        assert_eq!(Grid::new(1, 1.0, 0), Err(ParameterError::NoSteps));
        assert!(matches!(Grid::new(0, 1.0, 1), Err(ParameterError::Bounds(_))));
        let error = Grid::with_optimum(1.0, 3, vec![2, 3]);
        assert_eq!(error, Err(ParameterError::NoCell { axis: 1, cell: 3, cells: 3 }));
    }
}
