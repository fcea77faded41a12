//! A scan read in chunks, so that files larger than memory can be read.

use std::path::PathBuf;

use terrace_noise::SensorNoise;
use terrace_types::{Frame, Pose, Scan, ScanError, Sigma, SigmaError};

use crate::content::{Content, Points};
use crate::read::{ErrorSource, ReadError, ReadErrorKind, ReadOptions};
use crate::{FieldChoice, Source, by_model};

/// The axis along which a depth camera measures, in its own frame.
const OPTICAL_AXIS: [f64; 3] = [0.0, 0.0, 1.0];

/// Reads a file of points as scans of some points each, which follow each other in the file and share its frame. Put
/// together they are what [`read_scan`](crate::read_scan) gives; frame, errors and formats are described there.
///
/// **Memory.** A chunk takes 24 bytes a point; 8 or 24 more with errors from fields, 48 with a model that gives
/// covariances. Beside it a quarter of a mebibyte of the file is held, its header, and the longest line of a text or the
/// longest record. What can only be read as a whole is held until its last point is given: PCD `binary_compressed` (the
/// unpacked bytes, and the packed ones while unpacking), NPY images (`H × W × 3`) in Fortran order (48 bytes a point), and
/// depth images, which are one chunk of any size. Columns of an NPY in Fortran order (`N × 3`) are read piece by piece.
///
/// **Errors.** A damaged file gives the error that [`read_scan`](crate::read_scan) gives, with the chunk where the damage
/// is, or the last one for what is wrong behind the points; chunks before it have been given by then. Of several damages
/// the first in the file is told.
///
/// ```
/// use terrace_io::{ReadOptions, ScanReader, Source, write_atomically};
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("three.xyz");
/// write_atomically(&path, |out| Ok(out.write_all(b"0 0 0\n1 0 0\n0 1 0\n")?))?;
/// let mut reader = ScanReader::open(&Source::new(&path), &ReadOptions::default(), 2)?;
/// let mut sizes = Vec::new();
/// while let Some(scan) = reader.next_chunk()? {
///     sizes.push(scan.len());
///     reader.recycle(scan);
/// }
/// assert_eq!(sizes, [2, 1]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct ScanReader {
    path: PathBuf,
    points: Chunks,
    frame: Frame,
    /// Bytes of the file.
    length: u64,
    noise: Option<SensorNoise>,
    /// Whether errors are left out.
    bare: bool,
    /// Most points of a chunk.
    size: usize,
    promised: Option<u64>,
    given: usize,
    not_measured: usize,
    ended: bool,
}

/// Where the next points come from.
enum Chunks {
    Cloud(Box<Points>),
    /// An image until it is given.
    Depth(Option<Vec<[f64; 3]>>),
}

impl ScanReader {
    /// Opens a file and reads its header; `chunk_points` is the number of points of each chunk but the last, at least 1.
    ///
    /// # Errors
    /// [`ReadError`] naming the file.
    pub fn open(source: &Source, options: &ReadOptions, chunk_points: usize) -> Result<Self, ReadError> {
        let opened = || {
            let (points, promised, frame) = match Content::open(&source.path, &options.errors)? {
                Content::Cloud(points) => {
                    let frame = match source.pose {
                        Some(pose) => Frame::Sensor { pose },
                        None => Frame::World { sensor: points.viewpoint().map(|v| v.translation()) },
                    };
                    let promised = points.promised();
                    (Chunks::Cloud(points), promised, frame)
                }
                Content::Depth(image) => {
                    let camera = options.intrinsics.ok_or(ReadErrorKind::NoIntrinsics)?;
                    let points = image.points(&camera, options.depth_scale)?;
                    let frame = Frame::Sensor { pose: source.pose.unwrap_or(Pose::IDENTITY) };
                    let count = points.len() as u64;
                    (Chunks::Depth(Some(points)), Some(count), frame)
                }
            };
            let length = std::fs::metadata(&source.path).map_err(ReadErrorKind::Io)?.len();
            Ok(Self {
                path: source.path.clone(),
                points,
                frame,
                length,
                noise: match options.errors {
                    ErrorSource::FromFile(_) => None,
                    ErrorSource::Model(noise) => Some(noise),
                },
                bare: false,
                size: chunk_points.max(1),
                promised,
                given: 0,
                not_measured: 0,
                ended: false,
            })
        };
        opened().map_err(|kind| ReadError { path: source.path.clone(), kind: Box::new(kind) })
    }

