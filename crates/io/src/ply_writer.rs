//! Coloured points written chunk by chunk.

use std::io::Write;
use std::marker::PhantomData;
use std::path::Path;

use terrace_types::PlaneId;

use crate::atomic::FileAside;
use crate::{LabelledPoint, MeasuredPoint, PlyExtent, WriteError, WriteErrorKind, palette};

/// Bytes of points that are written at a time.
const BLOCK: usize = 1 << 16;

/// Points that a [`PlyWriter`] writes: [`LabelledPoint`] and [`MeasuredPoint`].
pub trait PlyPoint: sealed::Point {}

mod sealed {
    use terrace_types::PlaneId;

    pub trait Point: Copy {
        /// The property of the standard error in the header.
        const SIGMA: &str;

        fn position(self) -> [f64; 3];

        fn plane(self) -> Option<PlaneId>;

        fn sigma(self) -> Option<f64>;
    }
}

impl PlyPoint for LabelledPoint {}

impl sealed::Point for LabelledPoint {
    const SIGMA: &str = "";

    fn position(self) -> [f64; 3] {
        self.position
    }

    fn plane(self) -> Option<PlaneId> {
        self.plane
    }

    fn sigma(self) -> Option<f64> {
        None
    }
}

impl PlyPoint for MeasuredPoint {}

impl sealed::Point for MeasuredPoint {
    const SIGMA: &str = "property float sigma\n";

    fn position(self) -> [f64; 3] {
        self.position
    }

    fn plane(self) -> Option<PlaneId> {
        self.plane
    }

    fn sigma(self) -> Option<f64> {
        Some(self.sigma)
    }
}

/// Writes points chunk by chunk as they come, as [`write_labelled_ply`](crate::write_labelled_ply) and
/// [`write_measured_ply`](crate::write_measured_ply) write all at once. Memory does not grow with their number. The file
/// gets its name with [`finish`](Self::finish); before, and when there was an error, an older file of that name stands as
/// it was.
///
/// ```
/// use terrace_io::{FieldChoice, LabelledPoint, PlyExtent, PlyWriter, ply};
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("planes.ply");
/// let mut writer = PlyWriter::create(&path, PlyExtent { points: 2, largest: 2.0 })?;
/// writer.push([LabelledPoint { position: [0.5, 1.0, -2.0], plane: None }])?;
/// writer.push([LabelledPoint { position: [0.0, 0.0, 1.0], plane: None }])?;
/// writer.finish()?;
/// let cloud = ply::read(&std::fs::read(&path)?, &FieldChoice::Automatic)?;
/// assert_eq!(cloud.points, [[0.5, 1.0, -2.0], [0.0, 0.0, 1.0]]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct PlyWriter<P> {
    file: FileAside,
    block: Vec<u8>,
    double: bool,
    expected: u64,
    found: u64,
    /// The plane of the last point and its colour: points of a plane often follow each other.
    colour: (Option<PlaneId>, [u8; 3]),
    kind: PhantomData<P>,
}

impl<P: PlyPoint> PlyWriter<P> {
    /// Begins a file of as many points as `extent` says. Missing folders are made.
    ///
    /// # Errors
    /// [`WriteError`] when the file cannot be written.
    pub fn create(path: &Path, extent: PlyExtent) -> Result<Self, WriteError> {
        let create = || {
            let mut file = FileAside::create(path)?;
            let scalar = if extent.is_double() { "double" } else { "float" };
            write!(
                file,
                "ply\nformat binary_little_endian 1.0\ncomment terrace: lengths in metres, label 0 is no plane\n\
                 element vertex {}\n\
                 property {scalar} x\nproperty {scalar} y\nproperty {scalar} z\n{}\
                 property uchar red\nproperty uchar green\nproperty uchar blue\nproperty int label\nend_header\n",
                extent.points,
                P::SIGMA
            )?;
            Ok(Self {
                file,
                block: Vec::with_capacity(BLOCK),
                double: extent.is_double(),
                expected: extent.points,
                found: 0,
                colour: (None, palette::colour_of(None)),
                kind: PhantomData,
            })
        };
        create().map_err(|kind| WriteError { path: path.to_owned(), kind })
    }

    /// Adds points.
    ///
    /// # Errors
    /// [`WriteError`] when the file cannot be written, there are more points than announced, or a position or standard
    /// error is not finite.
    pub fn push(&mut self, points: impl IntoIterator<Item = P>) -> Result<(), WriteError> {
        let written = points.into_iter().try_for_each(|point| self.write(point));
        written.map_err(|kind| self.error(kind))
    }

    /// Ends the file and gives it its name.
    ///
    /// # Errors
    /// [`WriteError`] when the file cannot be written or there are fewer points than announced; then there is no file.
    pub fn finish(mut self) -> Result<(), WriteError> {
        let (expected, found) = (self.expected, self.found);
        if found != expected {
            return Err(self.error(WriteErrorKind::Count { expected, found }));
        }
        let path = self.file.path().to_owned();
        let finished = self.file.write_all(&self.block).map_err(Into::into);
        finished.and_then(|()| self.file.finish()).map_err(|kind| WriteError { path, kind })
    }

    #[inline]
    fn write(&mut self, point: P) -> Result<(), WriteErrorKind> {
        if self.found == self.expected {
            let expected = self.expected;
            return Err(WriteErrorKind::Count { expected, found: expected.saturating_add(1) });
        }
        let (position, plane, sigma) = (point.position(), point.plane(), point.sigma());
        if let Some(value) = position.into_iter().chain(sigma).find(|value| !value.is_finite()) {
            return Err(WriteErrorKind::NotFinite { what: format!("point {}", self.found), value });
        }
        self.found += 1;
        if self.colour.0 != plane {
            self.colour = (plane, palette::colour_of(plane));
        }
        let block = &mut self.block;
        if self.double {
            block.extend_from_slice(position.map(f64::to_le_bytes).as_flattened());
        } else {
            block.extend_from_slice(position.map(|x| single(x).to_le_bytes()).as_flattened());
        }
        if let Some(sigma) = sigma {
            block.extend_from_slice(&single(sigma).to_le_bytes());
        }
        let ([red, green, blue], [a, b, c, d]) = (self.colour.1, PlaneId::label(plane).to_le_bytes());
        block.extend_from_slice(&[red, green, blue, a, b, c, d]);
        if block.len() >= BLOCK {
            self.file.write_all(block)?;
            block.clear();
        }
        Ok(())
    }

    fn error(&self, kind: WriteErrorKind) -> WriteError {
        WriteError { path: self.file.path().to_owned(), kind }
    }
}

#[expect(clippy::cast_possible_truncation, reason = "single precision is what the file holds")]
fn single(value: f64) -> f32 {
    value as f32
}
