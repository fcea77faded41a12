//! Points coloured by plane as binary PLY.

use std::path::Path;

use terrace_types::PlaneId;

use crate::ply_writer::PlyPoint;
use crate::{PlyWriter, WriteError};

/// From this coordinate on, in metres, positions are written in double precision: a millimetre must survive.
const DOUBLE_FROM: f64 = 1000.0;

/// What the header of the file needs before the first point: how many there are, and how far they reach.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PlyExtent {
    /// Number of points.
    pub points: u64,
    /// Largest absolute coordinate, in metres. From 1000 m on positions are written as double, else as float.
    pub largest: f64,
}

impl PlyExtent {
    /// Counts and measures points in one pass.
    pub fn of(points: impl IntoIterator<Item = [f64; 3]>) -> Self {
        points.into_iter().fold(Self::default(), |extent, p| Self {
            points: extent.points + 1,
            largest: p.iter().fold(extent.largest, |m, x| m.max(x.abs())),
        })
    }

    /// Counts and measures more points.
    pub fn add(&mut self, points: impl IntoIterator<Item = [f64; 3]>) {
        let more = Self::of(points);
        self.points += more.points;
        self.largest = self.largest.max(more.largest);
    }

    /// Whether positions are written in double precision.
    pub fn is_double(&self) -> bool {
        self.largest >= DOUBLE_FROM
    }
}

/// A point of a result.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LabelledPoint {
    /// Position in metres.
    pub position: [f64; 3],
    /// The plane it belongs to.
    pub plane: Option<PlaneId>,
}

/// A point of a synthetic scan with the truth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredPoint {
    /// Position in metres.
    pub position: [f64; 3],
    /// The plane it belongs to.
    pub plane: Option<PlaneId>,
    /// Standard error in metres.
    pub sigma: f64,
}

/// Writes points with `x y z`, `red green blue` (see [`palette`](crate::palette)) and `label` (0 for no plane) as binary
/// little-endian PLY, point by point as they come.
///
/// ```
/// use terrace_io::{FieldChoice, LabelledPoint, PlyExtent, ply, write_labelled_ply};
///
/// let points = [LabelledPoint { position: [0.5, 1.0, -2.0], plane: None }];
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("planes.ply");
/// write_labelled_ply(&path, PlyExtent::of(points.iter().map(|p| p.position)), points)?;
/// let cloud = ply::read(&std::fs::read(&path)?, &FieldChoice::Automatic)?;
/// assert_eq!(cloud.points, [[0.5, 1.0, -2.0]]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`WriteError`] when the file cannot be written, a position is not finite, or the points are not as many as `extent`
/// says; then there is no file.
pub fn write_labelled_ply(
    path: &Path,
    extent: PlyExtent,
    points: impl IntoIterator<Item = LabelledPoint>,
) -> Result<(), WriteError> {
    write(path, extent, points)
}

/// Writes points as [`write_labelled_ply`] does, with their standard error as a `float` property `sigma`, where the
/// readers of this crate look for it.
///
/// # Errors
/// [`WriteError`] as for [`write_labelled_ply`]; a standard error that is not finite is refused likewise.
pub fn write_measured_ply(
    path: &Path,
    extent: PlyExtent,
    points: impl IntoIterator<Item = MeasuredPoint>,
) -> Result<(), WriteError> {
    write(path, extent, points)
}

fn write<P: PlyPoint>(
    path: &Path,
    extent: PlyExtent,
    points: impl IntoIterator<Item = P>,
) -> Result<(), WriteError> {
    let mut writer = PlyWriter::create(path, extent)?;
    writer.push(points)?;
    writer.finish()
}
