//! What known steps are worth: the same search on each test function, with its steps and without.
//!
//! Both searches ask for the same places. The one that knows the steps evaluates the cost less often, and ends when all of
//! its population stands on one step.

use std::error::Error;

use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;
use terrace_crs::ControlledRandomSearch;
use terrace_staircases::{
    Ackley, DeJong, Kind, Knapsack, Needle, RandomStaircase, Rastrigin, TestCost, WithoutSteps,
};

fn main() -> Result<(), Box<dyn Error>> {
    println!("{:<14} {:>9} {:>9} {:>9} {:>10} {:>10}", "", "steps", "optimum", "found", "with", "without");
    compare(&DeJong::new(2)?)?;
    compare(&Rastrigin::new(1, 64)?)?;
    compare(&Rastrigin::new(2, 64)?)?;
    compare(&Ackley::new(2, 256)?)?;
    compare(&Needle::flat(1, 0.7, 0.02)?)?;
    compare(&Needle::sloped(2, 0.7, 0.02, 1.0, 20)?)?;
    for kind in [Kind::White, Kind::Walk, Kind::Trend] {
        compare(&RandomStaircase::from_seed(1, 200, kind)?)?;
    }
    compare(&Knapsack::from_seed(1, 3, 9)?)
}

fn compare<C: TestCost + Clone>(cost: &C) -> Result<(), Box<dyn Error>> {
    let search = ControlledRandomSearch::default();
    let (bounds, rng) = (cost.bounds(), || ChaCha8Rng::seed_from_u64(1));
    // The same draws for both.
    let with = search.minimise(&mut cost.clone(), &bounds, &mut rng())?;
    let without = search.minimise(&mut WithoutSteps(cost.clone()), &bounds, &mut rng())?;
    println!(
        "{:<14} {:>9} {:>9.3} {:>9.3} {:>10} {:>10}",
        cost.name(),
        cost.step_count(),
        cost.minimum(),
        with.value,
        with.evaluations,
        without.evaluations
    );
    Ok(())
}
