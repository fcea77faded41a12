//! Points coloured by plane as binary PLY.

use std::io::Write;
use std::path::Path;

use terrace_types::PlaneId;

use crate::{WriteError, WriteErrorKind, palette, write_atomically};

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

/// Writes points with `x y z`, `red green blue` (see [`palette`]) and `label` (0 for no plane) as binary
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
    let points = points.into_iter().map(|p| (p.position, p.plane, None));
    write_atomically(path, |out| write(out, extent, "", points))
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
    let points = points.into_iter().map(|p| (p.position, p.plane, Some(p.sigma)));
    write_atomically(path, |out| write(out, extent, "property float sigma\n", points))
}

fn write(
    out: &mut dyn Write,
    extent: PlyExtent,
    sigma_property: &str,
    points: impl Iterator<Item = ([f64; 3], Option<PlaneId>, Option<f64>)>,
) -> Result<(), WriteErrorKind> {
    let (expected, double) = (extent.points, extent.largest >= DOUBLE_FROM);
    let scalar = if double { "double" } else { "float" };
    write!(
        out,
        "ply\nformat binary_little_endian 1.0\ncomment terrace: lengths in metres, label 0 is no plane\n\
         element vertex {expected}\n\
         property {scalar} x\nproperty {scalar} y\nproperty {scalar} z\n{sigma_property}\
         property uchar red\nproperty uchar green\nproperty uchar blue\nproperty int label\nend_header\n"
    )?;
    let mut found = 0;
    let mut record = Vec::with_capacity(40);
    for (position, plane, sigma) in points {
        found += 1;
        if found > expected {
            break;
        }
        for value in position.into_iter().chain(sigma) {
            if !value.is_finite() {
                return Err(WriteErrorKind::NotFinite { what: format!("point {}", found - 1), value });
            }
        }
        record.clear();
        for value in position {
            if double {
                record.extend(value.to_le_bytes());
            } else {
                record.extend(single(value).to_le_bytes());
            }
        }
        record.extend(sigma.iter().flat_map(|s| single(*s).to_le_bytes()));
        record.extend(palette::colour_of(plane));
        record.extend(PlaneId::label(plane).to_le_bytes());
        out.write_all(&record)?;
    }
    if found == expected { Ok(()) } else { Err(WriteErrorKind::Count { expected, found }) }
}

#[expect(clippy::cast_possible_truncation, reason = "single precision is what the file holds")]
fn single(value: f64) -> f32 {
    value as f32
}
