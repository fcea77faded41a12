//! Which pose belongs to which scan.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use terrace_types::Pose;

use super::{Found, Order, Source, SourceError, folder};
use crate::natural::last_number;
use crate::trajectory::{self, Trajectory};

/// Farthest a time stamp in a file name may be from that of its pose, in seconds: two thirds of a frame at 30 Hz.
pub const MAX_STAMP_DISTANCE: f64 = 0.02;

/// Poses from files `NAME.pose.txt` beside the scans.
pub(super) fn beside(scans: Vec<PathBuf>) -> Result<Vec<Source>, SourceError> {
    let mut sources = Vec::with_capacity(scans.len());
    for path in scans {
        let sidecar = pose_file_beside(&path);
        let pose = if sidecar.is_file() { Some(only_pose(&sidecar)?) } else { None };
        sources.push(Source { pose, ..Source::new(path) });
    }
    let is_image = |s: &&Source| folder::extension(&s.path) == "png";
    if sources.iter().filter(is_image).any(|s| s.pose.is_some())
        && let Some(bare) = sources.iter().filter(is_image).find(|s| s.pose.is_none())
    {
        return Err(SourceError::PoseMissing { path: bare.path.clone() });
    }
    Ok(sources)
}

/// Poses from one file for all scans.
pub(super) fn from_file(scans: Vec<PathBuf>, file: &Path) -> Result<Found, SourceError> {
    let trajectory = trajectory::open(file)?;
    let count = trajectory.poses.len();
    let of_scan = if count == scans.len() {
        (0..count).collect()
    } else if let Some(indices) = by_time(&scans, &trajectory, file)? {
        indices
    } else {
        by_index(&scans, count, file)?
    };
    let poses = of_scan.iter().map(|index| trajectory.poses.get(*index).map(|p| p.pose));
    let sources = scans.into_iter().zip(poses).map(|(path, pose)| Source { pose, ..Source::new(path) });
    Ok(Found { sources: sources.collect(), order: Some(Order { poses: count, of_scan }) })
}

/// Poses from a folder with a file for each scan, matched by the last number in the names.
pub(super) fn from_folder(scans: Vec<PathBuf>, place: &Path) -> Result<Vec<Source>, SourceError> {
    let mut files = folder::list(place)?;
    // Where scans and poses share a folder, the name tells which are poses.
    let is_named = |path: &PathBuf| stem(path).to_lowercase().contains("pose");
    if files.iter().any(is_named) {
        files.retain(is_named);
    }
    let mut numbered: BTreeMap<u64, Vec<PathBuf>> = BTreeMap::new();
    for path in files {
        if let Some(number) = last_number(&stem(&path)) {
            numbered.entry(number).or_default().push(path);
        }
    }
    let mut sources = Vec::with_capacity(scans.len());
    for path in scans {
        let found = last_number(&stem(&path)).and_then(|number| numbered.get(&number));
        let found = found.map_or(&[][..], Vec::as_slice);
        let [file] = found else {
            return Err(SourceError::NoPoseForNumber {
                path: place.to_owned(),
                scan: path,
                found: found.len(),
            });
        };
        let pose = Some(only_pose(file)?);
        sources.push(Source { pose, ..Source::new(path) });
    }
    Ok(sources)
}

/// The index of the pose nearest to the time in each name; `None` when poses or names have no time stamps.
fn by_time(
    scans: &[PathBuf],
    trajectory: &Trajectory,
    file: &Path,
) -> Result<Option<Vec<usize>>, SourceError> {
    let stamps: Option<Vec<f64>> = scans.iter().map(|path| time_stamp(&stem(path))).collect();
    let timed: Option<Vec<(f64, usize)>> =
        trajectory.poses.iter().zip(0..).map(|(p, index)| Some((p.time?, index))).collect();
    let (Some(stamps), Some(mut timed)) = (stamps, timed) else { return Ok(None) };
    timed.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut indices = Vec::with_capacity(scans.len());
    for (stamp, scan) in stamps.into_iter().zip(scans) {
        let after = timed.partition_point(|(time, _)| *time < stamp);
        let neighbours =
            [after.checked_sub(1), Some(after)].into_iter().flatten().filter_map(|i| timed.get(i));
        let nearest =
            neighbours.map(|(time, index)| ((time - stamp).abs(), *index)).min_by(|a, b| a.0.total_cmp(&b.0));
        match nearest {
            Some((distance, index)) if distance <= MAX_STAMP_DISTANCE => indices.push(index),
            other => {
                let distance = other.map_or(f64::INFINITY, |(distance, _)| distance);
                return Err(SourceError::NoPoseAtTime {
                    path: file.to_owned(),
                    scan: scan.clone(),
                    distance,
                });
            }
        }
    }
    Ok(Some(indices))
}

/// The index of a pose, from 0, that is the last number in each name.
fn by_index(scans: &[PathBuf], poses: usize, file: &Path) -> Result<Vec<usize>, SourceError> {
    let mut taken = vec![false; poses];
    let mut indices = Vec::with_capacity(scans.len());
    for scan in scans {
        let index = last_number(&stem(scan)).and_then(|n| usize::try_from(n).ok()).unwrap_or(usize::MAX);
        match taken.get_mut(index) {
            Some(taken) if !*taken => {
                *taken = true;
                indices.push(index);
            }
            _ => {
                return Err(SourceError::CountMismatch {
                    path: file.to_owned(),
                    poses,
                    scans: scans.len(),
                    scan: scan.clone(),
                });
            }
        }
    }
    Ok(indices)
}

fn only_pose(file: &Path) -> Result<Pose, SourceError> {
    match trajectory::open(file)?.poses.as_slice() {
        [only] => Ok(only.pose),
        poses => Err(SourceError::NotOnePose { path: file.to_owned(), count: poses.len() }),
    }
}

fn pose_file_beside(scan: &Path) -> PathBuf {
    let name = stem(scan);
    let name = name.strip_suffix(".depth").unwrap_or(&name);
    scan.with_file_name(format!("{name}.pose.txt"))
}

/// The file name without its last extension.
fn stem(path: &Path) -> String {
    path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default()
}

/// The time in a name that is nothing else: seconds with a decimal point, or nanoseconds of 18 digits and more.
fn time_stamp(name: &str) -> Option<f64> {
    let digits = |text: &str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
    match name.split_once('.') {
        Some((whole, fraction)) if digits(whole) && digits(fraction) => name.parse().ok(),
        None if digits(name) && name.len() >= 18 => {
            name.parse::<f64>().ok().map(|nanoseconds| nanoseconds * 1e-9)
        }
        _ => None,
    }
}
