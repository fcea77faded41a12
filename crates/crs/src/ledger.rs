//! The one place where a method asks for values: known steps first, and everything is written down.

use std::num::NonZeroUsize;
use std::sync::atomic::Ordering;

use crate::{
    Answer, Bounds, Cost, CostError, Evaluation, Minimum, SearchError, Source, Step, Steps, StopReason,
    Stopping, Trial,
};

pub(crate) struct Ledger<'a, C: ?Sized> {
    cost: &'a mut C,
    steps: &'a mut Steps,
    bounds: &'a Bounds,
    stopping: &'a Stopping,
    trace: Vec<Trial>,
    /// Whether to note the lowest place so far as accepted; for methods without a population.
    marks_lowest: bool,
    evaluations: usize,
    /// Evaluations done when the lowest value was found.
    improved: usize,
    best: Option<Best>,
}

struct Best {
    x: Vec<f64>,
    value: f64,
}

/// What a question gave.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Heard {
    Value(f64),
    /// The cost is at least this.
    Bound(f64),
}

impl Heard {
    /// The value or its bound.
    pub(crate) fn number(self) -> f64 {
        match self {
            Self::Value(number) | Self::Bound(number) => number,
        }
    }
}

impl<'a, C: Cost + ?Sized> Ledger<'a, C> {
    /// Checks that cost, bounds, steps and rules fit each other.
    pub(crate) fn open(
        cost: &'a mut C,
        bounds: &'a Bounds,
        steps: &'a mut Steps,
        stopping: &'a Stopping,
    ) -> Result<Self, SearchError> {
        let dimension = bounds.dimension();
        if let Some(cost) = cost.dimension().filter(|&cost| cost != dimension) {
            return Err(SearchError::CostDimension { cost, bounds: dimension });
        }
        if steps.dimension() != dimension {
            return Err(SearchError::StepsDimension { steps: steps.dimension(), bounds: dimension });
        }
        stopping.check()?;
        let (marks_lowest, trace) = (false, Vec::new());
        Ok(Self {
            cost,
            steps,
            bounds,
            stopping,
            trace,
            marks_lowest,
            evaluations: 0,
            improved: 0,
            best: None,
        })
    }

    pub(crate) fn marking_lowest(self) -> Self {
        Self { marks_lowest: true, ..self }
    }

    /// The lowest value so far.
    pub(crate) fn lowest(&self) -> Option<f64> {
        self.best.as_ref().map(|best| best.value)
    }

    pub(crate) fn steps(&self) -> &Steps {
        self.steps
    }

