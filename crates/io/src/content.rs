//! What a file of points holds, whatever its format, before errors and frame are settled.

use std::fs::File;
use std::io;
use std::path::Path;

use terrace_types::{Pose, Sigma};

use crate::bytes::{Bytes, Failure, FileBytes};
use crate::depth::DepthImage;
use crate::detect::{Format, detect};
use crate::read::{ErrorSource, ReadErrorKind};
use crate::{Cloud, FieldChoice, npy, pcd, ply, source, text};

/// First bytes of a file by which its format is found.
const HEAD: usize = 1 << 12;

pub(crate) enum Content {
    Cloud(Box<Points>),
    Depth(DepthImage),
}

/// The points of a file, taken piece by piece.
pub(crate) struct Points {
    bytes: FileBytes,
    format: AnyPoints,
}

enum AnyPoints {
    Ply(ply::Points),
    Pcd(pcd::Points),
    Text(text::Points),
    Npy(npy::Points),
}

impl<E: Into<ReadErrorKind>> From<Failure<E, io::Error>> for ReadErrorKind {
    fn from(failure: Failure<E, io::Error>) -> Self {
        match failure {
            Failure::Content(error) => error.into(),
            Failure::Input(error) => Self::Io(error),
        }
    }
}

impl Content {
    /// Opens a file and reads its header. The format is found from the first bytes, then from the extension.
    pub(crate) fn open(path: &Path, errors: &ErrorSource) -> Result<Self, ReadErrorKind> {
        // Reading a device or a pipe might never end, and opening one may wait for ever.
        if !std::fs::metadata(path).map_err(ReadErrorKind::Io)?.is_file() {
            return Err(ReadErrorKind::NotAFile);
        }
        let file = File::open(path).map_err(ReadErrorKind::Io)?;
        let length = file.metadata().map_err(ReadErrorKind::Io)?.len();
        if length == 0 {
            return Err(ReadErrorKind::Empty);
        }
        let mut bytes = FileBytes::new(file, length);
        let fields = match errors {
            ErrorSource::FromFile(fields) => fields,
            ErrorSource::Model(_) => &FieldChoice::Ignore,
        };
        let nameless = |format| match fields {
            FieldChoice::Named(field) => Err(ReadErrorKind::NoNamedFields { field: field.clone(), format }),
            FieldChoice::Automatic | FieldChoice::Ignore => Ok(()),
        };
        let head = bytes.window(0, HEAD).map_err(ReadErrorKind::Io)?;
        let format = match detect(head, &source::extension(path)) {
            Format::Ply => AnyPoints::Ply(ply::Points::open(&mut bytes, fields)?),
            Format::Pcd => AnyPoints::Pcd(pcd::Points::open(&mut bytes, fields)?),
            Format::Text => AnyPoints::Text(text::Points::open(&mut bytes, fields)?),
            Format::Npy => {
                nameless("NPY")?;
                AnyPoints::Npy(npy::Points::open(&mut bytes)?)
            }
            Format::Png => {
                nameless("PNG")?;
                let all = bytes.whole(0, bytes.left(0)).map_err(ReadErrorKind::Io)?;
                return Ok(Self::Depth(DepthImage::read(&all)?));
            }
            Format::Foreign(name, advice) => return Err(ReadErrorKind::Foreign { name, advice }),
            Format::Unknown => return Err(ReadErrorKind::Unknown),
        };
        Ok(Self::Cloud(Box::new(Points { bytes, format })))
    }
}

impl Points {
    /// Number of points that the header promises; `None` for a text.
    pub(crate) fn promised(&self) -> Option<u64> {
        match &self.format {
            AnyPoints::Ply(points) => Some(points.promised()),
            AnyPoints::Pcd(points) => Some(points.promised()),
            AnyPoints::Npy(points) => Some(points.promised()),
            AnyPoints::Text(_) => None,
        }
    }

    /// About how many bytes of the file were read so far.
    pub(crate) fn reached(&self) -> u64 {
        self.bytes.reached()
    }

    /// The pose of the sensor, when the file has one.
    pub(crate) fn viewpoint(&self) -> Option<Pose> {
        match &self.format {
            AnyPoints::Pcd(points) => points.viewpoint(),
            AnyPoints::Ply(_) | AnyPoints::Npy(_) | AnyPoints::Text(_) => None,
        }
    }

    /// The next points and their errors, `most` at most; none at the end.
    pub(crate) fn next(&mut self, most: usize) -> Result<(Vec<[f64; 3]>, Sigma), ReadErrorKind> {
        let bytes = &mut self.bytes;
        Ok(match &mut self.format {
            AnyPoints::Ply(points) => {
                points.read(bytes, most)?;
                points.rows.take()
            }
            AnyPoints::Pcd(points) => {
                points.read(bytes, most)?;
                points.rows.take()
            }
            AnyPoints::Npy(points) => {
                points.read(bytes, most)?;
                points.rows.take()
            }
            AnyPoints::Text(points) => {
                points.read(bytes, most)?;
                points.take()
            }
        })
    }

    /// Takes over the memory of points and errors that are no longer needed.
    pub(crate) fn reuse(&mut self, points: Vec<[f64; 3]>, sigmas: Sigma) {
        match &mut self.format {
            AnyPoints::Ply(all) => all.rows.reuse(points, sigmas),
            AnyPoints::Pcd(all) => all.rows.reuse(points, sigmas),
            AnyPoints::Npy(all) => all.rows.reuse(points, sigmas),
            AnyPoints::Text(all) => all.reuse(points, sigmas),
        }
    }

    /// All points at once.
    pub(crate) fn cloud(mut self) -> Result<Cloud, ReadErrorKind> {
        let (points, sigma) = self.next(usize::MAX)?;
        let format = match &self.format {
            AnyPoints::Ply(points) => points.format(),
            AnyPoints::Pcd(points) => points.format(),
            AnyPoints::Npy(points) => points.format(),
            AnyPoints::Text(points) => points.format(),
        };
        Ok(Cloud { points, sigma, viewpoint: self.viewpoint(), format })
    }
}
