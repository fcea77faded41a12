//! What a grid refuses.

use crate::{MAX_CELL_SIZE, MIN_CELL_SIZE, VoxelKey};

/// Why a grid could not be made, or a point or another grid not be added.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum GridError {
    /// The edge of a voxel must be a number of metres from [`MIN_CELL_SIZE`] to [`MAX_CELL_SIZE`].
    #[error("the cell size {size} m is not a length from {MIN_CELL_SIZE:e} to {MAX_CELL_SIZE:e} m")]
    CellSize {
        /// The size as given.
        size: f64,
    },
    /// A coordinate is NaN or infinite. Leave absent measurements out.
    #[error("the point ({}, {}, {}) is not finite", position[0], position[1], position[2])]
    PointNotFinite {
        /// The point as given.
        position: [f64; 3],
    },
    /// The point is more than [`MAX_INDEX`](crate::MAX_INDEX) voxels away from the origin. Coordinates or cell size may be in the wrong unit.
    #[error(
        "the point ({}, {}, {}) is too many cells of {size} m from the origin",
        position[0], position[1], position[2]
    )]
    OutOfRange {
        /// The point as given.
        position: [f64; 3],
        /// The edge of a voxel.
        size: f64,
    },
    /// The index of a voxel is above [`MAX_INDEX`](crate::MAX_INDEX) in absolute value.
    #[error("the voxel ({}, {}, {}) is too many cells from the origin", key[0], key[1], key[2])]
    KeyOutOfRange {
        /// The index as given.
        key: VoxelKey,
    },
    /// A standard error is NaN, infinite or negative.
    #[error("the standard error ({}, {}, {}) is not finite and at least 0", error[0], error[1], error[2])]
    StandardError {
        /// The error as given.
        error: [f64; 3],
    },
    /// A covariance is not finite, or a variance on its diagonal is negative.
    #[error("the covariance {covariance:?} (xx, xy, xz, yy, yz, zz) is not finite with variances from 0 up")]
    Covariance {
        /// The six entries as given.
        covariance: [f64; 6],
    },
    /// A weight must be positive and finite.
    #[error("the weight {weight} is not positive and finite")]
    Weight {
        /// The weight as given.
        weight: f64,
    },
    /// The grid holds as many cells as it can number.
    #[error("the grid is full at {cells} cells; use larger cells or several grids")]
    Full {
        /// Number of cells held.
        cells: usize,
    },
    /// There are errors for another number of points.
    #[error("there are {errors} errors for {points} points")]
    Lengths {
        /// Number of points.
        points: usize,
        /// Number of errors.
        errors: usize,
    },
    /// Only grids with the same cell size can be merged.
    #[error("a grid of {theirs} m cells cannot be merged into one of {ours} m cells")]
    SizesDiffer {
        /// The cell size of the grid merged into.
        ours: f64,
        /// The cell size of the other grid.
        theirs: f64,
    },
}
