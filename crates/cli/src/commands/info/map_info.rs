//! What a saved map holds.

use std::path::Path;

use terrace::{Mapper, Params, StreamingError};
use terrace_checkpoint::{MapFileError, open_map};

use super::aligned;
use crate::error::CliError;

/// Reads a map, which checks all of it, and tells what it holds.
pub fn told(path: &Path) -> Result<String, CliError> {
    let refused = |error: MapFileError| CliError::MapFile { path: path.to_owned(), error };
    let map = open_map(path).map_err(refused)?;
    Ok(text(&map, bounds(&map)?))
}

fn text(map: &Mapper, bounds: Option<[[f64; 3]; 2]>) -> String {
    let sum = |of: fn(&terrace::View) -> usize| map.views().iter().map(of).sum::<usize>();
    let Params { regions, .. } = map.params();
    let planes = if regions.is_some() { "regions" } else { "clusters" };
    let mut lines = vec![
        ("format", format!("a map of terrace as Parquet, for {planes}")),
        ("inputs", map.views().len().to_string()),
        ("points", map.len().to_string()),
        ("absent", format!("{} (not finite)", sum(|view| view.absent))),
        ("left out", format!("{} (too far away)", sum(|view| view.out_of_range))),
    ];
    if let (Some(size), Some(edge)) = (map.cell_size(), map.edge()) {
        let chosen = map.chosen_cell_size().map_or("given", |_| "chosen from the first input");
        lines.push(("cell size", format!("{size} m, {chosen}")));
        lines.push(("cells", format!("{} of {edge} m", map.cells())));
    }
    if let Some([min, max]) = bounds {
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            let (lo, hi) = (min[axis], max[axis]);
            lines.push((name, format!("{lo:.4} to {hi:.4} m ({:.4} m), by cells", hi - lo)));
        }
    }
    let sensors = map.views().iter().filter(|view| view.sensor.is_some()).count();
    let poses = map.views().iter().filter(|view| view.pose.is_some()).count();
    lines.push(("sigma", if map.knows_errors() { "in the map" } else { "not in the map" }.to_owned()));
    lines.push(("sensors", format!("{sensors} known, {poses} with uncertain poses")));
    aligned(lines)
}

/// Where cells begin and end, in metres.
fn bounds(map: &Mapper) -> Result<Option<[[f64; 3]; 2]>, StreamingError> {
    let Some(edge) = map.edge() else { return Ok(None) };
    let parts = map.parts()?;
    let keys = parts.cells().map(|cell| [cell.key, cell.key]);
    let all = keys.reduce(|[low, high], [key, _]| {
        [[0, 1, 2].map(|i| low[i].min(key[i])), [0, 1, 2].map(|i| high[i].max(key[i]))]
    });
    let metres = |[low, high]: [[i32; 3]; 2]| {
        [low.map(|k| f64::from(k) * edge), high.map(|k| (f64::from(k) + 1.0) * edge)]
    };
    Ok(all.map(metres))
}
