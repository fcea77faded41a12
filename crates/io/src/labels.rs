//! Labels as NPY.

use std::path::Path;

use npyz::WriterBuilder;
use terrace_types::PlaneId;

use crate::{WriteError, WriteErrorKind, write_atomically};

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
    write_atomically(path, |out| {
        let int32 = "<i4".parse().map_err(std::io::Error::other)?;
        let mut array = npyz::WriteOptions::<i32>::new()
            .dtype(npyz::DType::new_scalar(int32))
            .shape(&[count])
            .writer(out)
            .begin_nd()?;
        let mut found = 0;
        for label in labels {
            found += 1;
            if found > count {
                break;
            }
            array.push(&PlaneId::label(label))?;
        }
        if found != count {
            return Err(WriteErrorKind::Count { expected: count, found });
        }
        Ok(array.finish()?)
    })
}
