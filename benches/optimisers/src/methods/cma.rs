//! The covariance matrix adaptation evolution strategy of the crate cmaes.

use std::error::Error;

use cmaes::{CMAESOptions, DVector};
use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;

use super::{Method, place};
use crate::recorder::Recorder;

/// CMA-ES with its own population of 4 + ⌊3 ln *d*⌋ in the unit cube, started at a random place with a step of 0.3. Points
/// outside the bounds are clamped to them before they are evaluated. When it ends by its own rules, as it does on a flat
/// floor, it starts again at another place.
pub struct CmaEs;

impl Method for CmaEs {
    fn name(&self) -> &'static str {
        "CMA-ES"
    }

    fn run(&self, recorder: &mut Recorder, seed: u64) -> Result<(), Box<dyn Error>> {
        let (lo, hi) = recorder.corners();
        let axes: Vec<(f64, f64)> = lo.into_iter().zip(hi).collect();
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        for restart in 0.. {
            let start: Vec<f64> = place(recorder, &mut rng)
                .iter()
                .zip(&axes)
                .map(|(x, (lo, hi))| if hi > lo { (x - lo) / (hi - lo) } else { 0.0 })
                .collect();
            let options = CMAESOptions::new(start, 0.3)
                .seed(seed.wrapping_mul(1_000_000).wrapping_add(restart))
                .max_function_evals(recorder.left())
                .fun_target(recorder.threshold());
            let objective = |u: &DVector<f64>| {
                let inside =
                    |(u, (lo, hi)): (&f64, &(f64, f64))| (lo + (hi - lo) * u.clamp(0.0, 1.0)).min(*hi);
                let x: Vec<f64> = u.iter().zip(&axes).map(inside).collect();
                recorder.value(&x)
            };
            options.build(objective).map_err(|error| format!("CMA-ES: {error:?}"))?.run();
            if recorder.over() {
                break;
            }
        }
        Ok(())
    }
}
