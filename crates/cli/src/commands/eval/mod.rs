//! `terrace eval`: how well found labels agree with true ones.

mod compare;
mod error;
mod inputs;
mod record;
mod table;

use std::path::Path;

use serde_json::Value;
use terrace_eval::Measure;
use terrace_io::{WriteError, WriteErrorKind, write_atomically};

use crate::error::CliError;
use crate::eval_args::EvalArgs;
use compare::{Compared, Pair, compare, pairs};

/// A pair that could not be compared.
struct Skipped<'a> {
    pair: &'a Pair<'a>,
    reason: String,
}

/// Compares the pairs; one that cannot be is reported, and the rest go on.
pub fn run(args: &EvalArgs) -> Result<(), CliError> {
    let pairs = pairs(args)?;
    let (mut compared, mut skipped) = (Vec::new(), Vec::new());
    for pair in &pairs {
        match compare(pair, &args.field) {
            Ok(one) => compared.push(one),
            Err(error) => {
                eprintln!("terrace: {error}");
                skipped.push(Skipped { pair, reason: error.to_string() });
            }
        }
    }
    if !compared.is_empty() {
        tell(args, &compared, &skipped)?;
    }
    if skipped.is_empty() {
        Ok(())
    } else {
        Err(CliError::EvalPairs { failed: skipped.len(), pairs: pairs.len() })
    }
}

fn tell(args: &EvalArgs, compared: &[Compared], skipped: &[Skipped]) -> Result<(), CliError> {
    let rows: Vec<Vec<Measure>> = compared.iter().map(Compared::measures).collect();
    let means = Measure::means(&rows);
    let to_stdout = args.json.as_deref() == Some(Path::new("-"));
    if let Some(path) = &args.json {
        let value = record::json(&args.field, compared, &means, skipped);
        if to_stdout {
            outln!("{value:#}");
        } else {
            write(path, &value)?;
        }
    }
    if !to_stdout && !args.quiet {
        out!("{}", table::of_pairs(compared, &means));
        if args.per_plane {
            for (number, one) in compared.iter().enumerate() {
                out!("{}", table::of_planes(number + 1, one));
            }
        }
    }
    Ok(())
}

fn write(path: &Path, value: &Value) -> Result<(), WriteError> {
    write_atomically(path, |out| {
        serde_json::to_writer_pretty(&mut *out, value).map_err(|error| WriteErrorKind::Io(error.into()))?;
        Ok(out.write_all(b"\n")?)
    })
}
