//! The pipeline from scans to planes.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::float_cmp, reason = "tests")]

mod accuracy;
mod anything;
mod cell_size;
mod common;
mod covariance;
mod curved;
mod degenerate;
mod determinism;
mod incremental;
mod motion;
mod optimisation;
mod params;
mod parts;
mod planes;
mod regions;
mod streaming;
mod tune;
mod weighting;
