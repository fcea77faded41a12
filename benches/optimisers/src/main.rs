//! How many evaluations several optimisers need on staircase-shaped costs.
//!
//! See the README of this package for what is counted and how.

// Values are compared as given; a test has no caller to report to.
#![cfg_attr(test, allow(clippy::float_cmp, clippy::unwrap_used))]
#![allow(clippy::format_push_string)]

mod comparison;
mod families;
mod methods;
mod problem;
mod recorded;
mod recorder;
mod table;

use std::error::Error;
use std::fs;
use std::path::PathBuf;
use std::time::Instant;

use clap::Parser;
use comparison::Row;
use serde::Serialize;

/// Compares optimisers on staircase-shaped costs and prints a table in Markdown.
#[derive(Debug, Parser)]
struct Arguments {
    /// Runs of each method on each cost
    #[arg(long, default_value_t = 100, value_parser = clap::value_parser!(u64).range(1..))]
    seeds: u64,
    /// Most evaluations of a run, for each axis
    #[arg(long, default_value_t = 2000, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    cap: u64,
    /// Folder of recorded staircases in JSON, compared after the test functions
    #[arg(long, value_name = "DIR")]
    staircases: Option<PathBuf>,
    /// Only the recorded staircases, no test functions
    #[arg(long, requires = "staircases")]
    recorded_only: bool,
    /// Print recorded staircases of one scene together, not one by one
    #[arg(long, requires = "recorded_only")]
    pooled: bool,
    /// A line for each cost and a column for each method, with fewer numbers
    #[arg(long)]
    wide: bool,
    /// Only costs whose name contains this
    #[arg(long, value_name = "TEXT")]
    only: Option<String>,
    /// Also write the results of every seed to this file
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

#[derive(Serialize)]
struct Report<'r> {
    seeds: u64,
    evaluations_per_axis: u64,
    rows: &'r [Row],
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments = Arguments::parse();
    let cap = usize::try_from(arguments.cap)?;
    let mut problems = if arguments.recorded_only { Vec::new() } else { problem::test_functions()? };
    if let Some(folder) = &arguments.staircases {
        problems.extend(recorded::staircases(folder)?);
    }
    if let Some(text) = &arguments.only {
        problems.retain(|problem| problem.name.contains(text));
    }

    if problems.is_empty() {
        return Err("there is no such cost".into());
    }

    let methods = methods::all();
    let mut rows = Vec::new();
    for problem in &problems {
        let start = Instant::now();
        for method in methods.iter().filter(|method| method.takes(problem.dimension)) {
            rows.push(Row::measure(problem, &**method, arguments.seeds, cap)?);
        }
        eprintln!("{}, {} axes: {:.1} s", problem.name, problem.dimension, start.elapsed().as_secs_f64());
    }

    let table = if arguments.wide { table::wide } else { table::markdown };
    print!("{}", if arguments.pooled { families::report(&rows, table) } else { table(&rows) });
    if let Some(file) = &arguments.json {
        let report = Report { seeds: arguments.seeds, evaluations_per_axis: arguments.cap, rows: &rows };
        fs::write(file, serde_json::to_string(&report)? + "\n")
            .map_err(|error| format!("{}: {error}", file.display()))?;
    }
    Ok(())
}
