//! The searches of terrace-crs.

use std::error::Error;

use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;
use terrace_crs::{
    Bounds, CertifiedSearch, ControlledRandomSearch, Cost, Evaluation, LocalMutation, Minimum, PatternSearch,
    SearchError, Steps, Stopping, Sweep,
};

use super::Method;
use crate::recorder::Recorder;

/// A search that keeps ending without an evaluation knows all the steps it can find.
const IDLE: usize = 100;

type Search =
    fn(Stopping, &mut Objective, &Bounds, &mut Steps, &mut ChaCha8Rng) -> Result<Minimum, SearchError>;

/// A search with its own parameters, which ends at the value and the number of evaluations that the recorder allows. When
/// it ends by its own rules before, it starts again from the generator as it is by then, with the steps already known.
struct Ours {
    name: &'static str,
    tells_steps: bool,
    takes: fn(usize) -> bool,
    search: Search,
}

/// Those that are in the tree.
pub fn all() -> Vec<Box<dyn Method>> {
    let any: fn(usize) -> bool = |_| true;
    let figure_2: Search = |stopping, cost, bounds, steps, rng| {
        ControlledRandomSearch { stopping, ..Default::default() }.minimise_with(cost, bounds, steps, rng)
    };
    let mutation: Search = |stopping, cost, bounds, steps, rng| {
        LocalMutation { stopping, ..Default::default() }.minimise_with(cost, bounds, steps, rng)
    };
    let pattern: Search = |stopping, cost, bounds, steps, rng| {
        PatternSearch { stopping, ..Default::default() }.minimise_with(cost, bounds, steps, rng)
    };
    let sweep: Search = |stopping, cost, bounds, steps, _| {
        Sweep { stopping, ..Default::default() }.minimise_with(cost, bounds, steps)
    };
    let certified: Search = |stopping, cost, bounds, steps, _| {
        CertifiedSearch { stopping, ..Default::default() }.minimise_with(cost, bounds, steps)
    };
    let ours = |name, tells_steps, takes, search| -> Box<dyn Method> {
        Box::new(Ours { name, tells_steps, takes, search })
    };
    vec![
        ours("Fig. 2, no steps", false, any, figure_2),
        ours("Fig. 2", true, any, figure_2),
        ours("LocalMutation, no steps", false, any, mutation),
        ours("LocalMutation", true, any, mutation),
        ours("PatternSearch", true, any, pattern),
        ours("Sweep", true, |dimension| dimension == 1, sweep),
        ours("CertifiedSearch", true, any, certified),
    ]
}

struct Objective<'r> {
    recorder: &'r mut Recorder,
    tells_steps: bool,
}

impl Cost for Objective<'_> {
    fn evaluate(&mut self, x: &[f64]) -> Evaluation {
        match self.recorder.ask(x) {
            Some(evaluation) if self.tells_steps => evaluation,
            Some(evaluation) => Evaluation::point(evaluation.value),
            // Not reached: the search is told the same limits.
            None => Evaluation::point(f64::NAN),
        }
    }
}

impl Method for Ours {
    fn name(&self) -> &'static str {
        self.name
    }

    fn takes(&self, dimension: usize) -> bool {
        (self.takes)(dimension)
    }

    fn run(&self, recorder: &mut Recorder, seed: u64) -> Result<(), Box<dyn Error>> {
        let bounds = recorder.bounds().clone();
        let mut steps = Steps::new(&bounds);
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut idle = 0;
        while !recorder.over() && idle < IDLE {
            let before = recorder.evaluations();
            let (evaluations, target) = (Some(recorder.left()), Some(recorder.threshold()));
            let stopping = Stopping { evaluations, target, ..Stopping::default() };
            let mut objective = Objective { recorder: &mut *recorder, tells_steps: self.tells_steps };
            let minimum = (self.search)(stopping, &mut objective, &bounds, &mut steps, &mut rng)?;
            if minimum.is_proven() && !recorder.over() {
                return Err(
                    format!("{} is proven to be the minimum, but is no success", minimum.value).into()
                );
            }
            idle = if recorder.evaluations() > before { 0 } else { idle + 1 };
        }
        Ok(())
    }
}
