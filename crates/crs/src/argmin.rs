//! For users of [argmin](https://docs.rs/argmin), a crate of optimisation methods, which it calls solvers: its cost
//! functions minimised by the methods here, and costs of this crate minimised by its solvers. With the feature
//! `argmin`.
//!
//! A cost function of argmin, minimised here:
//!
//! ```
//! use argmin::core::{CostFunction, Error};
//! use rand::{SeedableRng, rngs::ChaCha8Rng};
//! use terrace_crs::{Bounds, LocalMutation, argmin::FromArgmin};
//!
//! /// Of (x - 1)² + (y + 2)², rounded to tenths.
//! struct Bowl;
//!
//! impl CostFunction for Bowl {
//!     type Param = Vec<f64>;
//!     type Output = f64;
//!
//!     fn cost(&self, x: &Vec<f64>) -> Result<f64, Error> {
//!         Ok((10.0 * ((x[0] - 1.0).powi(2) + (x[1] + 2.0).powi(2))).round() / 10.0)
//!     }
//! }
//!
//! let bounds = Bounds::new([(-5.0, 5.0), (-5.0, 5.0)])?;
//! let mut rng = ChaCha8Rng::seed_from_u64(1);
//! let minimum = LocalMutation::default().minimise(&mut FromArgmin::new(Bowl), &bounds, &mut rng)?;
//! assert_eq!(minimum.value, 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A staircase of this crate, minimised by a solver of argmin. The cost is not evaluated twice on a known step here
//! either:
//!
//! ```
//! use argmin::core::Executor;
//! use argmin::solver::neldermead::NelderMead;
//! use terrace_crs::{Bounds, argmin::ToArgmin, from_stairs};
//!
//! let stairs = from_stairs(|x| ((x.floor() - 3.0).abs(), x.floor()..x.floor() + 1.0));
//! let bounds = Bounds::interval(0.0, 10.0)?;
//! let problem = ToArgmin::new(stairs, &bounds);
//! let solver = NelderMead::new(vec![vec![9.0], vec![6.0]]);
//! let result = Executor::new(problem, solver).configure(|state| state.max_iters(100)).run()?;
//! assert_eq!(result.state.best_cost, 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use std::sync::{Mutex, PoisonError};

use argmin::core::{CostFunction, Error};

use crate::{Bounds, Cost, CostError, Evaluation, Steps};

/// A cost function of argmin as a [`Cost`] of single places: it knows no steps.
///
/// The function must take a `Vec<f64>` and return an `f64`. Where it fails, the cost is NaN, which ends a search with
/// an error that names the place; what the function said is kept in [`failure`](Self::failure).
#[derive(Debug)]
pub struct FromArgmin<F> {
    function: F,
    failure: Option<Error>,
}

impl<F> FromArgmin<F> {
    /// The cost of this function.
    pub fn new(function: F) -> Self {
        Self { function, failure: None }
    }

    /// The last failure of the function.
    pub fn failure(&self) -> Option<&Error> {
        self.failure.as_ref()
    }

    /// The function again.
    pub fn into_inner(self) -> F {
        self.function
    }
}

impl<F: CostFunction<Param = Vec<f64>, Output = f64>> Cost for FromArgmin<F> {
    fn evaluate(&mut self, x: &[f64]) -> Evaluation {
        match self.function.cost(&x.to_vec()) {
            Ok(value) => Evaluation::point(value),
            Err(failure) => {
                self.failure = Some(failure);
                Evaluation::point(f64::NAN)
            }
        }
    }
}

/// A [`Cost`] as a cost function of argmin, with the steps known so far: a place on one of them is not evaluated.
///
/// A place outside the bounds has the cost of the nearest one inside, because most solvers of argmin know no bounds.
#[derive(Debug)]
pub struct ToArgmin<C> {
    bounds: Bounds,
    inner: Mutex<Inner<C>>,
}

#[derive(Debug)]
struct Inner<C> {
    cost: C,
    steps: Steps,
    evaluations: usize,
}

impl<C: Cost> ToArgmin<C> {
    /// The cost within these bounds.
    pub fn new(cost: C, bounds: &Bounds) -> Self {
        let inner = Inner { cost, steps: Steps::new(bounds), evaluations: 0 };
        Self { bounds: bounds.clone(), inner: Mutex::new(inner) }
    }

    /// How often the cost was really evaluated.
    pub fn evaluations(&self) -> usize {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner).evaluations
    }
}

impl<C: Cost> CostFunction for ToArgmin<C> {
    type Param = Vec<f64>;
    type Output = f64;

    /// # Errors
    /// A [`CostError`]: the place has NaN or another number of axes, or the cost breaks its contract there.
    fn cost(&self, x: &Vec<f64>) -> Result<f64, Error> {
        let inner = &mut *self.inner.lock().unwrap_or_else(PoisonError::into_inner);
        let dimension = self.bounds.dimension();
        if x.len() != dimension || x.iter().any(|v| v.is_nan()) {
            return Err(CostError::NoPlace { x: x.clone(), dimension }.into());
        }
        let inside = self.bounds.nearest(x);
        if let Some(value) = inner.steps.find(&inside) {
            return Ok(value);
        }
        let evaluation = inner.cost.evaluate(&inside);
        inner.evaluations += 1;
        inner.steps.insert(&inside, &evaluation)?;
        Ok(evaluation.value)
    }
}
