//! Which files to read, in which order, and where the sensor stood: from what a user names to a list of scans.
//!
//! **Inputs** are files, folders, or patterns (`*`, `?`, `[...]`). What exists under its literal name is taken before it
//! is tried as a pattern. A file named is taken as it is. Of a folder, and of the files that match a pattern:
//!
//! 1. 16-bit grey PNG (depth; colour images are passed over), PLY and PCD, if there is any of them;
//! 2. otherwise NPY, XYZ, CSV, TXT, ASC and PTS, without those whose name tells poses, labels, σ, intrinsics or notes.
//!
//! Hidden files and folders within are passed over; order is natural, so that `scan2` stands before `scan10`.
//!
//! **Poses.** Without a file of poses, `NAME.pose.txt` beside `NAME.depth.png`, `NAME.png` or any other scan of that
//! name is its pose (7-Scenes); when some depth image of the inputs has one, each must have one. With a file of poses,
//! the first of these that applies:
//!
//! 1. as many poses as scans: in order;
//! 2. the poses have time stamps and each scan is named by one (`1305031102.175304.png`, or 18 digits and more of
//!    nanoseconds): the nearest pose, at most [`MAX_STAMP_DISTANCE`] away;
//! 3. the last number in the name of the scan is the index of its pose, from 0 (`full16.pcd`).
//!
//! With a folder of poses, one in each file, the last number in the names tells which belong together.
//!
//! **Noise of poses**, a file with a row for each pose ([`pose_noise`]): as many rows as poses in the
//! file of poses belong to these, row by row; otherwise there must be as many as scans, and they are in order.

mod folder;
mod poses;

use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};

use terrace_noise::PoseNoise;
use terrace_types::Pose;

use crate::FileError;
use crate::pose_noise::{self, PoseNoiseTextError};
use crate::trajectory::TrajectoryError;

pub(crate) use folder::extension;
pub use poses::MAX_STAMP_DISTANCE;

/// A scan to be read.
#[derive(Debug, Clone, PartialEq)]
pub struct Source {
    /// The file.
    pub path: PathBuf,
    /// The pose of the sensor, when one was found outside the file.
    pub pose: Option<Pose>,
    /// How sure the pose is; `None` when that was not told.
    pub pose_noise: Option<PoseNoise>,
}

impl Source {
    /// A file whose pose is not known, or is in the file itself.
    pub fn new(path: impl Into<PathBuf>) -> Self {
        Self { path: path.into(), pose: None, pose_noise: None }
    }
}

/// Why no list of scans could be made.
#[derive(Debug, thiserror::Error)]
pub enum SourceError {
    /// No input was given.
    #[error("no input was given")]
    NoInput,
    /// There is no such file or folder, and as a pattern it matches nothing.
    #[error("{}: no such file or folder, and no pattern that matches any", path.display())]
    NotFound {
        /// The input as given.
        path: PathBuf,
    },
    /// The folder, or the matches of the pattern, hold nothing that looks like a scan.
    #[error(
        "{}: no scan found (16-bit depth PNG, PLY, PCD, or else NPY, XYZ, CSV, TXT, ASC, PTS); {files} other files passed over",
        path.display()
    )]
    NothingUsable {
        /// The folder or pattern.
        path: PathBuf,
        /// Files seen there.
        files: usize,
    },
    /// The pattern is malformed.
    #[error("{}: not a pattern: {message}", path.display())]
    Pattern {
        /// The input as given.
        path: PathBuf,
        /// What is wrong with it.
        message: String,
    },
    /// A file or folder cannot be looked at.
    #[error("{}: {error}", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What the system says.
        error: io::Error,
    },
    /// A file of poses is damaged.
    #[error(transparent)]
    Poses(#[from] FileError<TrajectoryError>),
    /// A file with the noise of poses is damaged.
    #[error(transparent)]
    PoseNoise(#[from] FileError<PoseNoiseTextError>),
    /// The rows of a file with the noise of poses are neither as many as the scans nor as many as the poses.
    #[error(
        "{}: {rows} rows for {scans} scans{}: give a row for each", path.display(),
        poses.map_or_else(String::new, |poses| format!(" with {poses} poses"))
    )]
    PoseNoiseCount {
        /// The file.
        path: PathBuf,
        /// Rows in it.
        rows: usize,
        /// Number of scans.
        scans: usize,
        /// Number of poses, when they are in one file.
        poses: Option<usize>,
    },
    /// A file that should hold the pose of one scan holds several.
    #[error("{}: holds {count} poses where the one of a single scan was expected", path.display())]
    NotOnePose {
        /// The file of poses.
        path: PathBuf,
        /// Poses in it.
        count: usize,
    },
    /// Some depth images have a pose beside them, this one has none.
    #[error("{}: has no .pose.txt beside it, unlike others of the sequence", path.display())]
    PoseMissing {
        /// The scan.
        path: PathBuf,
    },
    /// Poses and scans differ in number, and the names of the scans do not tell which pose is theirs.
    #[error(
        "{}: {poses} poses for {scans} scans, and the name of {} does not tell which is its own: \
         give as many, or number the files from 0 by their poses",
        path.display(), scan.display()
    )]
    CountMismatch {
        /// The file of poses.
        path: PathBuf,
        /// Number of poses.
        poses: usize,
        /// Number of scans.
        scans: usize,
        /// The first scan without a pose of its own.
        scan: PathBuf,
    },
    /// There is no pose near the time in the name of the scan.
    #[error(
        "{}: no pose within {MAX_STAMP_DISTANCE} s of {} (the nearest is {distance} s away)",
        path.display(), scan.display()
    )]
    NoPoseAtTime {
        /// The file of poses.
        path: PathBuf,
        /// The scan.
        scan: PathBuf,
        /// Seconds to the nearest pose.
        distance: f64,
    },
    /// The folder of poses holds none with the number of the scan, or more than one.
    #[error("{}: {found} files there have the number of {}; expected one", path.display(), scan.display())]
    NoPoseForNumber {
        /// The folder of poses.
        path: PathBuf,
        /// The scan.
        scan: PathBuf,
        /// Files with its number; 0 also when it has no number.
        found: usize,
    },
}