    pub(crate) fn bounds(&self) -> &'a Bounds {
        self.bounds
    }

    /// The rules that need no population. To be asked before every question.
    pub(crate) fn halt(&self) -> Option<StopReason> {
        let rules = self.stopping;
        if let (Some(target), Some(best)) = (rules.target, &self.best)
            && best.value <= target
        {
            return Some(StopReason::Target);
        }
        if rules.cancel.as_ref().is_some_and(|flag| flag.load(Ordering::Relaxed)) {
            return Some(StopReason::Cancelled);
        }
        if rules.evaluations.is_some_and(|most| self.evaluations >= most) {
            return Some(StopReason::Evaluations);
        }
        let stalled =
            self.best.is_some() && rules.stall.is_some_and(|n| self.evaluations - self.improved >= n);
        stalled.then_some(StopReason::Stall)
    }

    /// How many places of a group of `batch` may be asked for without passing the number of evaluations.
    pub(crate) fn room(&self, batch: NonZeroUsize) -> usize {
        let left = self.stopping.evaluations.map_or(usize::MAX, |most| most.saturating_sub(self.evaluations));
        batch.get().min(left)
    }

    /// The value at `x`, from a known step or else from the cost, whose answer is checked and kept.
    pub(crate) fn ask(&mut self, x: &[f64], round: usize) -> Result<f64, SearchError> {
        if let Some(value) = self.steps.find(x) {
            self.note(x, value, Source::Known, round);
            return Ok(value);
        }
        let evaluation = self.cost.evaluate(x);
        self.learn(x, &evaluation, round)
    }

    /// As [`ask`](Self::ask), but a bound at or above the lowest value so far is answer enough. The cost may give up
    /// when it is `slack` above that; with an infinite one it must not.
    pub(crate) fn ask_below(&mut self, x: &[f64], round: usize, slack: f64) -> Result<Heard, SearchError> {
        let Some(lowest) = self.best.as_ref().map(|best| best.value) else {
            return self.ask(x, round).map(Heard::Value);
        };
        let ceiling = lowest + slack;
        if !ceiling.is_finite() {
            return self.ask(x, round).map(Heard::Value);
        }
        if let Some(value) = self.steps.find(x) {
            self.note(x, value, Source::Known, round);
            return Ok(Heard::Value(value));
        }
        if let Some(bound) = self.steps.bound_at(x).filter(|bound| bound.value >= lowest) {
            self.note(x, bound.value, Source::KnownBounded, round);
            return Ok(Heard::Bound(bound.value));
        }
        match self.cost.evaluate_below(x, ceiling) {
            Answer::Exact(evaluation) => self.learn(x, &evaluation, round).map(Heard::Value),
            Answer::AtLeast(bound) => {
                self.evaluations += 1;
                // Written so that a NaN is caught by the store, which names it.
                if bound.value < ceiling {
                    let x = x.to_vec();
                    return Err(CostError::BelowCeiling { x, bound: bound.value, ceiling }.into());
                }
                self.steps.insert_bound(x, &bound)?;
                self.note(x, bound.value, Source::Bounded, round);
                Ok(Heard::Bound(bound.value))
            }
        }
    }

    /// The values at several places; those not known are evaluated together, equal places once.
    pub(crate) fn ask_many(&mut self, xs: &[Vec<f64>], round: usize) -> Result<Vec<f64>, SearchError> {
        if let [x] = xs {
            return Ok(vec![self.ask(x, round)?]);
        }
        let mut unknown: Vec<Vec<f64>> = Vec::new();
        for x in xs {
            if self.steps.find(x).is_none() && !unknown.contains(x) {
                unknown.push(x.clone());
            }
        }
        let answers = self.cost.evaluate_many(&unknown);
        if answers.len() != unknown.len() {
            return Err(CostError::Answers { asked: unknown.len(), answered: answers.len() }.into());
        }
        let mut fresh = unknown.iter().zip(&answers).peekable();
        let mut values = Vec::with_capacity(xs.len());
        for x in xs {
            let evaluated = fresh.next_if(|(asked, _)| *asked == x);
            values.push(match evaluated {
                Some((_, evaluation)) => self.learn(x, evaluation, round)?,
                None => self.ask(x, round)?,
            });
        }
        Ok(values)
    }

    fn learn(&mut self, x: &[f64], evaluation: &Evaluation, round: usize) -> Result<f64, SearchError> {
        self.evaluations += 1;
        self.steps.insert(x, evaluation)?;
        self.note(x, evaluation.value, Source::Evaluated, round);
        Ok(evaluation.value)
    }

    fn note(&mut self, x: &[f64], value: f64, source: Source, round: usize) {
        // Strictly lower: of equal values the earlier found stays.
        let lowest = !source.is_bound() && self.best.as_ref().is_none_or(|best| value < best.value);
        if lowest {
            self.best = Some(Best { x: x.to_vec(), value });
            self.improved = self.evaluations;
        }
        let accepted = lowest && self.marks_lowest;
        self.trace.push(Trial { x: x.to_vec(), value, source, accepted, round });
    }

    /// Notes that the last `count` places asked for entered the population.
    pub(crate) fn accept(&mut self, count: usize) {
        for trial in self.trace.iter_mut().rev().take(count) {
            trial.accepted = true;
        }
    }

    /// Whether the value at the first place is known to hold at all of them.
    pub(crate) fn on_one_step<'x>(&self, mut places: impl Iterator<Item = &'x [f64]>) -> bool {
        let Some(first) = places.next() else { return false };
        self.steps.step_at(first).is_some_and(|known| places.all(|x| known.step.contains(first, x)))
    }

    /// The result; in one axis with the share that is certified, which the known steps tell.
    pub(crate) fn finish(self, rounds: usize, stop: StopReason) -> Result<Minimum, SearchError> {
        self.finish_with(rounds, stop, None)
    }

    /// The result of a method without a population, which keeps count of the certified share.
    pub(crate) fn finish_with(
        self,
        rounds: usize,
        stop: StopReason,
        certified: Option<f64>,
    ) -> Result<Minimum, SearchError> {
        let Some(Best { x, value }) = self.best else { return Err(SearchError::NothingSeen { stop }) };
        let certified = certified.or_else(|| self.steps.proven(self.bounds, value));
        let step = self.steps.step_at(&x).map_or(Step::Point, |known| known.step);
        let Self { trace, evaluations, .. } = self;
        Ok(Minimum { x, value, step, calls: trace.len(), evaluations, rounds, stop, certified, trace })
    }
}

/// Refuses start places that the bounds do not hold.
pub(crate) fn check_starts(start: &[Vec<f64>], bounds: &Bounds) -> Result<(), SearchError> {
    for (index, x) in start.iter().enumerate() {
        if x.len() != bounds.dimension() {
            let (axes, dimension) = (x.len(), bounds.dimension());
            return Err(SearchError::StartDimension { index, axes, dimension });
        }
        if let Some(number) = bounds.outside(x) {
            let (axis, value) = (&bounds.axes()[number], x[number]);
            let (lo, hi) = (axis.lo(), axis.hi());
            return Err(if lo <= value && value <= hi {
                SearchError::StartNotAllowed { index, axis: number, value }
            } else {
                SearchError::StartOutside { index, axis: number, value, lo, hi }
            });
        }
    }
    Ok(())
}
