//! Helpers of the whole-program benches: what a process has used so far, read from `/proc` of Linux, labelled scenes, counts of
//! instructions.

pub mod ablation;
pub mod beyond;
pub mod export;
pub mod instructions;
pub mod labelled;
pub mod overlap;
pub mod peers;
pub mod pictures;
pub mod scenes;
mod score;
mod usage;

pub use score::{Score, value};
pub use usage::{Usage, UsageError};
