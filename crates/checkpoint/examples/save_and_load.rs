//! How large the map of a room is as a file, and how long it takes to save and to read. The argument is the number of points.

use std::time::Instant;

use terrace::{Mapper, Params};
use terrace_checkpoint::{open_map, write_map};
use terrace_synth::Scene;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let points = std::env::args().nth(1).map_or(Ok(300_000), |text| text.parse())?;
    let scene =
        Scene::room().generate(&terrace_synth::Params { points: Some(points), sigma: None, seed: 1 })?;
    let folder = tempfile::tempdir()?;
    for cell_size in [None, Some(0.1)] {
        let mut mapper = Mapper::streaming(Params { cell_size, ..Params::default() })?;
        for scan in &scene.scans {
            mapper.insert(&scan.scan)?;
        }
        let path = folder.path().join("map.parquet");
        let saving = Instant::now();
        write_map(&mapper, std::fs::File::create(&path)?)?;
        let (saved, loading) = (saving.elapsed(), Instant::now());
        let cells = open_map(&path)?.cells();
        let loaded = loading.elapsed();
        let bytes = std::fs::metadata(&path)?.len();
        println!(
            "{points} points in cells of {:.4} m: {cells} rows, {:.1} MB, saved in {:.2} s, read in {:.2} s",
            mapper.cell_size().unwrap_or(f64::NAN),
            bytes as f64 / 1e6,
            saved.as_secs_f64(),
            loaded.as_secs_f64(),
        );
    }
    Ok(())
}
