//! The methods that are compared.

mod cma;
mod nlopt;
mod ours;
mod random;
mod swarm;

use std::error::Error;

use rand::RngExt;

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
    let mut methods: Vec<Box<dyn Method>> = vec![
        Box::new(random::RandomPlaces),
        Box::new(nlopt::Crs2Lm),
        Box::new(swarm::Swarm),
        Box::new(cma::CmaEs),
    ];
    methods.extend(ours::all());
    methods
}

/// A place uniformly in the bounds.
fn place(recorder: &Recorder, rng: &mut rand::rngs::ChaCha8Rng) -> Vec<f64> {
    let (lo, hi) = recorder.corners();
    lo.iter().zip(&hi).map(|(lo, hi)| lo + (hi - lo) * rng.random_range(0.0..1.0)).collect()
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;
    use terrace_staircases::DeJong;

    #[test]
    fn names_differ() {
        let names: HashSet<&str> = all().iter().map(|method| method.name()).collect();
        assert_eq!(names.len(), all().len());
    }

    #[test]
    fn every_method_descends_an_easy_flight_of_stairs_inside_the_bounds() {
        for dimension in [1, 2] {
            for method in all().iter().filter(|method| method.takes(dimension)) {
                // Half of the way down.
                let cost = DeJong::new(dimension).unwrap();
                let mut recorder = Recorder::new(Box::new(cost), -3.0 * dimension as f64, 2000);
                method.run(&mut recorder, 7).unwrap();
                assert!(recorder.success().is_some() && !recorder.asked_outside(), "{}", method.name());
            }
        }
    }

    #[test]
    fn every_method_ends_at_the_cap() {
        for method in all() {
            let mut recorder = Recorder::new(Box::new(DeJong::new(1).unwrap()), -7.0, 5);
            method.run(&mut recorder, 7).unwrap();
            assert!(recorder.evaluations() == 5 && recorder.over(), "{}", method.name());
        }
    }
}
