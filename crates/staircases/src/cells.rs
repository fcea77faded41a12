//! The cells between the borders of each axis: the steps of all functions in this crate.

use terrace_crs::{Evaluation, Step};

/// Inner borders of each axis, finite and rising. With *k* of them an axis has *k* + 1 cells; the first and the last one
/// go on for ever.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Cells {
    axes: Vec<Vec<f64>>,
}

/// One cell: its number on each axis, and its corners.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Cell {
    pub(crate) index: Vec<usize>,
    pub(crate) lo: Vec<f64>,
    pub(crate) hi: Vec<f64>,
}

impl Cells {
    pub(crate) fn new(axes: Vec<Vec<f64>>) -> Self {
        Self { axes }
    }

    pub(crate) fn dimension(&self) -> usize {
        self.axes.len()
    }

    /// The number of cells; `u128::MAX` if there are more.
    pub(crate) fn count(&self) -> u128 {
        self.axes.iter().fold(1, |count, inner| count.saturating_mul(inner.len() as u128 + 1))
    }

    /// The cell around `x`; none for NaN or another number of axes.
    pub(crate) fn at(&self, x: &[f64]) -> Option<Cell> {
        if x.len() != self.axes.len() || x.iter().any(|x| x.is_nan()) {
            return None;
        }
        let dimension = x.len();
        let mut cell = Cell {
            index: Vec::with_capacity(dimension),
            lo: Vec::with_capacity(dimension),
            hi: Vec::with_capacity(dimension),
        };
        for (inner, &x) in self.axes.iter().zip(x) {
            let below = inner.partition_point(|&border| border <= x);
            cell.index.push(below);
            cell.lo.push(below.checked_sub(1).map_or(f64::NEG_INFINITY, |last| inner[last]));
            cell.hi.push(inner.get(below).copied().unwrap_or(f64::INFINITY));
        }
        Some(cell)
    }

    /// The answer of a cost with one value on each cell.
    pub(crate) fn evaluate(&self, x: &[f64], value: impl FnOnce(&Cell) -> f64) -> Evaluation {
        match self.at(x) {
            Some(cell) => {
                let value = value(&cell);
                Evaluation { value, step: Step::Box { lo: cell.lo, hi: cell.hi } }
            }
            // A search refuses such places before it asks; for a direct call NaN is the honest answer.
            None => Evaluation::point(f64::NAN),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_border_belongs_to_the_cell_above_it() {
        let cells = Cells::new(vec![vec![0.0, 1.0]]);
        let index = |x: f64| cells.at(&[x]).unwrap().index[0];
        assert_eq!([index(-9.0), index(0.0_f64.next_down()), index(-0.0), index(0.5)], [0, 0, 1, 1]);
        assert_eq!([index(1.0_f64.next_down()), index(1.0), index(f64::INFINITY)], [1, 2, 2]);
    }

    #[test]
    fn an_axis_without_borders_is_one_cell() {
        let cells = Cells::new(vec![vec![], vec![3.0]]);
        let cell = cells.at(&[5.0, 5.0]).unwrap();
        assert_eq!((cell.index, cell.lo), (vec![0, 1], vec![f64::NEG_INFINITY, 3.0]));
        assert_eq!(cell.hi, [f64::INFINITY; 2]);
        assert_eq!(cells.count(), 2);
    }

    #[test]
    fn nan_and_other_numbers_of_axes_have_no_cell_and_the_value_nan() {
        let cells = Cells::new(vec![vec![0.0]]);
        assert_eq!((cells.at(&[f64::NAN]), cells.at(&[]), cells.at(&[0.0, 0.0])), (None, None, None));
        assert!(cells.evaluate(&[f64::NAN], |_| 0.0).value.is_nan());
    }

    #[test]
    fn a_count_beyond_all_numbers_is_the_largest_number() {
        assert_eq!(Cells::new(vec![vec![0.0]; 127]).count(), 1 << 127);
        assert_eq!(Cells::new(vec![vec![0.0]; 128]).count(), u128::MAX);
    }
}
