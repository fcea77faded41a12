//! Labelled scenes that are simulated, or get their noise here.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use terrace::PlaneId;
use terrace_io::{ReadOptions, find_sources, npy, read_scan};
use terrace_noise::SensorNoise;
use terrace_synth::{Params, Scene, perturbed, stated};

use crate::labelled::{Labelled, TruePlane};
use crate::scenes::SceneError;

const LIDAR: &str = "lidar:range=0.02,angle=0rad";
const SEED: u64 = 1;

/// The furnished room, with the errors of its camera.
pub(super) fn room(points: usize) -> Result<Labelled, SceneError> {
    let made = Scene::room().generate(&Params { points: Some(points), ..Params::default() })?;
    let (mut scans, mut truth) = (Vec::new(), Vec::new());
    for view in made.scans {
        truth.extend(view.labels.into_iter().map(PlaneId::label));
        scans.push(view.scan);
    }
    let named = |p: terrace_synth::TruePlane| (p.id, TruePlane { name: p.name.to_owned(), plane: p.plane });
    Ok(Labelled { scans, truth, planes: made.planes.into_iter().map(named).collect() })
}

/// The scans of a simulated lidar at their poses, with noise along each ray, which is stated.
pub(super) fn balm(folder: &Path) -> Result<Labelled, SceneError> {
    let lidar: SensorNoise = LIDAR.parse()?;
    let (mut scans, mut truth) = (Vec::new(), Vec::new());
    let sources = find_sources(&[folder.join("scan_*.ply")], Some(&folder.join("poses.txt")))?;
    for (stream, source) in (0..).zip(sources) {
        let exact = read_scan(&source, &ReadOptions::default())?;
        let noisy = perturbed(&stated(&exact, &lidar, None)?, SEED, stream);
        scans.push(stated(&noisy, &lidar, None)?);
        truth.extend(npy::read_labels(&fs::read(source.path.with_extension("labels.npy"))?)?);
    }
    Ok(Labelled { scans, truth, planes: BTreeMap::new() })
}
