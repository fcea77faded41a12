//! What the readers of point files return, before noise model and pose are decided.

pub(crate) mod fields;
pub(crate) mod lines;
pub(crate) mod records;

use terrace_types::{Pose, Sigma};

/// A point of a text needs at least `0 0 0` and a line end.
pub(crate) const LEAST_BYTES_OF_A_LINE: usize = 6;

/// The points of one file, in file order and as they stand there, with what the file says of their errors.
#[derive(Debug, Clone, PartialEq)]
pub struct Cloud {
    /// Coordinates in metres; NaN where the file holds no measurement.
    pub points: Vec<[f64; 3]>,
    /// Standard errors from a field of the file, [`Sigma::Unknown`] when it has none.
    pub sigma: Sigma,
    /// The sensor's pose when the file records one (the VIEWPOINT of a PCD).
    pub viewpoint: Option<Pose>,
    /// Format and encoding for people, such as `PLY binary_little_endian`.
    pub format: &'static str,
}

/// Which fields of a point file hold the standard error.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum FieldChoice {
    /// `sigma`, or `sigma_x`, `sigma_y` and `sigma_z`, when the file has them.
    #[default]
    Automatic,
    /// The field of this name; a file without it is an error.
    Named(String),
    /// Fields of the file are not used as errors.
    Ignore,
}
