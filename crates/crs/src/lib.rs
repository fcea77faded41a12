//! Minimise a cost that is flat in pieces and jumps between them, without evaluating a known piece again.
//!
//! A **cost** is a function from one or more numbers to one number that should become small. Take the errors of a
//! rule that says *yes* above a threshold, and move the threshold: the count of errors stays the same until one data
//! point falls on the other side, then it jumps. Such a **staircase** is the cost of every cut-off, of settings that
//! are rounded, and of many programs that decide by comparisons. Its slope is zero or undefined everywhere, so
//! methods that follow a slope do not work on it.
//!
//! Whoever computes such a cost often knows more than its value. Move the threshold a little, and every comparison
//! comes out as before; only at the next data point does one change. Until there the value is known: on a whole
//! **step**. Here a [`Cost`] may say so: it answers with an [`Evaluation`], a value and the [`Step`] on which it
//! holds. A search keeps the known steps in [`Steps`] and evaluates the cost only where no value is known yet. The
//! [`Minimum`] it returns holds the best place and the step it stands on, how often the cost was evaluated, every
//! place asked about and, where the method can tell, for what share of all allowed places it is proven that none is
//! lower.
//!
//! ```
//! use rand::{SeedableRng, rngs::ChaCha8Rng};
//! use terrace_crs::{Bounds, ControlledRandomSearch, from_stairs};
//!
//! // A rule says yes when a score is above x. Four scores are known: yes is wrong for 1 and 4, right for 3 and 6.
//! // The answer: the number of errors, and the interval of x on which it is the same.
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
//! * **Cost**: what is to become small; asked for its value at a place. **Place**: one number, its **coordinate**,
//!   for each **axis**. Axes are [real, whole numbers, or a list of values](Axis); how many there are is the
//!   **dimension**, written *d*. All allowed places together are the **domain**, here [`Bounds`].
//! * **Lower**, **down**: with a lower cost. So the *lowest* place is the best one, and a **basin** (or valley) is a
//!   region in which every way down leads to the same bottom.
//! * **Staircase**: a cost that is constant in pieces. **Step**: one such piece, or a part of it, as far as the cost
//!   can tell: an interval, in several axes a box (an interval on each axis). Steps are **half-open**, written
//!   `[lo, hi)`: `lo` belongs to the step and `hi` does not.
//! * **Call** or **question**: a method asks for a value, known or not. **Evaluation**: the value is not known and
//!   the cost is really computed; this is what takes time, and what all methods save. **Trace**: the list of all
//!   calls.
//! * **Lower bound**: the answer *at least this* in place of a value. A cost that is a growing sum can stop as soon
//!   as it knows that it will not fall below a **ceiling**, such as the lowest value so far, and [answer](Answer) so.
//! * **Start place**: a place you give a method to begin with. **Drawn uniformly**: at random, each place as likely
//!   as any other. **Generator**: the source of random numbers, `rng`.
//! * **Population**: a number of places with their values that a method keeps and improves; each is a **member**.
//! * **Reflection**: take some members. From one of them go through the centre of the others and as far again beyond
//!   it: if the one lies high, the other side may lie low. That centre, the mean of each coordinate, is the
//!   **centroid**.
//! * **Mutation**: a place drawn at random beside the best member, on the side away from a place that was no good.
//! * **Spread**: the largest minus the smallest value of a population. To **converge**: to come to a place, or a
//!   population to come together, so that going on promises nothing more.
//! * **Mesh**: the length of a move of the [`PatternSearch`], as a share of each axis.
//! * **Round**: one turn of a method; each tells what it does in it.
//! * **Batch** or **group**: places that are asked for together, so that they can be evaluated on several threads.
//! * **Certificate**: the proof that no place is lower than the value found, because every place lies on a known step
//!   or under a lower bound. **Certified share**: the part of the domain for which that is proven so far
//!   ([`Minimum::certified`]), from 0 to 1. A place is **covered** when it is proven for it.
//! * **Trend** and **jitter**: the large-scale course of a staircase, and how much single steps differ from it.
//!
//! In notes on running time *d* is the number of axes, *k* that of known steps, *n* that of the population.
//!
//! # Which method when
//!
//! | Method | Axes | Proof | Random | Use it when |
//! | --- | --- | --- | --- | --- |
//! | [`Sweep`] | one | yes | no | the steps are few enough to evaluate each once, or evaluating just beside the last place is cheap |
//! | [`CertifiedSearch`] | any | as far as your evaluations go | no | evaluations take long and you want a good value early and to know how sure it is; the first choice in one axis |
//! | [`LocalMutation`] | any | no | yes | several axes, evaluations take long |
//! | [`ControlledRandomSearch`] | any | no | yes | several axes, many basins |
//! | [`PatternSearch`] | any, even of different kinds | no | only its start places | settings of several kinds; or to improve what another method found |
//!
//! All take the same [`Cost`], [`Bounds`] and [`Stopping`] rules and give the same kind of [`Minimum`]. Their known
//! [`Steps`] can be handed from one to the next (`minimise_with`): a random search, say, and a [`CertifiedSearch`] to
//! finish, which does not evaluate again what the first has seen:
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
//! * A step is half-open, `[lo, hi)` on each axis, because comparisons are: `x < t` changes exactly at `t`. Known
//!   steps are looked up exactly, to the last bit, so that the next step can be asked for at `hi`.
//! * A cost that knows no step says [`Step::Point`]; [`from_fn`] and [`from_line`] wrap such functions.
//! * The random generator is passed in; the same generator with the same seed gives the same trace. This crate turns
//!   its 64-bit words into places itself, so that an update of `rand` changes nothing as long as the words stay the
//!   same.
//! * Values and lower bounds are kept apart: what is known to be *at least* so much is never reported as a value, nor
//!   taken for one by a method that compares values.
//! * Several places are evaluated at once only in groups of a size that you set (`batch`), never by the number of
//!   threads: so the result does not depend on how many there are.
//!
//! # Accuracy
//!
//! A reported value is one that the cost returned, never computed from others, and it was returned for a step that
//! contains the reported `x`. Values are compared exactly; a cost that is noisy is not a staircase. A certificate is
//! as right as the steps and bounds the cost tells; where they contradict each other, that is found and is an error.
//!
//! # Errors and panics
//!
//! Bounds and parameters that do not fit give a [`BoundsError`] or [`SearchError`] with the offending values. A cost
//! that returns NaN, an infinity, a step that does not contain `x` or contradicts a known one, or a lower bound that
//! contradicts a value gives a [`CostError`] that names `x`. Nothing panics unless the cost itself does.
//!
//! # Limitations
//!
//! * Only [`Sweep`] and [`CertifiedSearch`] look for a proof. The others prove their result only by chance, in one
//!   axis, when they have met every step.
//! * In many axes the number of steps grows beyond what can be evaluated, and with it what a certificate costs.
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
