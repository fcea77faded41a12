//! Scans of the data folder: `TERRACE_DATA`, or `shared/data` beside the repository.

use std::error::Error;
use std::ops::Range;
use std::path::{Path, PathBuf};

use terrace::{Frame, Scan, Sigma};
use terrace_io::{ErrorSource, FieldChoice, Intrinsics, ReadOptions, find_sources, read_scan};
use terrace_noise::Kinect;

/// Why a scan could not be read.
pub type SceneError = Box<dyn Error + Send + Sync>;

/// A file or folder of the data folder; `None` when there is no such one.
pub fn path(name: &str) -> Option<PathBuf> {
    let data = std::env::var_os("TERRACE_DATA")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data"), PathBuf::from);
    Some(data.join(name)).filter(|path| path.exists())
}

/// The points of an NPY file as a scan; none when there is no such file.
///
/// # Errors
/// When the file cannot be read.
pub fn npy(name: &str) -> Result<Vec<Scan>, SceneError> {
    let Some(path) = path(name) else { return Ok(Vec::new()) };
    let cloud = terrace_io::npy::read(&std::fs::read(path)?)?;
    Ok(vec![Scan::new(cloud.points, Sigma::Unknown, Frame::World { sensor: None })?])
}

/// Frames of the posed sequence `sevenscenes`, with the axial error of its sensor along every axis, as `terrace
/// reproduce` takes it; none when it is not there.
///
/// # Errors
/// When a frame cannot be read.
pub fn sevenscenes(frames: Range<usize>) -> Result<Vec<Scan>, SceneError> {
    let Some(folder) = path("sevenscenes") else { return Ok(Vec::new()) };
    let options = ReadOptions {
        intrinsics: Some(Intrinsics::open(&folder.join("camera-intrinsics.txt"))?),
        errors: ErrorSource::FromFile(FieldChoice::Ignore),
        ..ReadOptions::default()
    };
    let sources = find_sources(&[folder], None)?;
    let wanted = sources.iter().skip(frames.start).take(frames.len());
    let kinect = Kinect::default();
    let with_errors = |scan: Scan| {
        let sigma = |point: &[f64; 3]| kinect.axial(point[2], None).unwrap_or(f64::NAN);
        let sigmas = scan.points().iter().map(sigma).collect();
        scan.with_sigma(Sigma::PerPoint(sigmas))
    };
    wanted.map(|source| Ok(with_errors(read_scan(source, &options)?)?)).collect()
}
