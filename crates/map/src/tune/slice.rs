//! The cost along one setting, with the others held.

use terrace_crs::Axis;

use crate::tune::{Settings, TuneAxis, TuneCost, TuneError};

/// A stretch of one setting on which the cost is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SliceStep {
    /// Where it begins, within the space.
    pub lo: f64,
    /// Where it ends, within the space; the same as `lo` for a setting of single values.
    pub hi: f64,
    /// The cost on it.
    pub value: f64,
}

impl TuneCost<'_> {
    /// The cost along one setting through a place, in rising order: each value of cell size, depth and τ, each step of ω
    /// and φ; at most `most`. Of more steps than that, some are left out all over the range.
    ///
    /// # Errors
    /// [`TuneError`] for settings that are none.
    pub fn slice(
        &mut self,
        through: &Settings,
        axis: TuneAxis,
        most: usize,
    ) -> Result<Vec<SliceStep>, TuneError> {
        let Some(of_space) = self.bounds.axes().get(axis as usize).cloned() else { return Ok(Vec::new()) };
        let values: Vec<f64> = match of_space {
            Axis::Real { lo, hi } if lo < hi => return self.stairs(through, axis, (lo, hi), most),
            Axis::Integer { lo, hi } => (lo..=hi).take(most).map(|x| x as f64).collect(),
            Axis::List(values) => values.into_iter().take(most).collect(),
            fixed => vec![fixed.lo()],
        };
        let step = |x| Ok(SliceStep { lo: x, hi: x, value: self.at(&through.with(axis, x))?.value });
        values.into_iter().map(step).collect()
    }

    /// Along ω or φ, step by step.
    fn stairs(
        &mut self,
        through: &Settings,
        axis: TuneAxis,
        (lo, hi): (f64, f64),
        most: usize,
    ) -> Result<Vec<SliceStep>, TuneError> {
        let mut steps = Vec::new();
        let mut x = lo;
        while steps.len() < most {
            let found = self.at(&through.with(axis, x))?;
            let (from, to) = match axis {
                TuneAxis::Omega => found.omega,
                _ => (found.phi.lo, found.phi.hi.unwrap_or(f64::INFINITY)),
            };
            steps.push(SliceStep { lo: from.max(lo), hi: to.min(hi), value: found.value });
            if to > hi {
                break;
            }
            x = to.max((lo + (hi - lo) * steps.len() as f64 / most as f64).min(hi));
        }
        Ok(steps)
    }
}
