//! Choosing the cut-off of a laboratory test.
//!
//! A blood value was measured in 24 people; later it was known who was ill. A rule calls ill whoever has a value above
//! the cut-off. A missed patient is five times as bad as a false alarm. Which cut-off costs least?
//!
//! The cost changes only where the cut-off passes a measured value, so between two neighbouring values it is known.
//! The program searches with that knowledge and without; it sweeps all cut-offs, which is proof; and it asks how sure one
//! can be after eight evaluations.

use std::error::Error;

use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;
use terrace_crs::{
    Bounds, CertifiedSearch, ControlledRandomSearch, Cost, Evaluation, Minimum, Step, Stopping, Sweep,
    from_line,
};

const HEALTHY: [f64; 14] = [0.8, 1.1, 1.3, 1.9, 2.2, 2.4, 2.7, 3.1, 3.2, 3.8, 4.4, 5.0, 6.1, 7.3];
const ILL: [f64; 10] = [2.9, 4.1, 4.7, 5.3, 5.9, 6.4, 6.8, 7.7, 8.2, 9.5];
const MISSED: f64 = 5.0;
const FALSE_ALARM: f64 = 1.0;

struct CutOff;

impl Cost for CutOff {
    fn evaluate(&mut self, x: &[f64]) -> Evaluation {
        let Some(&cut) = x.first() else { return Evaluation::point(f64::NAN) };
        // Whoever is at the cut-off is not above it: the same people are ill from one value up to, not at, the next.
        let values = || HEALTHY.iter().chain(&ILL).copied();
        let lo = values().filter(|&v| v <= cut).fold(f64::NEG_INFINITY, f64::max);
        let hi = values().filter(|&v| v > cut).fold(f64::INFINITY, f64::min);
        Evaluation::interval(loss(cut), lo..hi)
    }

    fn dimension(&self) -> Option<usize> {
        Some(1)
    }
}

fn loss(cut: f64) -> f64 {
    let missed = ILL.iter().filter(|&&v| v <= cut).count();
    let alarms = HEALTHY.iter().filter(|&&v| v > cut).count();
    MISSED * missed as f64 + FALSE_ALARM * alarms as f64
}

fn main() -> Result<(), Box<dyn Error>> {
    let bounds = Bounds::interval(0.0, 10.0)?;
    let search = ControlledRandomSearch::default();

    let with_steps = search.minimise(&mut CutOff, &bounds, &mut ChaCha8Rng::seed_from_u64(7))?;
    print("with steps", &with_steps);
    let without = search.minimise(&mut from_line(loss), &bounds, &mut ChaCha8Rng::seed_from_u64(7))?;
    print("without", &without);

    print("sweep", &Sweep::default().minimise(&mut CutOff, &bounds)?);
    let stopping = Stopping { evaluations: Some(8), ..Stopping::default() };
    print(
        "eight",
        &CertifiedSearch { stopping, ..CertifiedSearch::default() }.minimise(&mut CutOff, &bounds)?,
    );

    if let Step::Box { lo, hi } = &with_steps.step {
        println!("\nAny cut-off from {:?} to just below {:?} is as good.", lo[0], hi[0]);
    }
    Ok(())
}

fn print(name: &str, minimum: &Minimum) {
    println!(
        "{name:<11} loss {} at cut-off {:.3}: {} questions, {} evaluations, stopped by {:?}, proven on {:.0} %",
        minimum.value,
        minimum.x[0],
        minimum.calls,
        minimum.evaluations,
        minimum.stop,
        100.0 * minimum.certified.unwrap_or(0.0)
    );
}
