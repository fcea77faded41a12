//! Staircase-shaped test functions whose optimum, steps and number of steps are known.
//!
//! A method that minimises costs which are flat in pieces needs costs to be tried on: ones of which it is known
//! beforehand how low they go. Each type here is a [`Cost`](terrace_crs::Cost) that answers with its exact step, and a
//! [`TestCost`] that tells its bounds, its optimum, a place where it is taken, and how many steps there are.
//!
//! ```
//! use rand::{SeedableRng, rngs::ChaCha8Rng};
//! use terrace_crs::ControlledRandomSearch;
//! use terrace_staircases::{Rastrigin, TestCost};
//!
//! let mut cost = Rastrigin::new(1, 100)?;
//! let bounds = cost.bounds();
//! let mut rng = ChaCha8Rng::seed_from_u64(3);
//! let found = ControlledRandomSearch::default().minimise(&mut cost, &bounds, &mut rng)?;
//! assert!(found.value >= cost.minimum());
//! assert!(found.evaluations <= 100, "there are {} steps", cost.step_count());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # The functions
//!
//! | Type | Value | Domain | Optimum | Steps |
//! | --- | --- | --- | --- | --- |
//! | [`DeJong`] | Σ ⌊xᵢ⌋ | [-5.12, 5.12]ᵈ | -6 *d* | 12ᵈ |
//! | [`Rastrigin`] | Σ (tᵢ² + 10 - 10 cos 2πtᵢ) on cells | [-5.12, 5.12]ᵈ | 0 | *n*ᵈ |
//! | [`Ackley`] | 20 + e - 20 exp(-0.2 √(Σtᵢ²/d)) - exp(Σ cos 2πtᵢ / d) on cells | [-32.768, 32.768]ᵈ | 0 | *n*ᵈ |
//! | [`Needle`] | 0 on one box, 1 or a staircase above 1 elsewhere | [0, 1]ᵈ | 0 | by the borders |
//! | [`Staircase`] | from lists of borders and values | as listed | the lowest value | as listed |
//! | [`RandomStaircase`] | drawn from a seed | [0, 1] | the lowest value | as asked for |
//! | [`Knapsack`] | -Σ vᵢkᵢ, and a penalty above the capacity; kᵢ = ⌊xᵢ⌋ | [0, uᵢ + 1] | exact, by dynamic programming | Π (uᵢ + 1) |
//!
//! Formula, source and optimum stand at each type.
//!
//! # What holds for all
//!
//! * Steps are half-open boxes, `lo` inside and `hi` outside. The outermost ones go on beyond the bounds for ever, so
//!   that the closed upper end of the bounds adds no step of its own and a place outside has a value too.
//! * The number of steps is that of the boxes a cost can answer with; neighbours may have the same value.
//! * The same parameters, and the same seed where there is one, give the same function; the draws are made from the
//!   64-bit words of a named generator in this crate. (Sines, exponentials and logarithms are those of the platform and may differ in
//!   the last bit between platforms.)
//! * [`TestCost::without_steps`] hides the steps: the same function for methods that know none, or to see what they
//!   are worth.
//!
//! # Errors and panics
//!
//! Wrong parameters give a [`ParameterError`] from the constructor. A place with another number of axes, or with NaN,
//! has the value NaN, which every search of `terrace-crs` reports. Nothing panics.

// Borders and values are compared as given: steps begin and end at exact numbers.
#![allow(clippy::float_cmp)]

mod ackley;
mod cells;
mod de_jong;
mod draw;
mod error;
mod grid;
mod knapsack;
mod needle;
mod random_staircase;
mod rastrigin;
mod staircase;
mod test_cost;
mod without_steps;

pub use ackley::Ackley;
pub use de_jong::DeJong;
pub use error::ParameterError;
pub use knapsack::{Item, Knapsack};
pub use needle::Needle;
pub use random_staircase::{Kind, RandomStaircase};
pub use rastrigin::Rastrigin;
pub use staircase::Staircase;
pub use test_cost::TestCost;
pub use without_steps::WithoutSteps;

/// The examples of the README are tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
