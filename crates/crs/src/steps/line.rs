//! Known steps on one axis: disjoint intervals, ordered by their lower end.

use std::collections::BTreeMap;

use super::Key;
use crate::{Axis, Evaluation, Step};

/// A single point `x` is the interval `[x, next_up(x))`, which holds no other number: one kind of entry serves both.
#[derive(Debug, Clone, Default)]
pub(super) struct Line {
    runs: BTreeMap<Key, Run>,
    /// Lower bounds of the cost: disjoint as well, the highest known at each place.
    bounds: BTreeMap<Key, Run>,
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

    /// The known interval around `x`, as its lower end and the rest.
    pub(super) fn find(&self, x: &[f64]) -> Option<(f64, Run)> {
        find(&self.runs, x)
    }

    /// The interval around `x` on which a lower bound is known.
    pub(super) fn find_bound(&self, x: &[f64]) -> Option<(f64, Run)> {
        find(&self.bounds, x)
    }

    /// Adds an answer whose step contains `x`; returns a known overlapping answer of another value instead.
    pub(super) fn insert(&mut self, x: &[f64], evaluation: &Evaluation) -> Option<Evaluation> {
        let (mut lo, mut hi) = interval(x, &evaluation.step)?;
        let overlapping = overlapping(&self.runs, lo, hi);
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

    /// A known lower bound that the answer, whose step contains `x`, falls below.
    pub(super) fn bound_above(&self, x: &[f64], evaluation: &Evaluation) -> Option<Evaluation> {
        let (lo, hi) = interval(x, &evaluation.step)?;
        let above =
            overlapping(&self.bounds, lo, hi).into_iter().find(|(_, run)| run.value > evaluation.value);
        above.map(|(lo, run)| run.evaluation(lo.0))
    }

    /// Adds a lower bound whose step contains `x`; returns a known answer below it instead.
    pub(super) fn insert_bound(&mut self, x: &[f64], bound: &Evaluation) -> Option<Evaluation> {
        let (lo, hi) = interval(x, &bound.step)?;
        let below = overlapping(&self.runs, lo, hi).into_iter().find(|(_, run)| run.value < bound.value);
        if let Some((lo, run)) = below {
            return Some(run.evaluation(lo.0));
        }
        let value = bound.value;
        // Higher bounds stay and lower ones are cut back: what lies between the higher ones gets the new bound.
        let mut from = lo;
        for (key, run) in overlapping(&self.bounds, lo, hi).into_iter().rev() {
            if run.value >= value {
                put(&mut self.bounds, from, key.0, value);
                from = run.hi;
                continue;
            }
            self.bounds.remove(&key);
            put(&mut self.bounds, key.0, lo, run.value);
            put(&mut self.bounds, hi, run.hi, run.value);
        }
        put(&mut self.bounds, from, hi, value);
        None
    }

    /// The share of the axis on which the cost is known, or bounded, at or above `value`; 1 only for all of it.
    pub(super) fn proven(&self, axis: &Axis, value: f64) -> f64 {
        let (from, to) = axis.span();
        let at_or_above = |runs: &BTreeMap<Key, Run>| -> Vec<(f64, f64)> {
            let runs = runs.range(..Key::new(to)).filter(|(_, run)| run.value >= value && run.hi > from);
            runs.map(|(lo, run)| (lo.0, run.hi)).collect()
        };
        let mut covered = at_or_above(&self.runs);
        covered.extend(at_or_above(&self.bounds));
        covered.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let (mut reached, mut share, mut missing) = (from, 0.0, false);
        for (lo, hi) in covered {
            missing |= lo > reached && axis.within(reached, lo).is_some();
            if hi > reached {
                share += axis.share(lo.max(reached), hi);
                reached = hi;
            }
        }
        missing |= axis.within(reached, to).is_some();
        if missing { f64::min(share, 1.0_f64.next_down()) } else { 1.0 }
    }
}

fn find(runs: &BTreeMap<Key, Run>, x: &[f64]) -> Option<(f64, Run)> {
    let &[x] = x else { return None };
    let (lo, run) = runs.range(..=Key::new(x)).next_back()?;
    (x < run.hi).then_some((lo.0, *run))
}

fn interval(x: &[f64], step: &Step) -> Option<(f64, f64)> {
    match (step, x) {
        (Step::Box { lo, hi }, _) => Some((*lo.first()?, *hi.first()?)),
        (Step::Point, &[x]) => Some((x, x.next_up())),
        (Step::Point, _) => None,
    }
}

/// From the right. Disjoint and ordered by lower end means ordered by upper end: the overlapping ones are neighbours.
fn overlapping(runs: &BTreeMap<Key, Run>, lo: f64, hi: f64) -> Vec<(Key, Run)> {
    let before = runs.range(..Key::new(hi)).rev();
    before.take_while(|(_, run)| run.hi > lo).map(|(lo, run)| (*lo, *run)).collect()
}

fn put(runs: &mut BTreeMap<Key, Run>, lo: f64, hi: f64, value: f64) {
    if lo < hi {
        runs.insert(Key::new(lo), Run { hi, value });
    }
}
