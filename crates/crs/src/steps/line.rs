//! Known steps on one axis: disjoint intervals, ordered by their lower end.

use std::collections::BTreeMap;

use super::Key;
use crate::{Evaluation, Step};

/// A single point `x` is the interval `[x, next_up(x))`, which holds no other number: one kind of entry serves both.
#[derive(Debug, Clone, Default)]
pub(super) struct Line {
    runs: BTreeMap<Key, Run>,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Run {
    hi: f64,
    pub(super) value: f64,
}

impl Run {
    pub(super) fn evaluation(self, lo: f64) -> Evaluation {
        let step = if self.hi == lo.next_up() { Step::Point } else { Step::interval(lo..self.hi) };
        Evaluation { value: self.value, step }
    }
}

impl Line {
    pub(super) fn len(&self) -> usize {
        self.runs.len()
    }

    /// The interval around `x`, as its lower end and the rest.
    pub(super) fn find(&self, x: &[f64]) -> Option<(f64, Run)> {
        let &[x] = x else { return None };
        let (lo, run) = self.runs.range(..=Key::new(x)).next_back()?;
        (x < run.hi).then_some((lo.0, *run))
    }

    /// Adds an answer whose step contains `x`; returns a known overlapping answer of another value instead.
    pub(super) fn insert(&mut self, x: &[f64], evaluation: &Evaluation) -> Option<Evaluation> {
        let (mut lo, mut hi) = match (&evaluation.step, x) {
            (Step::Box { lo, hi }, _) => (*lo.first()?, *hi.first()?),
            (Step::Point, &[x]) => (x, x.next_up()),
            (Step::Point, _) => return None,
        };
        // Disjoint and ordered by lower end means ordered by upper end: the overlapping ones are a run from the right.
        let overlapping = self
            .runs
            .range(..Key::new(hi))
            .rev()
            .take_while(|(_, run)| run.hi > lo)
            .map(|(lo, run)| (*lo, *run));
        let overlapping: Vec<(Key, Run)> = overlapping.collect();
        if let Some((lo, run)) = overlapping.iter().rev().find(|(_, run)| run.value != evaluation.value) {
            return Some(Evaluation { value: run.value, step: Step::interval(lo.0..run.hi) });
        }
        for (key, run) in overlapping {
            self.runs.remove(&key);
            lo = lo.min(key.0);
            hi = hi.max(run.hi);
        }
        self.runs.insert(Key::new(lo), Run { hi, value: evaluation.value });
        None
    }
}
