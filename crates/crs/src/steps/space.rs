//! Known steps on several axes: boxes, single points, and boxes with a lower bound.

use super::forest::Forest;
use crate::{Evaluation, Step};

#[derive(Debug, Clone)]
pub(super) struct Space {
    boxes: Valued,
    /// Each as the box that holds no other place.
    points: Valued,
    bounds: Valued,
}

/// Boxes with a value each.
#[derive(Debug, Clone)]
struct Valued {
    forest: Forest,
    values: Vec<f64>,
}

impl Valued {
    fn new(dimension: usize) -> Self {
        Self { forest: Forest::new(dimension), values: Vec::new() }
    }

    /// The earliest inserted box around `x`.
    fn earliest(&self, x: &[f64]) -> Option<usize> {
        let mut earliest: Option<usize> = None;
        self.forest.around(x, |index| earliest = Some(earliest.map_or(index, |other| other.min(index))));
        earliest
    }

    /// The earliest inserted box around `x` among those with the highest value.
    fn highest(&self, x: &[f64]) -> Option<usize> {
        let mut highest: Option<usize> = None;
        self.forest.around(x, |index| {
            let better = |other: usize| {
                self.values[index] > self.values[other]
                    || self.values[index] == self.values[other] && index < other
            };
            if highest.is_none_or(better) {
                highest = Some(index);
            }
        });
        highest
    }

    /// The earliest inserted box that overlaps these axes and whose value `is` so.
    fn overlapping(&self, axes: &[(f64, f64)], is: impl Fn(f64) -> bool) -> Option<usize> {
        let mut earliest: Option<usize> = None;
        self.forest.any_overlap(axes, |index| {
            if is(self.values[index]) {
                earliest = Some(earliest.map_or(index, |other| other.min(index)));
            }
            false
        });
        earliest
    }

    fn get(&self, index: usize) -> Evaluation {
        let (lo, hi) = self.forest.get(index).iter().copied().unzip();
        Evaluation { value: self.values[index], step: Step::Box { lo, hi } }
    }

    fn insert(&mut self, axes: &[(f64, f64)], value: f64) {
        self.forest.insert(axes);
        self.values.push(value);
    }
}

impl Space {
    pub(super) fn new(dimension: usize) -> Self {
        let new = || Valued::new(dimension);
        Self { boxes: new(), points: new(), bounds: new() }
    }

    pub(super) fn len(&self) -> usize {
        self.points.forest.len() + self.boxes.forest.len()
    }

    pub(super) fn find(&self, x: &[f64]) -> Option<f64> {
        let boxed = self.boxes.earliest(x).map(|index| self.boxes.values[index]);
        boxed.or_else(|| self.points.earliest(x).map(|index| self.points.values[index]))
    }

    pub(super) fn step_at(&self, x: &[f64]) -> Option<Evaluation> {
        let boxed = self.boxes.earliest(x).map(|index| self.boxes.get(index));
        boxed.or_else(|| self.points.earliest(x).map(|index| Evaluation::point(self.points.values[index])))
    }

    /// The highest lower bound known at `x`, and a box around it on which it is known.
    pub(super) fn bound_at(&self, x: &[f64]) -> Option<Evaluation> {
        self.bounds.highest(x).map(|index| self.bounds.get(index))
    }

    /// Adds an answer whose step contains `x`; returns a known overlapping answer of another value instead.
    pub(super) fn insert(&mut self, x: &[f64], evaluation: &Evaluation) -> Option<Evaluation> {
        let axes = axes(x, &evaluation.step);
        let value = evaluation.value;
        if let Some(index) = self.boxes.overlapping(&axes, |known| known != value) {
            return Some(self.boxes.get(index));
        }
        if let Some(index) = self.points.overlapping(&axes, |known| known != value) {
            return Some(self.points.get(index));
        }
        match evaluation.step {
            Step::Point if self.find(x).is_some() => {}
            Step::Point => self.points.insert(&axes, value),
            Step::Box { .. } => insert_new(&mut self.boxes, x, &axes, value),
        }
        None
    }

    /// A known lower bound that the answer, whose step contains `x`, falls below.
    pub(super) fn bound_above(&self, x: &[f64], evaluation: &Evaluation) -> Option<Evaluation> {
        let above = self.bounds.overlapping(&axes(x, &evaluation.step), |bound| bound > evaluation.value);
        above.map(|index| self.bounds.get(index))
    }

    /// Adds a lower bound whose step contains `x`; returns a known answer below it instead.
    pub(super) fn insert_bound(&mut self, x: &[f64], bound: &Evaluation) -> Option<Evaluation> {
        let axes = axes(x, &bound.step);
        for known in [&self.boxes, &self.points] {
            if let Some(index) = known.overlapping(&axes, |value| value < bound.value) {
                return Some(known.get(index));
            }
        }
        insert_new(&mut self.bounds, x, &axes, bound.value);
        None
    }

    /// A box that overlaps these axes and on which the cost is known, or bounded, at or above `value`; single `points`
    /// included or not.
    pub(super) fn proof(&self, axes: &[(f64, f64)], value: f64, points: bool) -> Option<&[(f64, f64)]> {
        let single = |axes: &[(f64, f64)]| axes.iter().all(|(lo, hi)| *hi == lo.next_up());
        let of_use = |axes: &[(f64, f64)]| points || !single(axes);
        [&self.boxes, &self.bounds, &self.points].into_iter().find_map(|known| {
            let mut found = None;
            known.forest.any_overlap(axes, |index| {
                found = (known.values[index] >= value && of_use(known.forest.get(index))).then_some(index);
                found.is_some()
            });
            found.map(|index| known.forest.get(index))
        })
    }
}

/// Inserts a box around `x` unless the same is there with this or a higher value.
fn insert_new(known: &mut Valued, x: &[f64], axes: &[(f64, f64)], value: f64) {
    let mut again = false;
    known.forest.around(x, |index| again |= known.values[index] >= value && known.forest.get(index) == axes);
    if !again {
        known.insert(axes, value);
    }
}

fn axes(x: &[f64], step: &Step) -> Vec<(f64, f64)> {
    match step {
        // Adding zero: zero and negative zero are one place.
        Step::Point => x.iter().map(|&x| (x + 0.0, x.next_up())).collect(),
        Step::Box { lo, hi } => lo.iter().copied().zip(hi.iter().copied()).collect(),
    }
}
