//! The terrace program: posed 3D scans in, planes with their uncertainty out.
//!
//! Arguments are turned into calls of the `terrace` library and of `terrace-io`; no algorithm lives here.

// Before those that use its macros.
#[macro_use]
mod output;

mod args;
mod calibrate_args;
mod commands;
mod error;
mod eval_args;
mod extract_args;
#[cfg(feature = "parquet")]
mod merge_args;
mod method_args;
mod picture;
mod progress;
mod report;

use std::process::ExitCode;

use clap::Parser;

use crate::args::{Cli, Command};

/// What shells take for the exit code of a program that was interrupted.
const INTERRUPTED: i32 = 130;

fn main() -> ExitCode {
    let cli = Cli::parse();
    // Without a handler the program ends at once, and what it has half-written stays.
    let handled = ctrlc::set_handler(|| {
        terrace_io::abandon_outputs();
        std::process::exit(INTERRUPTED);
    });
    if let Err(error) = handled {
        eprintln!("terrace: warning: interrupted, it may leave unfinished files: {error}");
    }
    let outcome = match &cli.command {
        Command::Extract(args) => commands::extract::run(args),
        #[cfg(feature = "parquet")]
        Command::Merge(args) => commands::merge::run(args),
        Command::Eval(args) => commands::eval::run(args),
        Command::Calibrate(args) => commands::calibrate::run(args),
        Command::Synth(args) => commands::synth::run(args),
        Command::Info(args) => commands::info::run(args),
        Command::Tune(args) => commands::tune::run(args),
        Command::Reproduce(args) => commands::reproduce::run(args),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("terrace: {error}");
            ExitCode::from(error.exit_code())
        }
    }
}
