//! The searches of terrace-crs.

use std::error::Error;

use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;
use terrace_crs::{Bounds, ControlledRandomSearch, Cost, Evaluation, SearchError, Steps};

use super::Method;
use crate::recorder::Recorder;

/// A search that keeps ending without an evaluation knows all the steps it can find.
const IDLE: usize = 100;

type Search = fn(&mut Objective, &Bounds, &mut Steps, &mut ChaCha8Rng) -> Result<(), SearchError>;

/// A search with its own parameters. When it ends by its own rules it starts again from the generator as it is by then,
/// with the steps already known.
struct Ours {
    name: &'static str,
    tells_steps: bool,
    takes: fn(usize) -> bool,
    search: Search,
}

/// Those that are in the tree.
pub fn all() -> Vec<Box<dyn Method>> {
    let any = |_| true;
    let figure_2: Search = |cost, bounds, steps, rng| {
        ControlledRandomSearch::default().minimise_with(cost, bounds, steps, rng).map(|_| ())
    };
    vec![
        Box::new(Ours { name: "Fig. 2, no steps", tells_steps: false, takes: any, search: figure_2 }),
        Box::new(Ours { name: "Fig. 2", tells_steps: true, takes: any, search: figure_2 }),
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
            // The search ends with an error, which is what is wanted here.
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
            let mut objective = Objective { recorder: &mut *recorder, tells_steps: self.tells_steps };
            let result = (self.search)(&mut objective, &bounds, &mut steps, &mut rng);
            match result {
                Err(error) if !recorder.over() => return Err(error.into()),
                _ => idle = if recorder.evaluations() > before { 0 } else { idle + 1 },
            }
        }
        Ok(())
    }
}
