//! Arrays of 4×4 matrices.

use npyz::{NpyFile, Order};
use terrace_types::Pose;

use super::{StampedPose, TrajectoryError};

/// Longest header taken: numpy writes some 120 bytes for such an array, and the parser of headers recurses.
const MAX_HEADER: usize = 512;

pub(super) fn read(bytes: &[u8]) -> Result<Vec<StampedPose>, TrajectoryError> {
    check_header(bytes)?;
    let file = NpyFile::new(bytes).map_err(message)?;
    let shape = file.shape().to_vec();
    let count = match *shape {
        [4, 4] => 1,
        [count, 4, 4] => count,
        _ => return Err(TrajectoryError::NpyShape { shape }),
    };
    if count == 0 {
        return Err(TrajectoryError::Empty);
    }
    let fortran = file.order() == Order::Fortran;
    let values: Vec<f64> = match file.try_data::<f64>() {
        Ok(values) => values.collect::<Result<_, _>>().map_err(message)?,
        Err(file) => {
            let values = file.data::<f32>().map_err(message)?;
            values.map(|x| x.map(f64::from)).collect::<Result<_, _>>().map_err(message)?
        }
    };
    let matrices = values.len() / 16;
    (0..matrices)
        .map(|index| {
            let entry = |row: usize, column: usize| {
                let at = if fortran {
                    index + matrices * (row + 4 * column)
                } else {
                    16 * index + 4 * row + column
                };
                values.get(at).copied().unwrap_or(f64::NAN)
            };
            let matrix = [0, 1, 2, 3].map(|row| [0, 1, 2, 3].map(|column| entry(row, column)));
            Pose::from_matrix(matrix)
                .map(StampedPose::from)
                .map_err(|error| TrajectoryError::PoseInArray { index, error })
        })
        .collect()
}

/// Refuses headers whose length or numbers would make the parser allocate or overflow.
fn check_header(bytes: &[u8]) -> Result<(), TrajectoryError> {
    let damaged = || TrajectoryError::Npy { message: "damaged NPY header".into() };
    let (length, start) = match *bytes {
        [_, _, _, _, _, _, 1, _, a, b, ..] => (usize::from(u16::from_le_bytes([a, b])), 10),
        [_, _, _, _, _, _, _, _, a, b, 0, 0, ..] => (usize::from(u16::from_le_bytes([a, b])), 12),
        _ => return Err(damaged()),
    };
    let header = bytes.get(start..start + length).filter(|_| length <= MAX_HEADER).ok_or_else(damaged)?;
    // The product of every number in the header, the shape among them, bounds each product of some.
    let product = header
        .split(|b| !b.is_ascii_digit())
        .filter_map(|run| std::str::from_utf8(run).ok().filter(|run| !run.is_empty()))
        .try_fold(1_u64, |product, run| product.checked_mul(run.parse::<u64>().ok()?.max(1)));
    product.map(|_| ()).ok_or_else(damaged)
}

fn message(error: impl std::fmt::Display) -> TrajectoryError {
    TrajectoryError::Npy { message: error.to_string() }
}
