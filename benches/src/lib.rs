//! Helpers of the whole-program benches: what a process has used so far, read from `/proc` of Linux.

pub mod scenes;
mod usage;

pub use usage::{Usage, UsageError};
