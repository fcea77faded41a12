//! Why two labelings could not be compared.

use std::path::PathBuf;

use terrace_io::npy::NpyError;
use terrace_io::pcd::PcdError;
use terrace_io::planes_json::PlanesJsonError;
use terrace_io::ply::PlyError;

/// What is wrong with a pair.
#[derive(Debug, thiserror::Error)]
pub enum PairError {
    /// One of its files cannot be used.
    #[error("{}: {kind}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        kind: FileKind,
    },
    /// The labels are not of the same points.
    #[error("{} against {}: {error}", pred.display(), truth.display())]
    Labels {
        /// The found labels.
        pred: PathBuf,
        /// The true labels.
        truth: PathBuf,
        /// What is wrong with them.
        error: terrace_eval::EvalError,
    },
}

/// What is wrong with a file of labels or planes.
#[derive(Debug, thiserror::Error)]
pub enum FileKind {
    /// The operating system did not hand over the file.
    #[error("{0}")]
    Io(#[from] std::io::Error),
    /// It is a device or a folder.
    #[error("not a file")]
    NotAFile,
    /// It is of no format that holds labels.
    #[error("labels are read from NPY, PLY and PCD")]
    Format,
    /// A damaged NPY file, or one that is not of labels.
    #[error(transparent)]
    Npy(#[from] NpyError),
    /// A damaged PLY file, or one without the field.
    #[error(transparent)]
    Ply(#[from] PlyError),
    /// A damaged PCD file, or one without the field.
    #[error(transparent)]
    Pcd(#[from] PcdError),
    /// A label is not a whole number of 32 bits.
    #[error("the label {value} of point {point} is no whole number of 32 bits")]
    NotWhole {
        /// Index of the point.
        point: usize,
        /// The value of the field.
        value: f64,
    },
    /// Not a file of planes.
    #[error(transparent)]
    Planes(#[from] PlanesJsonError),
    /// The coefficients of a plane are of none.
    #[error("plane {id}: {error}")]
    Plane {
        /// Number of the plane.
        id: u32,
        /// What is wrong with it.
        error: terrace_types::PlaneError,
    },
}
