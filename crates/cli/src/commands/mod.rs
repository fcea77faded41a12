//! One file per command.

pub mod calibrate;
pub mod eval;
pub mod extract;
pub mod info;
pub mod reproduce;
pub mod synth;
pub mod tune;
