//! Voxel indices and the cell size.

use crate::GridError;

/// Index of a voxel along x, y and z: the point `p` lies in the voxel `floor(p / size)`.
pub type VoxelKey = [i32; 3];

/// Largest voxel index, in absolute value, along each axis: a billion. Enough for one centimetre cells at ten million
/// metres from the origin, with room for neighbours.
pub const MAX_INDEX: i32 = 1_000_000_000;

/// Smallest edge of a voxel in metres. Far below any use: statistics hold squares of lengths, and below it those would be
/// lost.
pub const MIN_CELL_SIZE: f64 = 1e-100;

/// Largest edge of a voxel in metres. Far above any use: beyond it squares of lengths would not be finite.
pub const MAX_CELL_SIZE: f64 = 1e100;

/// Whether `size` can be the edge of a voxel: from [`MIN_CELL_SIZE`] to [`MAX_CELL_SIZE`].
///
/// # Errors
/// [`GridError::CellSize`] otherwise.
pub fn validate_cell_size(size: f64) -> Result<f64, GridError> {
    if (MIN_CELL_SIZE..=MAX_CELL_SIZE).contains(&size) { Ok(size) } else { Err(GridError::CellSize { size }) }
}

/// The voxel of a position.
#[inline]
pub(crate) fn key_of(position: [f64; 3], size: f64) -> Result<VoxelKey, GridError> {
    let index = position.map(|x| (x / size).floor());
    if index.iter().all(|i| i.abs() <= f64::from(MAX_INDEX)) {
        // In range by the test above, so nothing is cut off.
        #[allow(clippy::cast_possible_truncation)]
        return Ok(index.map(|i| i as i32));
    }
    if position.iter().all(|x| x.is_finite()) {
        Err(GridError::OutOfRange { position, size })
    } else {
        Err(GridError::PointNotFinite { position })
    }
}

/// The centre of a voxel, in metres.
#[inline]
pub(crate) fn centre_of(key: VoxelKey, size: f64) -> [f64; 3] {
    key.map(|k| (f64::from(k) + 0.5) * size)
}

/// Where voxels are, and what the sums of each are relative to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Lattice {
    /// The edge of a voxel, in metres.
    pub(crate) size: f64,
    /// Whether sums are about the centre of the voxel of twice the edge that a voxel is in.
    pub(crate) halves: bool,
}

impl Lattice {
    #[inline]
    pub(crate) fn anchor_of(&self, key: VoxelKey) -> [f64; 3] {
        if self.halves { centre_of(key.map(|k| k >> 1), 2.0 * self.size) } else { centre_of(key, self.size) }
    }
}
