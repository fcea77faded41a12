//! repro
use crate::args::ReproduceArgs;
use crate::error::CliError;
/// x
pub fn run(_args: &ReproduceArgs) -> Result<(), CliError> {
    Ok(())
}