    /// As [`open`](Self::open), for the points alone, as they are read again: their errors are [unknown](Sigma::Unknown). What the noise
    /// model says cannot have been measured is absent all the same.
    ///
    /// # Errors
    /// As [`open`](Self::open), but for what is wrong with errors in the file, which is not looked at.
    pub fn open_bare(source: &Source, options: &ReadOptions, chunk_points: usize) -> Result<Self, ReadError> {
        let errors = match options.errors {
            ErrorSource::FromFile(_) => ErrorSource::FromFile(FieldChoice::Ignore),
            ErrorSource::Model(noise) => ErrorSource::Model(noise),
        };
        let reader = Self::open(source, &ReadOptions { errors, ..options.clone() }, chunk_points)?;
        Ok(Self { bare: true, ..reader })
    }

    /// The next points; `None` at the end, and after an error.
    ///
    /// # Errors
    /// [`ReadError`] naming the file.
    pub fn next_chunk(&mut self) -> Result<Option<Scan>, ReadError> {
        if self.ended {
            return Ok(None);
        }
        let scan = self.take();
        self.ended = scan.as_ref().map_or(true, Scan::is_empty);
        scan.map(|scan| Some(scan).filter(|scan| !scan.is_empty()))
    }

    /// Gives the memory of a chunk back for one of the next.
    pub fn recycle(&mut self, chunk: Scan) {
        if let Chunks::Cloud(points) = &mut self.points {
            let (spent, sigma, _) = chunk.into_parts();
            points.reuse(spent, sigma);
        }
    }

    /// Number of points that the header of the file promises, absent ones included; `None` for a text, which does not
    /// tell. It may be wrong until the end of the file was reached without an error.
    pub fn points(&self) -> Option<u64> {
        self.promised
    }

    /// About how many bytes of the file were read so far, for people who wait: what can only be read as a whole is read before its first
    /// point is given.
    pub fn bytes_read(&self) -> u64 {
        match &self.points {
            Chunks::Cloud(points) => points.reached(),
            Chunks::Depth(_) => self.length,
        }
    }

    /// The frame of all chunks.
    pub fn frame(&self) -> Frame {
        self.frame
    }

    /// Points of the chunks so far that the file has and the scans have not, see
    /// [`Counted::not_measured`](crate::Counted::not_measured).
    pub fn not_measured(&self) -> usize {
        self.not_measured
    }

    /// The next points, or none.
    pub(crate) fn take(&mut self) -> Result<Scan, ReadError> {
        self.scan().map_err(|kind| ReadError { path: self.path.clone(), kind: Box::new(kind) })
    }

    fn scan(&mut self) -> Result<Scan, ReadErrorKind> {
        let (mut points, sigma, axis) = match &mut self.points {
            Chunks::Cloud(points) => {
                let (points, sigma) = points.next(self.size)?;
                (points, sigma, None)
            }
            Chunks::Depth(image) => (image.take().unwrap_or_default(), Sigma::Unknown, Some(OPTICAL_AXIS)),
        };
        let sigma = match self.noise {
            None => sigma,
            Some(noise) if self.bare => {
                self.not_measured += by_model::leave_out(noise, &mut points, self.frame, axis)?;
                Sigma::Unknown
            }
            Some(noise) => {
                let (sigma, not_measured) = by_model::errors(noise, &mut points, self.frame, axis)?;
                self.not_measured += not_measured;
                sigma
            }
        };
        let before = self.given;
        self.given += points.len();
        Ok(Scan::new(points, sigma, self.frame).map_err(|error| in_file(error, before))?)
    }
}

/// An error of a chunk with the index that the point has in the file, where `before` stand before it.
fn in_file(error: ScanError, before: usize) -> ScanError {
    match error {
        ScanError::Sigma(SigmaError::NotAStandardError { point, value }) => {
            SigmaError::NotAStandardError { point: before + point, value }.into()
        }
        ScanError::Sigma(SigmaError::NotACovariance { point, entries }) => {
            SigmaError::NotACovariance { point: before + point, entries }.into()
        }
        error => error,
    }
}
