//! Sensor poses from the files in which recorders keep them.
//!
//! | kind | a pose is | stamped |
//! |---|---|---|
//! | TUM | a line `t tx ty tz qx qy qz qw` | yes |
//! | KITTI | a line of 12 numbers, the upper three rows of a 4×4 matrix | no |
//! | matrix lines | a line of 16 numbers, a 4×4 matrix row by row | no |
//! | matrix blocks | four lines of four numbers; one or many (7-Scenes, `alidarPose.csv` of BALM) | no |
//! | `Open3D` log | a line of three whole numbers, then a block as above | no |
//! | NPY | a (4, 4) or (N, 4, 4) array of f32 or f64 | no |
//!
//! The kind is found from the number of values in the first line. Values are separated by spaces, commas, or both; a
//! comma may end a line; `#` starts a comment; empty lines are skipped. The last entry of a 4×4 matrix is not looked
//! at, as [`Pose::from_matrix`] explains. Lines are counted from 1, comments and empty lines included.

mod blocks;
mod kitti;
mod matrix_lines;
mod npy;
mod rows;
mod tum;

use std::path::Path;

use terrace_types::{Pose, PoseError};

use crate::FileError;
use rows::Rows;

/// A pose, and when the sensor was there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StampedPose {
    /// Seconds, on the clock of the recorder; `None` in formats without time stamps.
    pub time: Option<f64>,
    /// From sensor to world.
    pub pose: Pose,
}

impl From<Pose> for StampedPose {
    fn from(pose: Pose) -> Self {
        Self { time: None, pose }
    }
}

/// The kinds of trajectory files, see the [module page](self).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TrajectoryFormat {
    /// `t tx ty tz qx qy qz qw`.
    Tum,
    /// 12 numbers a line.
    Kitti,
    /// 16 numbers a line.
    MatrixLines,
    /// Four lines of four numbers.
    MatrixBlocks,
    /// Three whole numbers, then four lines of four numbers.
    Open3dLog,
    /// An array of 4×4 matrices.
    Npy,
}

impl std::fmt::Display for TrajectoryFormat {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Tum => "TUM",
            Self::Kitti => "KITTI",
            Self::MatrixLines => "4x4 matrices, one a line",
            Self::MatrixBlocks => "4x4 matrices in four lines",
            Self::Open3dLog => "Open3D log",
            Self::Npy => "NPY",
        })
    }
}

/// Poses in file order.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory {
    /// The kind of file they came from.
    pub format: TrajectoryFormat,
    /// The poses; never empty when read by this crate.
    pub poses: Vec<StampedPose>,
}

/// Why a file holds no poses that can be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TrajectoryError {
    /// There is no pose in the file.
    #[error("there is no pose in the file")]
    Empty,
    /// A line is not UTF-8 text.
    #[error("line {line} is not text")]
    NotText {
        /// The line.
        line: usize,
    },
    /// A value is not a number.
    #[error("line {line}, value {column}: '{text}' is not a number")]
    NotANumber {
        /// The line.
        line: usize,
        /// The value in the line, from 1.
        column: usize,
        /// What stands there, shortened.
        text: String,
    },
    /// The first line has a number of values by which no kind of file is known.
    #[error(
        "line {line} has {found} values; a pose has 8 (TUM), 12 (KITTI), 16 or four lines of 4 (4x4 matrix)"
    )]
    UnknownShape {
        /// The line.
        line: usize,
        /// Values in it; 17 stands for more than 16.
        found: usize,
    },
    /// A line has more or fewer values than the first lines led to expect.
    #[error("line {line} has {found} values where {expected} were expected ({format})")]
    Columns {
        /// The line.
        line: usize,
        /// Values in it; 17 stands for more than 16.
        found: usize,
        /// Values expected.
        expected: usize,
        /// The kind of file by its first line.
        format: TrajectoryFormat,
    },
    /// The file ends within a 4×4 matrix.
    #[error("the file ends within the 4x4 matrix that starts in line {line}")]
    Incomplete {
        /// The first line of the matrix, or its header.
        line: usize,
    },
    /// A time stamp is NaN or infinite.
    #[error("line {line}: the time stamp is {time}")]
    Time {
        /// The line.
        line: usize,
        /// The time stamp.
        time: f64,
    },
    /// The numbers are not a pose.
    #[error("line {line}: {error}")]
    Pose {
        /// The first line of the pose.
        line: usize,
        /// What is wrong with it.
        error: PoseError,
    },
    /// A matrix in an array is not a pose.
    #[error("matrix {index} of the array: {error}")]
    PoseInArray {
        /// The matrix, from 0.
        index: usize,
        /// What is wrong with it.
        error: PoseError,
    },
    /// The NPY file is damaged or not an array of f32 or f64.
    #[error("{message}")]
    Npy {
        /// What is wrong.
        message: String,
    },
    /// The array is not of 4×4 matrices.
    #[error("the array has the shape {shape:?}; expected (4, 4) or (N, 4, 4)")]
    NpyShape {
        /// The shape found.
        shape: Vec<u64>,
    },
}

/// Reads poses from the bytes of a file; see the [module page](self) for the kinds.
///
/// ```
/// use terrace_io::trajectory::{self, TrajectoryFormat};
///
/// let text = b"# time x y z qx qy qz qw\n12.5  1 2 3  0 0 0 1\n";
/// let trajectory = trajectory::read(text)?;
/// assert_eq!(trajectory.format, TrajectoryFormat::Tum);
/// assert_eq!(trajectory.poses[0].time, Some(12.5));
/// assert_eq!(trajectory.poses[0].pose.translation(), [1.0, 2.0, 3.0]);
/// # Ok::<(), terrace_io::trajectory::TrajectoryError>(())
/// ```
///
/// # Errors
/// [`TrajectoryError`] when the file is of no known kind, a line is damaged, a pose is not finite or not rigid, or there
/// is no pose.
pub fn read(bytes: &[u8]) -> Result<Trajectory, TrajectoryError> {
    if bytes.starts_with(b"\x93NUMPY") {
        return Ok(Trajectory { format: TrajectoryFormat::Npy, poses: npy::read(bytes)? });
    }
    let mut rows = Rows::new(bytes);
    let Some(first) = rows.peek()? else { return Err(TrajectoryError::Empty) };
    let (format, poses) = match first.values().len() {
        8 => (TrajectoryFormat::Tum, tum::read(&mut rows)?),
        12 => (TrajectoryFormat::Kitti, kitti::read(&mut rows)?),
        16 => (TrajectoryFormat::MatrixLines, matrix_lines::read(&mut rows)?),
        4 => (TrajectoryFormat::MatrixBlocks, blocks::read(&mut rows, TrajectoryFormat::MatrixBlocks)?),
        3 => (TrajectoryFormat::Open3dLog, blocks::read(&mut rows, TrajectoryFormat::Open3dLog)?),
        found => return Err(TrajectoryError::UnknownShape { line: first.line(), found }),
    };
    Ok(Trajectory { format, poses })
}

/// Reads poses from a file as [`read`] does.
///
/// # Errors
/// [`FileError`] naming the file.
pub fn open(path: &Path) -> Result<Trajectory, FileError<TrajectoryError>> {
    crate::file::open_with(path, read)
}
