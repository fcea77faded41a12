//! Several thresholds at once, over a whole map: cell size, depth, τ, ω and φ. The paper's outlook.
//!
//! A [`Tuner`] holds the scans and what is to become small, an [`Objective`]; a [`TuneSpace`] says which settings come
//! into question; the two make a [`TuneCost`], which is searched ([`TuneCost::tune`]) and cut through
//! ([`TuneCost::slice`]).
//!
//! The cost is a staircase in all five settings: a clustering is a list of comparisons, of densities with τ, of
//! uncertainties with ω, of distances with φ, so each evaluation tells a box of settings that make the same decisions
//! ([`TuneStep`]). What the boxes met so far cover is never evaluated again.
//!
//! Maps are made without a search for the φ of single clusters ([`Params::optimise`](crate::Params::optimise)): here φ
//! is one for all.

mod cost;
mod error;
mod gridded;
mod objective;
mod prepared;
mod roundest;
mod search;
mod settings;
mod slice;
mod space;
mod tuner;

pub use cost::TuneCost;
pub use error::TuneError;
pub use objective::{Objective, Quality, TrueLabel};
pub use search::{TuneProgress, TuneSearch, TuneTrial, Tuned};
pub use settings::{Settings, TuneAxis, TuneStep};
pub use slice::SliceStep;
pub use space::TuneSpace;
pub use tuner::Tuner;
