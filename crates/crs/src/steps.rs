//! What is already known about a cost.

mod forest;
mod line;
mod space;
mod tree;

use thiserror::Error;

use crate::{Bounds, Evaluation, Step};
use line::Line;
use space::Space;

/// The known steps of one cost, a store in which a search looks before it evaluates.
///
/// Searches fill it as they go (`minimise_with` of each method, as [`ControlledRandomSearch::minimise_with`]); what
/// one search learnt serves the next one on the same cost.
///
/// # Borders
///
/// Look-up is exact: a step `[lo, hi)` answers at `lo` and not at `hi`, to the last bit. A value known at `x` alone
/// answers at `x` alone. Zero and negative zero are one place.
///
/// # Overlap
///
/// A cost may report less than its true step, so steps may overlap; then their values must agree, as they do whenever
/// the cost keeps its [contract](crate::Cost#contract). Disagreement is an error and leaves the store as it was. On a
/// single axis, steps that overlap are joined into one. Steps that only touch stay apart.
///
/// # Lower bounds
///
/// When a cost [gives up early](crate::Cost::evaluate_below), it says that it is *at least* so much. Such lower
/// bounds are kept apart from values: where only a bound is known, [`find`](Self::find) gives `None`, and
/// [`bound_at`](Self::bound_at) gives the bound.
///
/// # Complexity
///
/// With *k* steps, single places and bounds included. One axis: O(log *k*) to find and, amortised, to insert. Several
/// axes, *d* of them: boxes are kept in search trees; finding takes O(*d* log² *k*) for boxes that overlap little, at
/// worst O(*d k*) when all overlap at the place. Inserting takes O(*d* log² *k*), amortised, and the time to look at
/// each box that the new one overlaps.
///
/// # Examples
///
/// ```
/// use terrace_crs::{Bounds, Evaluation, Steps};
///
/// let mut steps = Steps::new(&Bounds::interval(0.0, 10.0)?);
/// steps.insert(&[2.5], &Evaluation::interval(7.0, 2.0..3.0))?;
/// assert_eq!(steps.find(&[2.0]), Some(7.0));
/// assert_eq!(steps.find(&[3.0]), None);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// [`ControlledRandomSearch::minimise_with`]: crate::ControlledRandomSearch::minimise_with
#[derive(Debug, Clone)]
pub struct Steps {
    dimension: usize,
    store: Store,
}

#[derive(Debug, Clone)]
enum Store {
    Line(Line),
    Space(Box<Space>),
}

/// How a cost broke its [contract](crate::Cost#contract).
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum CostError {
    /// The value is NaN or infinite, with which a search cannot reckon. A cost that means 'forbidden' can return a
    /// large finite value.
    #[error("the cost at x = {x:?} is {value:?}, not a finite number")]
    NotFinite {
        /// Where the cost was evaluated.
        x: Vec<f64>,
        /// What it returned.
        value: f64,
    },
    /// The step is not around the place it was asked for, or has another number of axes.
    #[error("the step of the cost at x = {x:?} does not contain x: {step}")]
    StepWithoutX {
        /// Where the cost was evaluated.
        x: Vec<f64>,
        /// The step it returned.
        step: Step,
    },
    /// The step overlaps a known one of another value: one of the two is too large, or the cost is not a function
    /// of `x` alone.
    #[error("the cost at x = {x:?} is {} on {}, but was {} on {}", new.value, new.step, known.value, known.step)]
    Disagreement {
        /// Where the cost was evaluated.
        x: Vec<f64>,
        /// What it returned.
        new: Box<Evaluation>,
        /// What was known before; a single place is written as the smallest box around it.
        known: Box<Evaluation>,
    },
    /// A value is below a lower bound, and the steps of the two overlap, whichever came first: one of them is wrong,
    /// or holds on less than the cost said.
    #[error("the cost at x = {x:?} is {} on {}, but at least {} on {}", new.value, new.step, bound.value, bound.step)]
    BelowBound {
        /// Where the cost was evaluated.
        x: Vec<f64>,
        /// The value, and where it was said to hold.
        new: Box<Evaluation>,
        /// The lower bound, and where it was said to hold.
        bound: Box<Evaluation>,
    },
    /// The cost gave up at a value below the ceiling, where it had to go on.
    #[error("the cost at x = {x:?} gave up at {bound:?}, below the ceiling {ceiling:?}")]
    BelowCeiling {
        /// Where the cost was evaluated.
        x: Vec<f64>,
        /// The lower bound it gave.
        bound: f64,
        /// The ceiling it was asked with.
        ceiling: f64,
    },
    /// Asked for several places at once, the cost gave another number of answers.
    #[error("the cost was asked at {asked} places and gave {answered} answers")]
    Answers {
        /// The number of places.
        asked: usize,
        /// The number of answers.
        answered: usize,
    },
    /// The place itself is not one of this store: it has NaN or infinite coordinates or another number of axes.
    #[error("x = {x:?} is not a place with {dimension} finite coordinates")]
    NoPlace {
        /// The place.
        x: Vec<f64>,
        /// The number of axes of the store.
        dimension: usize,
    },
}

impl Steps {
    /// An empty store for a cost with as many axes as `bounds`. Steps may reach beyond the bounds.
    pub fn new(bounds: &Bounds) -> Self {
        let dimension = bounds.dimension();
        let store = if dimension == 1 {
            Store::Line(Line::default())
        } else {
            Store::Space(Box::new(Space::new(dimension)))
        };
        Self { dimension, store }
    }

