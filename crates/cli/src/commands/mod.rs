//! One file per command.

pub mod calibrate;
pub mod eval;
pub mod extract;
pub mod info;
#[cfg(feature = "parquet")]
pub mod merge;
pub mod reproduce;
pub mod synth;
pub mod tune;
