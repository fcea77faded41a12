//! `terrace reproduce`: section VI of the paper again.

mod assumptions;
mod runs;
mod sequence;
mod synthetic;

use crate::args::ReproduceArgs;
use crate::error::CliError;

/// Table I and Figure 1, with `--data` Table II and Figures 3 and 4 as well, and what had to be assumed.
pub fn run(args: &ReproduceArgs) -> Result<(), CliError> {
    synthetic::run(args)?;
    if let Some(data) = &args.data {
        sequence::run(args, data)?;
    }
    out!("{}", assumptions::TEXT);
    Ok(())
}
