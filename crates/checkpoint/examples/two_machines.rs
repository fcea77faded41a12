//! Two halves of a room become maps on their own, are saved, and make the map of the room.

use terrace::{Mapper, Params};
use terrace_checkpoint::{read_map, write_map};
use terrace_synth::Scene;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let points = terrace_synth::Params { points: Some(200_000), sigma: None, seed: 1 };
    let scans = Scene::room().generate(&points)?.scans;
    // Parts have cells in common only where these are of the same size.
    let params = Params { cell_size: Some(0.1), ..Params::default() };

    let mut files = Vec::new();
    for half in scans.chunks(scans.len() / 2) {
        let mut mapper = Mapper::streaming(params)?;
        for scan in half {
            mapper.insert(&scan.scan)?;
        }
        let mut file = Vec::new();
        write_map(&mapper, &mut file)?;
        println!("{} cells of {} points: {} bytes", mapper.cells(), mapper.len(), file.len());
        files.push(file);
    }

    let mut room = Mapper::streaming(params)?;
    for file in files {
        room.merge(&read_map(file)?)?;
    }
    let map = room.extract()?;
    println!("{} cells of {} points: {} planes", room.cells(), room.len(), map.planes.len());
    Ok(())
}
