//! Scenes as files that any program reads, for the comparison with others in `benches/peers`.

use std::fs::{self, File};
use std::io::BufWriter;
use std::path::Path;

use npyz::{AutoSerialize, WriterBuilder};
use serde_json::json;
use terrace::Scan;

use crate::labelled::{Entry, Labelled};
use crate::scenes::SceneError;
use crate::{Score, value};

/// Writes a folder with the name of the scene: `points.npy` in world coordinates, its true labels `truth.npy` and those found
/// here, `terrace.npy`, all without the points that a sensor did not measure; and `terrace.json` with what finding them
/// took.
///
/// # Errors
/// When a file cannot be written.
pub fn write(folder: &Path, entry: &Entry, scene: &Labelled, score: &Score) -> Result<(), SceneError> {
    let folder = folder.join(&entry.name);
    fs::create_dir_all(&folder)?;
    let places: Vec<Option<[f64; 3]>> =
        scene.scans.iter().flat_map(Scan::world_points).map(|point| Some(point?.position)).collect();
    let present = |labels: &[i32]| {
        let labels = labels.iter().zip(&places).filter(|(_, place)| place.is_some());
        labels.map(|(label, _)| *label).collect::<Vec<i32>>()
    };
    let points: Vec<f64> = places.iter().flatten().flatten().copied().collect();
    let truth = present(&scene.truth);
    let count = truth.len() as u64;
    array(&folder.join("points.npy"), &points, &[count, 3])?;
    array(&folder.join("truth.npy"), &truth, &[count])?;
    array(&folder.join("terrace.npy"), &present(&score.found), &[count])?;
    let costs = json!({
        "name": entry.name,
        "group": if entry.group.is_empty() { &entry.name } else { entry.group },
        "points": count,
        "cpu_seconds": value(&score.measures, "cpu_seconds"),
        "clock_seconds": value(&score.measures, "clock_seconds"),
        "peak_mb": value(&score.measures, "peak_mib"),
    });
    Ok(fs::write(folder.join("terrace.json"), costs.to_string())?)
}

fn array<T: AutoSerialize + Copy>(path: &Path, values: &[T], shape: &[u64]) -> Result<(), SceneError> {
    let file = BufWriter::new(File::create(path)?);
    let mut array = npyz::WriteOptions::new().default_dtype().shape(shape).writer(file).begin_nd()?;
    array.extend(values.iter().copied())?;
    Ok(array.finish()?)
}
