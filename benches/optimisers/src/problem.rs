//! What the methods are compared on.

use std::error::Error;

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use terrace_staircases::{
    Ackley, DeJong, Kind, Knapsack, Needle, ParameterError, RandomStaircase, Rastrigin, TestCost,
};

use crate::recorder::Recorder;

/// The places at which the median cost is taken.
const PLACES: usize = 1001;

type Make = dyn Fn(u64) -> Result<Box<dyn TestCost>, ParameterError> + Send + Sync;

/// A cost, or for random ones a family with one member for each seed.
pub struct Problem {
    /// Its name.
    pub name: String,
    /// Its number of axes.
    pub dimension: usize,
    /// Its number of steps.
    pub steps: u128,
    make: Box<Make>,
}

impl Problem {
    /// The problem that `make` makes from the number of the run.
    ///
    /// # Errors
    ///
    /// Those of `make`.
    pub fn new<C: TestCost + 'static>(
        make: impl Fn(u64) -> Result<C, ParameterError> + Send + Sync + 'static,
    ) -> Result<Self, Box<dyn Error>> {
        let first = make(0)?;
        Ok(Self {
            name: first.name(),
            dimension: first.bounds().dimension(),
            steps: first.step_count(),
            make: Box::new(move |seed| Ok(Box::new(make(seed)?))),
        })
    }

    /// The cost of run number `seed`, which ends after `cap` evaluations.
    ///
    /// # Errors
    ///
    /// Those of the cost's constructor.
    pub fn recorder(&self, seed: u64, cap: usize) -> Result<Recorder, ParameterError> {
        let mut cost = (self.make)(seed)?;
        let threshold = threshold(&mut *cost);
        Ok(Recorder::new(cost, threshold, cap))
    }
}

/// Success: within 1 % of the optimum if that is not zero, otherwise within 1 % of the median cost of random places.
fn threshold(cost: &mut dyn TestCost) -> f64 {
    let minimum = cost.minimum();
    if minimum != 0.0 {
        return minimum + 0.01 * minimum.abs();
    }
    let mut rng = ChaCha8Rng::seed_from_u64(0);
    let bounds = cost.bounds();
    let mut place = || -> Vec<f64> {
        bounds
            .axes()
            .iter()
            .map(|axis| axis.lo() + (axis.hi() - axis.lo()) * rng.random_range(0.0..1.0))
            .collect()
    };
    let mut values: Vec<f64> = (0..PLACES).map(|_| cost.evaluate(&place()).value).collect();
    values.sort_by(f64::total_cmp);
    minimum + 0.01 * (values[PLACES / 2] - minimum)
}

/// The test functions, in one, two and five axes where there are several.
///
/// # Errors
///
/// None with the parameters used here.
pub fn test_functions() -> Result<Vec<Problem>, Box<dyn Error>> {
    let mut problems = Vec::new();
    for dimension in [1, 2, 5] {
        problems.push(Problem::new(move |_| DeJong::new(dimension))?);
        problems.push(Problem::new(move |seed| Rastrigin::with_optimum(64, &cells(seed, 64, dimension)))?);
        problems.push(Problem::new(move |seed| Ackley::with_optimum(256, &cells(seed, 256, dimension)))?);
        // One part in fifty, a hundred and 98 of the domain.
        let width = [0.02, 0.1, 0.4][dimension / 2];
        problems.push(Problem::new(move |seed| Needle::flat(dimension, needle(seed, width), width))?);
        problems
            .push(Problem::new(move |seed| Needle::sloped(dimension, needle(seed, width), width, 1.0, 20))?);
    }
    for (items, most) in [(2, 20), (5, 5)] {
        problems.push(Problem::new(move |seed| Knapsack::from_seed(seed, items, most))?);
    }
    for kind in [Kind::White, Kind::Walk, Kind::Trend] {
        for steps in [50, 500] {
            problems.push(Problem::new(move |seed| RandomStaircase::from_seed(seed, steps, kind))?);
        }
    }
    problems.sort_by(|a, b| (&a.name, a.dimension).cmp(&(&b.name, b.dimension)));
    Ok(problems)
}

/// Where the needle of run number `seed` lies: in the upper half, away from where the slope leads.
fn needle(seed: u64, width: f64) -> f64 {
    let share: f64 = ChaCha8Rng::seed_from_u64(seed).random_range(0.0..1.0);
    0.5 + (0.5 - width) * share
}

/// The cell of the optimum of run number `seed` on each axis.
fn cells(seed: u64, cells: usize, dimension: usize) -> Vec<usize> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    (0..dimension).map(|_| rng.random_range(0..cells)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use terrace_staircases::Staircase;

    #[test]
    fn success_is_relative_to_the_optimum_or_to_the_median() {
        let threshold_of =
            |values: [f64; 2]| threshold(&mut Staircase::new(vec![0.0, 0.1, 1.0], values.to_vec()).unwrap());
        assert_eq!(threshold_of([-200.0, 5.0]), -198.0);
        assert_eq!(threshold_of([200.0, 500.0]), 202.0);
        assert_eq!(threshold_of([0.0, 500.0]), 5.0);
    }

    #[test]
    fn all_test_functions_have_another_name_or_dimension_and_several_seeds() {
        let problems = test_functions().unwrap();
        for (i, problem) in problems.iter().enumerate() {
            let same = |other: &Problem| (&other.name, other.dimension) == (&problem.name, problem.dimension);
            assert!(!problems[..i].iter().any(same), "{}", problem.name);
            for seed in 0..100 {
                assert_eq!(problem.recorder(seed, 1).unwrap().bounds().dimension(), problem.dimension);
            }
        }
    }
}