    /// The number of axes.
    pub fn dimension(&self) -> usize {
        self.dimension
    }

    /// The number of known steps, single points included, lower bounds not.
    pub fn len(&self) -> usize {
        match &self.store {
            Store::Line(line) => line.len(),
            Store::Space(space) => space.len(),
        }
    }

    /// Whether no value is known yet.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The value at `x`, if it is known. Nothing is known of NaN or of another number of axes.
    pub fn find(&self, x: &[f64]) -> Option<f64> {
        match &self.store {
            Store::Line(line) => line.find(x).map(|(_, run)| run.value),
            Store::Space(space) => self.own(x).and_then(|x| space.find(x)),
        }
    }

    /// The value at `x` and the step around `x` on which it is known, if any.
    ///
    /// When several known boxes overlap at `x`, it is the one inserted first.
    pub fn step_at(&self, x: &[f64]) -> Option<Evaluation> {
        match &self.store {
            Store::Line(line) => line.find(x).map(|(lo, run)| run.evaluation(lo)),
            Store::Space(space) => self.own(x).and_then(|x| space.step_at(x)),
        }
    }

    /// The highest lower bound known at `x` and a step around `x` on which it holds, if any was given there. Known
    /// values are not lower bounds in this sense.
    pub fn bound_at(&self, x: &[f64]) -> Option<Evaluation> {
        match &self.store {
            Store::Line(line) => line.find_bound(x).map(|(lo, run)| run.evaluation(lo)),
            Store::Space(space) => self.own(x).and_then(|x| space.bound_at(x)),
        }
    }

    /// Takes in that the cost was evaluated at `x` with this answer.
    ///
    /// # Errors
    ///
    /// A [`CostError`]; the store is then unchanged.
    pub fn insert(&mut self, x: &[f64], evaluation: &Evaluation) -> Result<(), CostError> {
        self.check(x, evaluation)?;
        let new = || Box::new(evaluation.clone());
        let bound = match &self.store {
            Store::Line(line) => line.bound_above(x, evaluation),
            Store::Space(space) => space.bound_above(x, evaluation),
        };
        if let Some(bound) = bound {
            return Err(CostError::BelowBound { x: x.to_vec(), new: new(), bound: Box::new(bound) });
        }
        let conflict = match &mut self.store {
            Store::Line(line) => line.insert(x, evaluation),
            Store::Space(space) => space.insert(x, evaluation),
        };
        conflict.map_or(Ok(()), |known| {
            Err(CostError::Disagreement { x: x.to_vec(), new: new(), known: Box::new(known) })
        })
    }

    /// Takes in that the cost gave up at `x`: nowhere on the step is it below the value of `bound`.
    ///
    /// # Errors
    ///
    /// A [`CostError`]; the store is then unchanged.
    pub fn insert_bound(&mut self, x: &[f64], bound: &Evaluation) -> Result<(), CostError> {
        self.check(x, bound)?;
        let below = match &mut self.store {
            Store::Line(line) => line.insert_bound(x, bound),
            Store::Space(space) => space.insert_bound(x, bound),
        };
        below.map_or(Ok(()), |known| {
            Err(CostError::BelowBound { x: x.to_vec(), new: Box::new(known), bound: Box::new(bound.clone()) })
        })
    }

    fn check(&self, x: &[f64], evaluation: &Evaluation) -> Result<(), CostError> {
        let Evaluation { value, step } = evaluation;
        if x.len() != self.dimension || !x.iter().all(|v| v.is_finite()) {
            return Err(CostError::NoPlace { x: x.to_vec(), dimension: self.dimension });
        }
        if !value.is_finite() {
            return Err(CostError::NotFinite { x: x.to_vec(), value: *value });
        }
        if !step.contains(x, x) {
            return Err(CostError::StepWithoutX { x: x.to_vec(), step: step.clone() });
        }
        Ok(())
    }

    /// The place, if it has as many axes as the store.
    fn own<'x>(&self, x: &'x [f64]) -> Option<&'x [f64]> {
        (x.len() == self.dimension).then_some(x)
    }

    /// In one axis: the share of the bounds on which the cost is known, or bounded, at or above `value`.
    pub(crate) fn proven(&self, bounds: &Bounds, value: f64) -> Option<f64> {
        match (&self.store, bounds.axes()) {
            (Store::Line(line), [axis]) => Some(line.proven(axis, value)),
            _ => None,
        }
    }

    /// In several axes: a box that overlaps these and on which the cost is known, or bounded, at or above `value`;
    /// known single `points` included or not.
    pub(crate) fn proof(&self, axes: &[(f64, f64)], value: f64, points: bool) -> Option<&[(f64, f64)]> {
        match &self.store {
            Store::Line(_) => None,
            Store::Space(space) => space.proof(axes, value, points),
        }
    }
}

/// A number ordered by value, usable as a key: never NaN, and zero without its sign.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Key(pub(crate) f64);

impl Key {
    pub(crate) fn new(x: f64) -> Self {
        Self(x + 0.0)
    }
}

impl PartialEq for Key {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Key {}

impl PartialOrd for Key {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Key {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0)
    }
}
