//! Both ways between this crate and argmin. With the feature `argmin`.

#![cfg(feature = "argmin")]
// A test has no caller to report to; values are exact.
#![allow(clippy::unwrap_used, clippy::float_cmp)]

use std::cell::Cell;

use ::argmin::core::{CostFunction, Error, Executor};
use ::argmin::solver::neldermead::NelderMead;
use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;
use terrace_crs::argmin::{FromArgmin, ToArgmin};
use terrace_crs::{Bounds, ControlledRandomSearch, CostError, SearchError, Stopping, from_fn, from_stairs};

/// Whole squares, which fails above a limit and counts what it is asked.
struct Squares {
    limit: f64,
    asked: Cell<usize>,
}

impl CostFunction for Squares {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, x: &Vec<f64>) -> Result<f64, Error> {
        self.asked.set(self.asked.get() + 1);
        if x[0] > self.limit {
            return Err(Error::msg(format!("{} is too high", x[0])));
        }
        Ok(x[0].floor().powi(2))
    }
}

fn search() -> ControlledRandomSearch {
    ControlledRandomSearch {
        stopping: Stopping { rounds: Some(200), ..Stopping::default() },
        ..ControlledRandomSearch::default()
    }
}

#[test]
fn a_cost_function_of_argmin_is_minimised_and_every_evaluation_is_one_of_its() {
    let mut cost = FromArgmin::new(Squares { limit: f64::INFINITY, asked: Cell::new(0) });
    let bounds = Bounds::interval(-9.0, 9.0).unwrap();
    let minimum = search().minimise(&mut cost, &bounds, &mut ChaCha8Rng::seed_from_u64(0)).unwrap();
    assert_eq!(minimum.value, 0.0);
    assert!(cost.failure().is_none());
    assert_eq!(cost.into_inner().asked.get(), minimum.evaluations);
}

#[test]
fn a_failure_ends_the_search_at_its_place_and_is_kept() {
    let mut cost = FromArgmin::new(Squares { limit: 0.0, asked: Cell::new(0) });
    let bounds = Bounds::interval(-9.0, 9.0).unwrap();
    let error = search().minimise(&mut cost, &bounds, &mut ChaCha8Rng::seed_from_u64(0)).unwrap_err();
    let SearchError::Cost(CostError::NotFinite { x, value }) = error else { unreachable!("{error}") };
    assert!(x[0] > 0.0 && value.is_nan());
    assert_eq!(cost.failure().unwrap().to_string(), format!("{} is too high", x[0]));
}

#[test]
fn a_solver_of_argmin_finds_a_low_step_and_evaluates_none_twice() {
    let stairs = from_stairs(|x| ((x.floor() - 3.0).abs(), x.floor()..x.floor() + 1.0));
    let problem = ToArgmin::new(stairs, &Bounds::interval(0.0, 10.0).unwrap());
    let solver = NelderMead::new(vec![vec![9.0], vec![6.0]]);
    let result = Executor::new(problem, solver).configure(|state| state.max_iters(100)).run().unwrap();
    assert_eq!(result.state.best_cost, 0.0);
    let evaluations = result.problem.problem.unwrap().evaluations();
    assert!(evaluations <= 10, "{evaluations} for ten steps");
}

#[test]
fn places_outside_have_the_cost_of_the_nearest_inside_and_wrong_ones_are_refused() {
    let problem = ToArgmin::new(from_fn(|x| x[0] - x[1]), &Bounds::new([(0.0, 1.0), (0.0, 1.0)]).unwrap());
    assert_eq!(problem.cost(&vec![-5.0, 7.0]).unwrap(), -1.0);
    assert_eq!(problem.cost(&vec![0.0, 1.0]).unwrap(), -1.0);
    assert_eq!(problem.evaluations(), 1);
    for wrong in [vec![0.5], vec![0.5, f64::NAN]] {
        let error = problem.cost(&wrong).unwrap_err();
        assert!(error.to_string().contains("2 finite coordinates"), "{error}");
    }
    let unlimited = ToArgmin::new(from_fn(|_| f64::NAN), &Bounds::interval(0.0, 1.0).unwrap());
    assert!(unlimited.cost(&vec![0.5]).unwrap_err().to_string().contains("NaN"));
}
