//! Are the covariances of planes right? Monte-Carlo on known planes, and scan against scan on real ones.

mod against;
mod deviation;
mod error;
mod interior;
mod known;
mod monte_carlo;

pub use against::{
    Agreement, Look, PlaneAgreement, Ratio, Reference, Residual, Scatter, Sighting, scans_against_each_other,
};
pub use deviation::Deviation;
pub use error::TrialError;
pub use known::{KnownPlace, KnownPlane, PointNoise};
pub use monte_carlo::{MAJORITY, Outcome, PURE, Trials};
