//! Known steps on several axes: ordered single points, and a list of boxes.

use std::collections::BTreeMap;

use super::Key;
use crate::{Evaluation, Step};

#[derive(Debug, Clone)]
pub(super) struct Space {
    dimension: usize,
    points: BTreeMap<Vec<Key>, f64>,
    /// The intervals `[lo, hi)` of all boxes, one after another, so that the scan runs through one piece of memory.
    boxes: Vec<(f64, f64)>,
    values: Vec<f64>,
}

impl Space {
    pub(super) fn new(dimension: usize) -> Self {
        // `chunks_exact` takes no zero; bounds always have an axis.
        Self { dimension: dimension.max(1), points: BTreeMap::new(), boxes: Vec::new(), values: Vec::new() }
    }

    pub(super) fn len(&self) -> usize {
        self.points.len() + self.values.len()
    }

    pub(super) fn find(&self, x: &[f64]) -> Option<f64> {
        self.box_around(x).map(|(_, value)| value).or_else(|| self.point(x))
    }

    pub(super) fn step_at(&self, x: &[f64]) -> Option<Evaluation> {
        match self.box_around(x) {
            Some((axes, value)) => Some(Evaluation { value, step: to_step(axes) }),
            None => self.point(x).map(Evaluation::point),
        }
    }

    /// Adds an answer whose step contains `x`; returns a known overlapping answer of another value instead.
    pub(super) fn insert(&mut self, x: &[f64], evaluation: &Evaluation) -> Option<Evaluation> {
        let axes: Vec<(f64, f64)> = match &evaluation.step {
            Step::Point => x.iter().map(|&x| (x, x.next_up())).collect(),
            Step::Box { lo, hi } => lo.iter().copied().zip(hi.iter().copied()).collect(),
        };
        if let Some(known) = self.conflict(&axes, evaluation.value) {
            return Some(known);
        }
        match evaluation.step {
            Step::Point => {
                self.points.insert(key(x), evaluation.value);
            }
            Step::Box { .. } if !self.boxes().any(|(known, _)| known == axes) => {
                self.boxes.extend(axes);
                self.values.push(evaluation.value);
            }
            Step::Box { .. } => {}
        }
        None
    }

    fn conflict(&self, axes: &[(f64, f64)], value: f64) -> Option<Evaluation> {
        let boxes = self.boxes().find(|(known, v)| *v != value && overlap(known, axes));
        if let Some((known, value)) = boxes {
            return Some(Evaluation { value, step: to_step(known) });
        }
        let mut others = self.points.iter().filter(|(_, v)| **v != value);
        let (point, value) =
            others.find(|(point, _)| point.iter().zip(axes).all(|(x, (lo, hi))| *lo <= x.0 && x.0 < *hi))?;
        let axes: Vec<(f64, f64)> = point.iter().map(|x| (x.0, x.0.next_up())).collect();
        Some(Evaluation { value: *value, step: to_step(&axes) })
    }

    fn boxes(&self) -> impl Iterator<Item = (&[(f64, f64)], f64)> {
        self.boxes.chunks_exact(self.dimension).zip(self.values.iter().copied())
    }

    fn box_around(&self, x: &[f64]) -> Option<(&[(f64, f64)], f64)> {
        let inside = |axes: &[(f64, f64)]| axes.iter().zip(x).all(|((lo, hi), x)| lo <= x && x < hi);
        if x.len() == self.dimension { self.boxes().find(|(axes, _)| inside(axes)) } else { None }
    }

    fn point(&self, x: &[f64]) -> Option<f64> {
        // Most costs either know their steps or do not: spare the key where there is nothing to look up.
        if self.points.is_empty() { None } else { self.points.get(&key(x)).copied() }
    }
}

fn key(x: &[f64]) -> Vec<Key> {
    x.iter().copied().map(Key::new).collect()
}

fn overlap(a: &[(f64, f64)], b: &[(f64, f64)]) -> bool {
    a.iter().zip(b).all(|((a_lo, a_hi), (b_lo, b_hi))| a_lo < b_hi && b_lo < a_hi)
}

fn to_step(axes: &[(f64, f64)]) -> Step {
    let (lo, hi) = axes.iter().copied().unzip();
    Step::Box { lo, hi }
}
