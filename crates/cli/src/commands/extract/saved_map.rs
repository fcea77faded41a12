//! Maps into files.

use std::io;
use std::path::Path;
use std::time::Instant;

use terrace::Mapper;
use terrace_checkpoint::write_map;
use terrace_io::planes_json::Timings;
use terrace_io::write_atomically;

use crate::error::CliError;
use crate::progress::Progress;

/// Writes a map; a damaged file is never left behind.
///
/// # Errors
/// [`CliError::Write`] when the map cannot be saved or the file not be written.
pub fn save_map(
    mapper: &Mapper,
    path: &Path,
    progress: &mut Progress,
    timings: &mut Timings,
) -> Result<(), CliError> {
    let writing = Instant::now();
    progress.spin("writing the map");
    write_atomically(path, |out| Ok(write_map(mapper, out).map_err(io::Error::other)?))?;
    timings.write += writing.elapsed().as_secs_f64();
    Ok(())
}
