//! The search for the best settings.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;
use terrace_crs::{
    Axis, CertifiedSearch, Cost, Evaluation, Minimum, PatternSearch, SearchError, Step, Steps, StopReason,
    Stopping,
};

use crate::Params;
use crate::tune::roundest::roundest;
use crate::tune::{Settings, TuneAxis, TuneCost, TuneError, TuneStep};

/// Starts of the pattern search: the settings in use, and two at random lest it stay in their basin.
const STARTS: usize = 3;

/// The pattern search goes down to this share of the ranges of ω and φ. Finer moves are for the certified search, which
/// begins beside the best.
const FINEST: f64 = 1.0 / 1024.0;

/// How the best settings are searched.
#[derive(Debug, Clone)]
pub struct TuneSearch {
    /// At most this many evaluations of the cost, at least 2: half of them, or fewer, for a pattern search from the
    /// settings in use, the others for a certified search from the best it found.
    pub evaluations: usize,
    /// Ends the search, with the best so far, when it is set.
    pub cancel: Option<Arc<AtomicBool>>,
}

impl Default for TuneSearch {
    /// 300 evaluations.
    fn default() -> Self {
        Self { evaluations: 300, cancel: None }
    }
}

/// How far a search is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TuneProgress {
    /// Evaluations done.
    pub evaluations: usize,
    /// The lowest cost so far.
    pub best: f64,
}

/// Settings that were asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TuneTrial {
    /// The settings.
    pub settings: Settings,
    /// Their cost.
    pub value: f64,
    /// Whether it was evaluated; otherwise the step was known.
    pub evaluated: bool,
}

/// The best settings found.
#[derive(Debug, Clone, PartialEq)]
pub struct Tuned {
    /// The parameters with the best settings: those of an extraction with the same result, which searches no φ for
    /// single clusters.
    pub params: Params,
    /// The best settings: those in use unless there are better ones, whose ω and φ are then near the middle of their step,
    /// with few digits.
    pub best: Settings,
    /// The cost there, and the settings with the same result.
    pub step: TuneStep,
    /// The settings in use before, or the nearest of the space.
    pub before_settings: Settings,
    /// The cost there.
    pub before: TuneStep,
    /// The share of the space, from 0 to 1, for which it is proven that the cost is not lower: by width of the ranges of
    /// ω and φ, by number of values of the others.
    pub certified: f64,
    /// Evaluations of the search.
    pub evaluations: usize,
    /// Why the search ended.
    pub stop: StopReason,
    /// All settings that were asked for, in order.
    pub trials: Vec<TuneTrial>,
}

