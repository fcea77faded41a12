//! The one place where a method asks for values: known steps first, and everything is written down.

use crate::{Cost, Minimum, SearchError, Source, Step, Steps, StopReason, Trial};

pub(crate) struct Ledger<'s> {
    steps: &'s mut Steps,
    trace: Vec<Trial>,
    evaluations: usize,
    best: Option<Best>,
}

struct Best {
    x: Vec<f64>,
    value: f64,
}

impl<'s> Ledger<'s> {
    pub(crate) fn new(steps: &'s mut Steps) -> Self {
        Self { steps, trace: Vec::new(), evaluations: 0, best: None }
    }

    /// The value at `x`, from a known step or else from the cost, whose answer is checked and kept.
    pub(crate) fn ask(
        &mut self,
        cost: &mut (impl Cost + ?Sized),
        x: &[f64],
        round: usize,
    ) -> Result<f64, SearchError> {
        let known = self.steps.find(x);
        let value = if let Some(value) = known {
            value
        } else {
            let evaluation = cost.evaluate(x);
            self.evaluations += 1;
            self.steps.insert(x, &evaluation)?;
            evaluation.value
        };
        let source = if known.is_some() { Source::Known } else { Source::Evaluated };
        // Strictly lower: of equal values the earlier found stays.
        if self.best.as_ref().is_none_or(|best| value < best.value) {
            self.best = Some(Best { x: x.to_vec(), value });
        }
        self.trace.push(Trial { x: x.to_vec(), value, source, accepted: false, round });
        Ok(value)
    }

    /// Notes that the place asked for last entered the population.
    pub(crate) fn accept(&mut self) {
        if let Some(trial) = self.trace.last_mut() {
            trial.accepted = true;
        }
    }

    /// Whether the value at the first place is known to hold at all of them.
    pub(crate) fn on_one_step<'x>(&self, mut places: impl Iterator<Item = &'x [f64]>) -> bool {
        let Some(first) = places.next() else { return false };
        self.steps.step_at(first).is_some_and(|known| places.all(|x| known.step.contains(first, x)))
    }

    pub(crate) fn finish(self, rounds: usize, stop: StopReason) -> Result<Minimum, SearchError> {
        let Some(Best { x, value }) = self.best else { return Err(SearchError::EmptyPopulation) };
        let step = self.steps.step_at(&x).map_or(Step::Point, |known| known.step);
        let Self { trace, evaluations, .. } = self;
        Ok(Minimum { x, value, step, calls: trace.len(), evaluations, rounds, stop, trace })
    }
}
