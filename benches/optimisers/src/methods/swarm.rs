//! argmin's particle swarm.

use std::cell::RefCell;
use std::error::Error;

use argmin::core::{CostFunction, Error as ArgminError, Executor};
use argmin::solver::particleswarm::ParticleSwarm;
use rand_chacha_for_argmin::ChaCha8Rng;
use rand_chacha_for_argmin::rand_core::SeedableRng;

use super::Method;
use crate::recorder::Recorder;

/// argmin's `ParticleSwarm` with its own weights, and as many particles as belong to them in the standard particle swarm
/// optimisation of 2006: 10 + ⌊2 √*d*⌋. It clamps the particles to the bounds itself.
pub struct Swarm;

struct Objective<'r>(RefCell<&'r mut Recorder>);

impl CostFunction for Objective<'_> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, x: &Vec<f64>) -> Result<f64, ArgminError> {
        let answer = self.0.borrow_mut().ask(x);
        answer.map(|evaluation| evaluation.value).ok_or_else(|| ArgminError::msg("the run is over"))
    }
}

impl Method for Swarm {
    fn name(&self) -> &'static str {
        "argmin PSO"
    }

    fn run(&self, recorder: &mut Recorder, seed: u64) -> Result<(), Box<dyn Error>> {
        let (lo, hi) = recorder.corners();
        // ⌊2 √d⌋ = ⌊√(4 d)⌋.
        let particles = 10 + (4 * lo.len()).isqrt();
        let rounds = u64::try_from(recorder.left())?;
        let solver =
            ParticleSwarm::new((lo, hi), particles).with_rng_generator(ChaCha8Rng::seed_from_u64(seed));
        let objective = Objective(RefCell::new(&mut *recorder));
        let result =
            Executor::new(objective, solver).configure(|state| state.max_iters(rounds)).timer(false).run();
        match result.map(|_| ()) {
            Err(error) if !recorder.over() => Err(error.to_string().into()),
            _ => Ok(()),
        }
    }
}
