//! Are the covariances of planes right? Monte-Carlo on known planes, and scan against scan on real ones.

mod deviation;
mod error;
mod interior;
mod known;
mod monte_carlo;

pub use deviation::Deviation;
pub use error::TrialError;
pub use known::{KnownPlace, KnownPlane, PointNoise};
pub use monte_carlo::{MAJORITY, Outcome, PURE, Trials};
