//! Labelled scenes from files.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use serde_json::Value;
use terrace::{Frame, Plane, PlaneId, Scan, Sigma};
use terrace_io::{FieldChoice, natural_order, npy, ply as ply_format};

use crate::labelled::{Labelled, TruePlane};
use crate::scenes::{self, SceneError};

const LABELS: &str = ".labels.npy";
/// The greatest number of an object in `mosd` that is the table.
const LAST_TABLE: i32 = 9;

/// The scenes `NAME.labels.npy` with `NAME.ply` of a folder, in natural order; none without the folder.
pub(super) fn labelled(folder: &str) -> Result<Vec<String>, SceneError> {
    let Some(folder) = scenes::path(folder) else { return Ok(Vec::new()) };
    let mut names = Vec::new();
    for file in fs::read_dir(&folder)? {
        let file = file?.file_name();
        let stem = file.to_str().and_then(|name| name.strip_suffix(LABELS));
        names.extend(stem.filter(|s| folder.join(format!("{s}.ply")).is_file()).map(str::to_owned));
    }
    names.sort_by(|a, b| natural_order(a, b));
    Ok(names)
}

/// A folder of `points.npy`, `labels.npy`, `sigma.npy` and `planes.json`, the last two of which may be missing.
pub(super) fn arrays(folder: &Path, at_origin: bool) -> Result<Labelled, SceneError> {
    let points = npy::read(&fs::read(folder.join("points.npy"))?)?.points;
    let sigma = folder.join("sigma.npy");
    let sigma =
        if sigma.is_file() { Sigma::PerPoint(npy::read_scalars(&fs::read(sigma)?)?) } else { Sigma::Unknown };
    let planes = folder.join("planes.json");
    Ok(Labelled {
        scans: vec![Scan::new(points, sigma, world(at_origin))?],
        truth: npy::read_labels(&fs::read(folder.join("labels.npy"))?)?,
        planes: if planes.is_file() { true_planes(&fs::read(planes)?)? } else { BTreeMap::new() },
    })
}

/// A PLY file with `NAME.labels.npy` beside it. What lies on the table is left out where that is asked for, by
/// `NAME.objects.npy`.
pub(super) fn ply(path: &Path, table_only: bool, at_origin: bool) -> Result<Labelled, SceneError> {
    let cloud = ply_format::read(&fs::read(path)?, &FieldChoice::Automatic)?;
    let mut truth = npy::read_labels(&fs::read(path.with_extension("labels.npy"))?)?;
    if table_only {
        let objects = npy::read_labels(&fs::read(path.with_extension("objects.npy"))?)?;
        for (label, _) in truth.iter_mut().zip(objects).filter(|(_, object)| *object > LAST_TABLE) {
            *label = -1;
        }
    }
    let scan = Scan::new(cloud.points, cloud.sigma, world(at_origin))?;
    Ok(Labelled { scans: vec![scan], truth, planes: BTreeMap::new() })
}

fn world(at_origin: bool) -> Frame {
    Frame::World { sensor: at_origin.then_some([0.0; 3]) }
}

/// Planes `normal . x = offset` by number.
fn true_planes(json: &[u8]) -> Result<BTreeMap<PlaneId, TruePlane>, SceneError> {
    let by_number: BTreeMap<u32, Value> = serde_json::from_slice(json)?;
    let mut planes = BTreeMap::new();
    for (number, value) in by_number {
        let normal: [f64; 3] = serde_json::from_value(value["normal"].clone())?;
        let offset: f64 = serde_json::from_value(value["offset"].clone())?;
        let length_squared: f64 = normal.iter().map(|x| x * x).sum();
        let plane = Plane::through(normal.map(|x| x * offset / length_squared), normal)?;
        let name = value["name"].as_str().unwrap_or_default().to_owned();
        planes.extend(PlaneId::new(number).map(|id| (id, TruePlane { name, plane })));
    }
    Ok(planes)
}
