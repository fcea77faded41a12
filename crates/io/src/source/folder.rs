//! Which files of a folder are scans.

use std::cmp::Ordering;
use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};

use super::SourceError;
use crate::depth::DepthImage;
use crate::natural_order;

/// Parts of the names of text and NPY files that hold something else than points.
const NOT_POINTS: [&str; 11] = [
    "pose",
    "traj",
    "odom",
    "groundtruth",
    "label",
    "sigma",
    "intrinsic",
    "calib",
    "times",
    "objects",
    "readme",
];

/// A path that sorts in natural order.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Natural(String);

impl Natural {
    pub(super) fn of(path: &Path) -> Self {
        Self(path.to_string_lossy().into_owned())
    }
}

impl Ord for Natural {
    fn cmp(&self, other: &Self) -> Ordering {
        natural_order(&self.0, &other.0)
    }
}

impl PartialOrd for Natural {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// The files directly in a folder, hidden ones left out, in no order.
pub(super) fn list(folder: &Path) -> Result<Vec<PathBuf>, SourceError> {
    let io = |error| SourceError::Io { path: folder.to_owned(), error };
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).map_err(io)? {
        let path = entry.map_err(io)?.path();
        let hidden = path.file_name().is_some_and(|n| n.to_string_lossy().starts_with('.'));
        if !hidden && path.is_file() {
            files.push(path);
        }
    }
    Ok(files)
}

/// The scans among the files of `place`, in natural order.
pub(super) fn choose(place: &Path, files: Vec<PathBuf>) -> Result<Vec<PathBuf>, SourceError> {
    let (mut clouds, mut tables) = (Vec::new(), Vec::new());
    let seen = files.len();
    for path in files {
        match extension(&path).as_str() {
            "ply" | "pcd" => clouds.push(path),
            "png" if is_depth_image(&path)? => clouds.push(path),
            "npy" | "xyz" | "csv" | "txt" | "asc" | "pts" if !tells_no_points(&path) => tables.push(path),
            _ => {}
        }
    }
    let mut chosen = if clouds.is_empty() { tables } else { clouds };
    if chosen.is_empty() {
        return Err(SourceError::NothingUsable { path: place.to_owned(), files: seen });
    }
    chosen.sort_by_cached_key(|path| Natural::of(path));
    Ok(chosen)
}

/// The extension in lower case, empty when there is none.
pub(crate) fn extension(path: &Path) -> String {
    path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default()
}

fn tells_no_points(path: &Path) -> bool {
    let name = path.file_name().map(|n| n.to_string_lossy().to_lowercase()).unwrap_or_default();
    NOT_POINTS.iter().any(|part| name.contains(part))
}

fn is_depth_image(path: &Path) -> Result<bool, SourceError> {
    let io = |error| SourceError::Io { path: path.to_owned(), error };
    let mut head = Vec::new();
    File::open(path).map_err(io)?.take(26).read_to_end(&mut head).map_err(io)?;
    Ok(DepthImage::is_depth_png(&head))
}
