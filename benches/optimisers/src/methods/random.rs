//! Random places, for comparison.

use std::error::Error;

use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;

use super::{Method, place};
use crate::recorder::Recorder;

/// Places drawn uniformly in the bounds, one after another: what a method must beat.
pub struct RandomPlaces;

impl Method for RandomPlaces {
    fn name(&self) -> &'static str {
        "random places"
    }

    fn run(&self, recorder: &mut Recorder, seed: u64) -> Result<(), Box<dyn Error>> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        while !recorder.over() {
            let x = place(recorder, &mut rng);
            recorder.value(&x);
        }
        Ok(())
    }
}
