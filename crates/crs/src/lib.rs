//! Minimise a cost that is flat in pieces and jumps between them, without evaluating the same piece twice.
//!
//! Count the errors of a rule that says *yes* above a threshold, and move the threshold: the count stays the same
//! until a sample changes sides, then it jumps. Such a **staircase** is the cost of every cut-off, of settings that are
//! rounded, and of every program that decides by comparisons. Its slope is zero or undefined everywhere, so methods
//! that follow a slope do not work on it.
//!
//! Whoever computes such a cost often knows more than its value. All comparisons that were made would have come out the
//! same for any threshold up to the nearest one that decides differently, so the value is known on a whole **step**.
//! Here a [`Cost`] may say so: it answers with an [`Evaluation`], a value and the [`Step`] on which it holds. A search
//! keeps the known steps in [`Steps`] and asks the cost only where nothing is known yet; the [`Minimum`] it returns
//! tells how often that was, on which step the best place stands, and every place it asked about.
//!
//! ```
//! use rand::{SeedableRng, rngs::ChaCha8Rng};
//! use terrace_crs::{Bounds, ControlledRandomSearch, from_stairs};
//!
//! // Errors of 'positive when score > x': 1 and 4 are negative samples, 3 and 6 are positive ones.
//! let mut errors = from_stairs(|x| match x {
//!     _ if x < 1.0 => (2.0, f64::NEG_INFINITY..1.0),
//!     _ if x < 3.0 => (1.0, 1.0..3.0),
//!     _ if x < 4.0 => (2.0, 3.0..4.0),
//!     _ if x < 6.0 => (1.0, 4.0..6.0),
//!     _ => (2.0, 6.0..f64::INFINITY),
//! });
//! let bounds = Bounds::interval(0.0, 10.0)?;
//! let mut rng = ChaCha8Rng::seed_from_u64(1);
//! let minimum = ControlledRandomSearch::default().minimise(&mut errors, &bounds, &mut rng)?;
//! assert_eq!(minimum.value, 1.0);
//! assert!(minimum.evaluations <= 5, "there are five steps, and none is evaluated twice");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Why this interface
//!
//! * A step is half-open, `[lo, hi)` on each axis, because comparisons are: `x < t` changes exactly at `t`. Look-up is
//!   exact to the last bit, so that a neighbouring step can be asked for at `hi`.
//! * A cost that knows no step says [`Step::Point`]; [`from_fn`] and [`from_line`] wrap such functions.
//! * The random generator is passed in. The same one gives the same trace, and the draws are made from its 64-bit words
//!   in this crate, so that an update of `rand` does not change them while the generator's own stream stays.
//! * The known steps can outlive a search: [`ControlledRandomSearch::minimise_with`].
//!
//! # Methods
//!
//! [`ControlledRandomSearch`] works in any number of axes, within [`Bounds`], until a rule of [`Stopping`] ends it.
//!
//! # Accuracy
//!
//! A reported value is one that the cost returned, never computed from others, and it was returned for a step that
//! contains the reported `x`. Values are compared exactly; a cost that is noisy is not a staircase.
//!
//! # Errors and panics
//!
//! Bounds and parameters that do not fit give a [`BoundsError`] or [`SearchError`] with the offending values; a cost
//! that returns NaN, an infinity, or a step that cannot be right gives a [`CostError`] that names `x`. Nothing panics
//! unless the cost itself does.
//!
//! # Limitations
//!
//! * No search here proves that its result is the global minimum, except in the case told at
//!   [`StopReason::OneStep`].
//! * In several axes known steps are looked up one after another; with very many of them that takes longer than a cheap
//!   cost.
//! * Smooth costs are better served by methods that use their slope.

// Values and coordinates are compared as given: steps begin and end at exact numbers.
#![allow(clippy::float_cmp)]

mod axis;
mod bounds;
mod certified_search;
mod controlled_random_search;
mod cost;
mod draw;
mod error;
mod ledger;
mod local_mutation;
mod minimum;
mod parallel;
mod pattern_search;
mod population;
mod step;
mod steps;
mod stopping;
mod sweep;

pub use axis::Axis;
pub use bounds::{Bounds, BoundsError};
pub use certified_search::CertifiedSearch;
pub use controlled_random_search::ControlledRandomSearch;
pub use cost::{Answer, Cost, Evaluation, from_fn, from_line, from_stairs};
pub use error::SearchError;
pub use local_mutation::LocalMutation;
pub use minimum::{Minimum, Source, StopReason, Trial};
pub use parallel::in_parallel;
pub use pattern_search::PatternSearch;
pub use step::Step;
pub use steps::{CostError, Steps};
pub use stopping::Stopping;
pub use sweep::Sweep;

/// The examples of the README are tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
