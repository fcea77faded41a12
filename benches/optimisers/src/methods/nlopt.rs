//! NLopt's controlled random search with local mutation.

use std::error::Error;

use nlopt::{Algorithm, Nlopt, Target};
use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;

use super::{Method, place};
use crate::recorder::Recorder;

/// `NLOPT_GN_CRS2_LM` with its own population of 10 (*d* + 1), started from a random place.
pub struct Crs2Lm;

impl Method for Crs2Lm {
    fn name(&self) -> &'static str {
        "NLopt CRS2-LM"
    }

    fn run(&self, recorder: &mut Recorder, seed: u64) -> Result<(), Box<dyn Error>> {
        let (lo, hi) = recorder.corners();
        let mut x = place(recorder, &mut ChaCha8Rng::seed_from_u64(seed));
        let (threshold, left) = (recorder.threshold(), u32::try_from(recorder.left())?);
        #[allow(clippy::mut_mut, reason = "NLopt hands its user data back by reference")]
        let objective = |x: &[f64], _: Option<&mut [f64]>, recorder: &mut &mut Recorder| recorder.value(x);
        let mut search = Nlopt::new(Algorithm::Crs2Lm, lo.len(), objective, Target::Minimize, recorder);
        let set = [
            search.set_lower_bounds(&lo),
            search.set_upper_bounds(&hi),
            search.set_stopval(threshold),
            search.set_maxeval(left),
        ];
        if let Some(state) = set.into_iter().find_map(Result::err) {
            return Err(format!("NLopt refuses the bounds or limits: {state:?}").into());
        }
        // Its generator belongs to the thread, and a run stays on one.
        Nlopt::<fn(&[f64], Option<&mut [f64]>, &mut ()) -> f64, ()>::srand_seed(Some(seed));
        match search.optimize(&mut x) {
            Ok(_) => Ok(()),
            Err((state, _)) => Err(format!("NLopt failed: {state:?}").into()),
        }
    }
}