impl TuneCost<'_> {
    /// Searches the settings of least cost: first down from the settings in use along one setting at a time
    /// ([`PatternSearch`]), then wherever a lower cost is likely ([`CertifiedSearch`]). Random starts are drawn with
    /// [`Params::seed`]. `progress` hears of each evaluation.
    ///
    /// # Errors
    /// [`TuneError`] when fewer than 2 evaluations are allowed, the search was cancelled before the first, or a map cannot
    /// be made.
    pub fn tune(
        &mut self,
        search: &TuneSearch,
        progress: impl FnMut(TuneProgress),
    ) -> Result<Tuned, TuneError> {
        let TuneSearch { evaluations, cancel } = search;
        if *evaluations < 2 {
            return Err(TuneError::Evaluations { evaluations: *evaluations });
        }
        let start = self.bounds.nearest(&self.tuner.in_use().place());
        let stopping = |evaluations| Stopping {
            evaluations: Some(evaluations),
            cancel: cancel.clone(),
            ..Stopping::default()
        };
        let bounds = self.bounds.clone();
        let mut steps = Steps::new(&bounds);
        let mut rng = ChaCha8Rng::seed_from_u64(self.tuner.params.seed);
        let mut watched =
            Watched { cost: self, progress, seen: TuneProgress { evaluations: 0, best: f64::INFINITY } };

        let pattern = PatternSearch {
            start: vec![start.clone()],
            starts: Some(STARTS),
            finest: Some(FINEST),
            stopping: stopping(evaluations / 2),
        };
        let descent = pattern.minimise_with(&mut watched, &bounds, &mut steps, &mut rng);
        let descent = watched.or_refusal(descent)?;
        let certified = CertifiedSearch {
            start: vec![descent.x.clone()],
            stopping: stopping(evaluations - descent.evaluations),
            ..CertifiedSearch::default()
        };
        let proof = certified.minimise_with(&mut watched, &bounds, &mut steps);
        let proof = match watched.or_refusal(proof) {
            // Cancelled in between: what the descent found stands, and nothing is proven.
            Err(TuneError::Search(SearchError::NothingSeen { .. })) => None,
            proof => Some(proof?),
        };
        self.report(&start, &descent, proof.as_ref())
    }

    fn report(
        &mut self,
        start: &[f64],
        descent: &Minimum,
        proof: Option<&Minimum>,
    ) -> Result<Tuned, TuneError> {
        let minimum = proof.filter(|proof| proof.value < descent.value).unwrap_or(descent);
        // Settings that are as good as any stay as they were given.
        let best = if minimum.x == start { start.to_vec() } else { self.readable(minimum) };
        // Both searches begin at five coordinates; this is for its type alone.
        let (Some(best), Some(before_settings)) = (Settings::at(&best), Settings::at(start)) else {
            return Err(TuneError::NoValue { axis: TuneAxis::CellSize });
        };
        let trials = descent.trace.iter().chain(proof.iter().flat_map(|p| &p.trace)).filter_map(|trial| {
            let evaluated = trial.source.is_evaluation();
            Some(TuneTrial { settings: Settings::at(&trial.x)?, value: trial.value, evaluated })
        });
        Ok(Tuned {
            params: best.in_params(&self.tuner.params),
            best,
            step: self.at(&best)?,
            before_settings,
            before: self.at(&before_settings)?,
            certified: proof.and_then(|p| p.certified).unwrap_or(0.0),
            evaluations: descent.evaluations + proof.map_or(0, |p| p.evaluations),
            stop: proof.unwrap_or(descent).stop,
            trials: trials.collect(),
        })
    }

    /// The place of a minimum, with ω and φ as numbers of few digits within its step.
    fn readable(&self, minimum: &Minimum) -> Vec<f64> {
        let Step::Box { lo, hi } = &minimum.step else { return minimum.x.clone() };
        let mut x = minimum.x.clone();
        for (((x, lo), hi), axis) in x.iter_mut().zip(lo).zip(hi).zip(self.bounds.axes()) {
            if let Axis::Real { lo: first, hi: last } = axis {
                *x = roundest(lo.max(*first), hi.min(last.next_up()), *x);
            }
        }
        x
    }
}

/// A cost that tells of its evaluations.
struct Watched<'c, 't, P> {
    cost: &'c mut TuneCost<'t>,
    progress: P,
    seen: TuneProgress,
}

impl<P> Watched<'_, '_, P> {
    /// The reason of the cost itself, where it has one: a search only heard that there is no value.
    fn or_refusal(&mut self, outcome: Result<Minimum, SearchError>) -> Result<Minimum, TuneError> {
        outcome.map_err(|error| self.cost.refusal.take().unwrap_or(error.into()))
    }
}

impl<P: FnMut(TuneProgress)> Cost for Watched<'_, '_, P> {
    fn evaluate(&mut self, x: &[f64]) -> Evaluation {
        let evaluation = self.cost.evaluate(x);
        self.seen.evaluations += 1;
        self.seen.best = self.seen.best.min(evaluation.value);
        (self.progress)(self.seen);
        evaluation
    }

    fn dimension(&self) -> Option<usize> {
        self.cost.dimension()
    }
}
