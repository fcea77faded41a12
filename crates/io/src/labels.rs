//! Labels as NPY.

use std::io::Write;
use std::path::Path;

use npyz::WriterBuilder;
use terrace_types::PlaneId;

use crate::atomic::FileAside;
use crate::{WriteError, WriteErrorKind};

/// Bytes of labels that are written at a time.
const BLOCK: usize = 1 << 16;

/// Writes labels chunk by chunk as they come, as [`write_labels_npy`] writes all at once. Memory does not grow with their
/// number. The file gets its name with [`finish`](Self::finish); before, and when there was an error, an older file of
/// that name stands as it was.
///
/// ```
/// use terrace_io::LabelsWriter;
/// use terrace_types::PlaneId;
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("labels.npy");
/// let mut writer = LabelsWriter::create(&path, 3)?;
/// writer.push([PlaneId::new(2), None])?;
/// writer.push([PlaneId::new(1)])?;
/// writer.finish()?;
/// assert_eq!(terrace_io::npy::read_labels(&std::fs::read(&path)?)?, [2, 0, 1]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct LabelsWriter {
    file: FileAside,
    block: Vec<u8>,
    expected: u64,
    found: u64,
}

impl LabelsWriter {
    /// Begins a file of `count` labels. Missing folders are made.
    ///
    /// # Errors
    /// [`WriteError`] when the file cannot be written.
    pub fn create(path: &Path, count: u64) -> Result<Self, WriteError> {
        let create = || {
            let mut file = FileAside::create(path)?;
            let int32 = "<i4".parse().map_err(std::io::Error::other)?;
            npyz::WriteOptions::<i32>::new()
                .dtype(npyz::DType::new_scalar(int32))
                .shape(&[count])
                .writer(&mut file)
                .write_header_only()?;
            Ok(Self { file, block: vec![0; BLOCK], expected: count, found: 0 })
        };
        create().map_err(|kind| WriteError { path: path.to_owned(), kind })
    }

    /// Adds labels.
    ///
    /// # Errors
    /// [`WriteError`] when the file cannot be written or there are more labels than announced.
    pub fn push(&mut self, labels: impl IntoIterator<Item = Option<PlaneId>>) -> Result<(), WriteError> {
        self.write(labels.into_iter()).map_err(|kind| self.error(kind))
    }

    /// Ends the file and gives it its name.
    ///
    /// # Errors
    /// [`WriteError`] when the file cannot be written or there are fewer labels than announced; then there is no file.
    pub fn finish(self) -> Result<(), WriteError> {
        let (expected, found) = (self.expected, self.found);
        if found != expected {
            return Err(self.error(WriteErrorKind::Count { expected, found }));
        }
        let path = self.file.path().to_owned();
        self.file.finish().map_err(|kind| WriteError { path, kind })
    }

    fn write(&mut self, mut labels: impl Iterator<Item = Option<PlaneId>>) -> Result<(), WriteErrorKind> {
        loop {
            let places = self.block.as_chunks_mut().0.iter_mut();
            let mut filled = 0;
            for (place, label) in places.zip(&mut labels) {
                *place = PlaneId::label(label).to_le_bytes();
                filled += 1;
            }
            if filled == 0 {
                return Ok(());
            }
            self.found += filled as u64;
            if self.found > self.expected {
                let expected = self.expected;
                return Err(WriteErrorKind::Count { expected, found: expected.saturating_add(1) });
            }
            self.file.write_all(self.block.get(..filled * size_of::<i32>()).unwrap_or_default())?;
        }
    }

    fn error(&self, kind: WriteErrorKind) -> WriteError {
        WriteError { path: self.file.path().to_owned(), kind }
    }
}

/// Writes one label per point as a one-dimensional little-endian int32 array in NPY format: 0 for points of no plane,
/// otherwise the number of the plane. Labels are written as they come; `count` is their number, which the header needs.
///
/// ```
/// use terrace_types::PlaneId;
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("labels.npy");
/// terrace_io::write_labels_npy(&path, [PlaneId::new(2), None], 2)?;
/// assert_eq!(terrace_io::npy::read_labels(&std::fs::read(&path)?)?, [2, 0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`WriteError`] when the file cannot be written or there are more or fewer labels than `count`; then there is no file.
pub fn write_labels_npy(
    path: &Path,
    labels: impl IntoIterator<Item = Option<PlaneId>>,
    count: u64,
) -> Result<(), WriteError> {
    let mut writer = LabelsWriter::create(path, count)?;
    writer.push(labels)?;
    writer.finish()
}
