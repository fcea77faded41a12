//! The methods that are compared.

mod cma;
mod nlopt;
mod ours;
mod swarm;

use std::error::Error;

use crate::recorder::Recorder;

/// One way to minimise.
pub trait Method: Sync {
    /// Its name in the table.
    fn name(&self) -> &'static str;

    /// Whether it works with so many axes.
    fn takes(&self, dimension: usize) -> bool {
        let _ = dimension;
        true
    }

    /// Minimises until the recorder is over, or until nothing more comes of it.
    ///
    /// # Errors
    ///
    /// What the method reports, except the end of the recorder.
    fn run(&self, recorder: &mut Recorder, seed: u64) -> Result<(), Box<dyn Error>>;
}

/// All of them, in the order of the table.
pub fn all() -> Vec<Box<dyn Method>> {
    let mut methods: Vec<Box<dyn Method>> =
        vec![Box::new(nlopt::Crs2Lm), Box::new(swarm::Swarm), Box::new(cma::CmaEs)];
    methods.extend(ours::all());
    methods
}

/// A place uniformly in the bounds.
fn place(recorder: &Recorder, rng: &mut rand::rngs::ChaCha8Rng) -> Vec<f64> {
    use rand::RngExt;
    let axes = recorder.bounds().axes();
    axes.iter().map(|(lo, hi)| lo + (hi - lo) * rng.random_range(0.0..1.0)).collect()
}