/// Finds the scans that `inputs` name, in the order of the inputs, with their poses; see the [module page](self).
///
/// `poses` is a file of poses, or a folder with one file a scan. A file named twice is taken twice.
///
/// ```
/// use terrace_io::{find_sources, write_atomically};
///
/// let folder = tempfile::tempdir()?;
/// for name in ["scan10.xyz", "scan2.xyz", "poses.txt"] {
///     write_atomically(&folder.path().join(name), |out| Ok(out.write_all(b"0 0 0\n")?))?;
/// }
/// let sources = find_sources(&[folder.path()], None)?;
/// let names: Vec<_> = sources.iter().filter_map(|s| s.path.file_name()).collect();
/// assert_eq!(names, ["scan2.xyz", "scan10.xyz"]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`SourceError`] when there is no input, one leads to no scan, or poses cannot be read or matched.
pub fn find_sources<P: AsRef<Path>>(inputs: &[P], poses: Option<&Path>) -> Result<Vec<Source>, SourceError> {
    find(inputs, poses).map(|found| found.sources)
}

/// As [`find_sources`], with the noise of each pose from the file `noise`; see the [module page](self).
///
/// # Errors
/// [`SourceError`] as for [`find_sources`], and when the file is damaged or has not as many rows as there are poses.
pub fn find_uncertain_sources<P: AsRef<Path>>(
    inputs: &[P],
    poses: Option<&Path>,
    noise: &Path,
) -> Result<Vec<Source>, SourceError> {
    let Found { mut sources, order } = find(inputs, poses)?;
    let rows = pose_noise::open(noise)?;
    let of_scan: Vec<PoseNoise> = match order {
        Some(Order { poses, of_scan }) if poses == rows.len() => {
            of_scan.into_iter().filter_map(|index| rows.get(index).copied()).collect()
        }
        _ if rows.len() == sources.len() => rows,
        order => {
            return Err(SourceError::PoseNoiseCount {
                path: noise.to_owned(),
                rows: rows.len(),
                scans: sources.len(),
                poses: order.map(|order| order.poses),
            });
        }
    };
    for (source, noise) in sources.iter_mut().zip(of_scan) {
        source.pose_noise = Some(noise);
    }
    Ok(sources)
}

/// Scans with their poses.
struct Found {
    sources: Vec<Source>,
    /// When the poses are from one file.
    order: Option<Order>,
}

/// Which of the poses of a file each scan has.
struct Order {
    poses: usize,
    of_scan: Vec<usize>,
}

fn find<P: AsRef<Path>>(inputs: &[P], poses: Option<&Path>) -> Result<Found, SourceError> {
    if inputs.is_empty() {
        return Err(SourceError::NoInput);
    }
    let mut scans = Vec::new();
    for input in inputs {
        expand(input.as_ref(), &mut scans)?;
    }
    match poses {
        None => Ok(Found { sources: poses::beside(scans)?, order: None }),
        Some(path) if path.is_dir() => Ok(Found { sources: poses::from_folder(scans, path)?, order: None }),
        Some(path) => poses::from_file(scans, path),
    }
}

fn expand(input: &Path, scans: &mut Vec<PathBuf>) -> Result<(), SourceError> {
    if input.is_dir() {
        scans.extend(folder::choose(input, folder::list(input)?)?);
    } else if input.exists() {
        scans.push(input.to_owned());
    } else {
        let not_found = || SourceError::NotFound { path: input.to_owned() };
        let pattern = input.to_str().ok_or_else(not_found)?;
        let options = glob::MatchOptions { require_literal_leading_dot: true, ..Default::default() };
        let matches = glob::glob_with(pattern, options)
            .map_err(|e| SourceError::Pattern { path: input.to_owned(), message: e.msg.to_owned() })?;
        // The files of each folder are chosen among together; the folders themselves come in natural order.
        let mut folders: BTreeMap<folder::Natural, Vec<PathBuf>> = BTreeMap::new();
        for path in matches {
            let path = path.map_err(|e| SourceError::Io { path: e.path().to_owned(), error: e.into() })?;
            if path.is_dir() {
                folders.entry(folder::Natural::of(&path)).or_default().extend(folder::list(&path)?);
            } else {
                folders
                    .entry(folder::Natural::of(path.parent().unwrap_or(Path::new(""))))
                    .or_default()
                    .push(path);
            }
        }
        if folders.is_empty() {
            return Err(not_found());
        }
        let files: usize = folders.values().map(Vec::len).sum();
        let before = scans.len();
        for matched in folders.into_values() {
            scans.extend(folder::choose(input, matched).or_else(|e| match e {
                SourceError::NothingUsable { .. } => Ok(Vec::new()),
                e => Err(e),
            })?);
        }
        if scans.len() == before {
            return Err(SourceError::NothingUsable { path: input.to_owned(), files });
        }
    }
    Ok(())
}
