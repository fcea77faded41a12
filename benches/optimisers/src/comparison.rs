//! Running the methods over the seeds, and what comes of it.

use std::error::Error;
use std::fmt::Display;

use rayon::prelude::*;
use serde::Serialize;

use crate::methods::Method;
use crate::problem::Problem;

/// One method on one problem.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// The problem.
    pub cost: String,
    /// Its number of axes.
    pub dimension: usize,
    /// Its number of steps.
    pub steps: f64,
    /// The method.
    pub method: String,
    /// The number of the evaluation that succeeded, for each seed; none within the cap.
    pub success: Vec<Option<usize>>,
}

impl Row {
    /// Runs all seeds. The result does not depend on the number of threads.
    ///
    /// # Errors
    ///
    /// The first one of a run, with its names.
    pub fn measure(
        problem: &Problem,
        method: &dyn Method,
        seeds: u64,
        cap: usize,
    ) -> Result<Self, Box<dyn Error>> {
        let one = |seed| -> Result<Option<usize>, String> {
            let named =
                |error: &dyn Display| format!("{} on {}, seed {seed}: {error}", method.name(), problem.name);
            let mut recorder =
                problem.recorder(seed, cap * problem.dimension).map_err(|error| named(&error))?;
            method.run(&mut recorder, draws(problem).wrapping_add(seed)).map_err(|error| named(&error))?;
            if recorder.asked_outside() {
                return Err(named(&"evaluated outside the bounds"));
            }
            Ok(recorder.success())
        };
        let success = (0..seeds).into_par_iter().map(one).collect::<Result<_, _>>()?;
        Ok(Self {
            cost: problem.name.clone(),
            dimension: problem.dimension,
            steps: problem.steps as f64,
            method: method.name().into(),
            success,
        })
    }

    /// The share of seeds that succeeded within so many evaluations.
    pub fn rate(&self, evaluations: usize) -> f64 {
        let succeeded = self.success.iter().flatten().filter(|&&number| number <= evaluations).count();
        succeeded as f64 / self.success.len() as f64
    }

    /// The evaluations within which `percent` of the seeds succeed; none if fewer do.
    pub fn quantile(&self, percent: usize) -> Option<usize> {
        let mut numbers: Vec<usize> = self.success.iter().flatten().copied().collect();
        numbers.sort_unstable();
        // The smallest number of seeds that is at least this share.
        let needed = (percent * self.success.len()).div_ceil(100).max(1);
        numbers.get(needed - 1).copied()
    }
}

/// Where the seeds of the methods begin, another place for each problem: the FNV-1a hash of its name and dimension. Costs
/// are drawn from seeds 0, 1, …, and places must not be drawn as they are.
fn draws(problem: &Problem) -> u64 {
    let bytes = problem.name.bytes().chain(problem.dimension.to_le_bytes());
    bytes.fold(0xCBF2_9CE4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01B3))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{methods, problem};

    fn row(success: Vec<Option<usize>>) -> Row {
        Row { cost: "c".into(), dimension: 1, steps: 1.0, method: "m".into(), success }
    }

    #[test]
    fn quantiles_count_the_seeds_without_success() {
        let row = row(vec![Some(30), None, Some(10), Some(20)]);
        assert_eq!((row.rate(9), row.rate(10), row.rate(29), row.rate(1000)), (0.0, 0.25, 0.5, 0.75));
        assert_eq!((row.quantile(50), row.quantile(75), row.quantile(76)), (Some(20), Some(30), None));
    }

    #[test]
    fn rows_do_not_depend_on_threads() {
        let problems = problem::test_functions().unwrap();
        let measure = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| -> Vec<Row> {
                let pairs = problems.iter().filter(|p| p.dimension < 3).flat_map(|p| {
                    methods::all().into_iter().filter(|m| m.takes(p.dimension)).map(move |m| (p, m))
                });
                pairs.map(|(p, m)| Row::measure(p, &*m, 5, 50).unwrap()).collect()
            })
        };
        let (one, four) = (measure(1), measure(4));
        assert_eq!(one, four);
        assert!(one.iter().any(|row| row.rate(100) > 0.0) && one.iter().any(|row| row.rate(100) < 1.0));
    }
}
