//! The stages of an extraction, as they are told and timed.

use std::time::Instant;

use terrace::{ExtractError, Stage};
use terrace_io::planes_json::Timings;

use crate::error::CliError;
use crate::progress::Progress;

/// Extracts the planes, with the time of each stage.
///
/// # Errors
/// [`CliError`] when the map is empty.
pub fn extract_timed<T>(
    extract: impl FnOnce(&mut dyn FnMut(Stage)) -> Result<T, ExtractError>,
    progress: &mut Progress,
    timings: &mut Timings,
) -> Result<T, CliError> {
    let mut marks = Vec::new();
    let extracted = extract(&mut |stage| {
        let what = match stage {
            Stage::Normals { cells } => format!("normals of {cells} cells"),
            Stage::Grow { cells } => format!("growing regions over {cells} cells"),
            Stage::Cluster { cells } => format!("clustering {cells} cells"),
            Stage::Optimise { clusters } => format!("optimising {clusters} uncertain clusters"),
            Stage::Label { points } => format!("planes of {points} points"),
        };
        progress.spin(&what);
        marks.push((stage, Instant::now()));
    })?;
    let ends = marks.iter().skip(1).map(|(_, begin)| *begin).chain([Instant::now()]);
    for ((stage, begin), end) in marks.iter().zip(ends) {
        let slot = match stage {
            Stage::Normals { .. } => &mut timings.normals,
            Stage::Grow { .. } => timings.grow.get_or_insert(0.0),
            Stage::Cluster { .. } => &mut timings.cluster,
            Stage::Optimise { .. } => &mut timings.optimise,
            Stage::Label { .. } => &mut timings.label,
        };
        *slot = (end - *begin).as_secs_f64();
    }
    Ok(extracted)
}
