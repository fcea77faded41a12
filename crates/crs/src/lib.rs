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
//! tells how often that was, on which step the best place stands, every place it asked about, and what share of the
//! domain is proven to hold nothing lower.
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
//! The [`guide`] goes from a rule to a proven threshold, step by step.
//!
//! # The words used here
//!
//! * **Cost**: what is to become small; asked for its value at a place. **Place**: one number for each **axis**. Axes are
//!   [real, whole numbers, or a list of values](Axis); all allowed places together are the **domain**, here [`Bounds`].
//! * **Staircase**: a cost that is constant in pieces. **Step**: one such piece, or a part of it, as far as the cost can
//!   tell: an interval, in several axes a box.
//! * **Evaluation**: the cost is really computed; the dear thing that all methods save. **Call**: a value is asked for,
//!   known or not.
//! * **Lower bound**: a cost that is a growing sum can stop as soon as it knows that it will not fall below the lowest
//!   value so far, and say so with the [`Answer`] *at least this*.
//! * **Population**: a number of places with their values that a method keeps and improves. **Reflection**: from some
//!   members, the place on the other side of their common centre, seen from one of them: if that one lies high, the other
//!   side may lie low. **Mutation**: a place drawn at random near the best member.
//! * **Round**: one turn of a method; each tells what it does in it.
//! * **Certificate**: the proof that no place is lower than the value found, because every place lies on a known step or
//!   under a lower bound. **Certified share**: the part of the domain for which that is proven so far
//!   ([`Minimum::certified`]), from 0 to 1.
//! * **Trend** and **jitter**: the large-scale course of a staircase, and how much single steps differ from it.
//! * **Basin**: a stretch from every place of which the way down leads to the same lowest step.
//!
//! # Which method when
//!
//! | Method | Axes | Proof | Random | Use it when |
//! | --- | --- | --- | --- | --- |
//! | [`Sweep`] | one | yes | no | the steps are few enough to evaluate each once, or the cost is cheaper beside its last place |
//! | [`CertifiedSearch`] | any | as far as the budget goes | no | evaluations are dear and you want a good value early and to know how sure it is; the first choice in one axis |
//! | [`LocalMutation`] | any | no | yes | several axes, evaluations are dear |
//! | [`ControlledRandomSearch`] | any | no | yes | several axes, many basins; or to repeat the figure of the paper |
//! | [`PatternSearch`] | any, mixed above all | no | starts only | settings of several kinds; or to improve what another method found |
//!
//! All take the same [`Cost`], [`Bounds`] and [`Stopping`] rules and give the same kind of [`Minimum`]. Their known
//! [`Steps`] can be handed from one to the next (`minimise_with`): a random search, say, and a [`CertifiedSearch`] to
//! finish, which pays nothing for what the first has seen:
//!
//! ```
//! use rand::{SeedableRng, rngs::ChaCha8Rng};
//! use terrace_crs::{Bounds, CertifiedSearch, LocalMutation, Steps, from_stairs};
//!
//! let mut cost = from_stairs(|x| ((x.floor() - 70.0).abs(), x.floor()..x.floor() + 1.0));
//! let bounds = Bounds::interval(0.0, 99.5)?;
//! let mut steps = Steps::new(&bounds);
//! let mut rng = ChaCha8Rng::seed_from_u64(1);
//! let guess = LocalMutation::default().minimise_with(&mut cost, &bounds, &mut steps, &mut rng)?;
//! let proof = CertifiedSearch::default().minimise_with(&mut cost, &bounds, &mut steps)?;
//! assert_eq!(guess.evaluations + proof.evaluations, 100);
//! assert!(proof.is_proven() && proof.value <= guess.value);
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
//! * Values and lower bounds are kept apart: what is known to be *at least* so much is never reported as a value, nor
//!   taken for one by a method that compares values.
//! * Several places are evaluated at once only in groups of a size that you set (`batch`), never by the number of
//!   threads: so the result is the same on every machine.
//!
//! # Accuracy
//!
//! A reported value is one that the cost returned, never computed from others, and it was returned for a step that
//! contains the reported `x`. Values are compared exactly; a cost that is noisy is not a staircase. A certificate is as
//! right as the steps and bounds the cost tells; where they contradict each other, that is found and is an error.
//!
//! # Errors and panics
//!
//! Bounds and parameters that do not fit give a [`BoundsError`] or [`SearchError`] with the offending values; a cost
//! that returns NaN, an infinity, a step that cannot be right, or a bound that contradicts a value gives a [`CostError`]
//! that names `x`. Nothing panics unless the cost itself does.
//!
//! # Limitations
//!
//! * Only [`Sweep`] and [`CertifiedSearch`] look for a proof. The others prove their result only by chance, in one axis,
//!   when they have met every step.
//! * In many axes the number of steps grows beyond any budget, and with it what a certificate costs.
//! * Smooth costs are better served by methods that use their slope.

// Values and coordinates are compared as given: steps begin and end at exact numbers.
#![allow(clippy::float_cmp)]

#[cfg(feature = "argmin")]
pub mod argmin;
mod axis;
mod bounds;
mod certified_search;
mod controlled_random_search;
mod cost;
mod draw;
mod error;
#[doc = include_str!("guide.md")]
pub mod guide {}
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
