//! A sparse, growing voxel grid of additive point statistics.
//!
//! Points are not kept: each cell holds the [`Stats`](terrace_stats::Stats) of its points, relative to the centre of its
//! voxel, so that a grid at UTM coordinates is as exact as one at the origin. Memory is taken only where points are
//! ("Density grid", section III-A of "An Optimization Approach for 3D Environment Mapping using Normal Vector
//! Uncertainty"). Cells with enough points are *dense* ([`VoxelGrid::dense`]), and the dense cells form a graph
//! ([`DenseCells`]) whose neighbourhoods are those of the paper's Definition 2.
//!
//! ```
//! use terrace_grid::{Assignment, Connectivity, VoxelGrid};
//! use terrace_stats::UncertainVector;
//!
//! let mut grid = VoxelGrid::new(0.1, Assignment::Voxel)?;
//! for i in 0..30 {
//!     grid.insert(&UncertainVector::isotropic([0.01 * f64::from(i), 0.0, -0.02], 0.005))?;
//! }
//! assert_eq!(grid.len(), 3);
//!
//! // In order of keys, whatever the order of insertion.
//! let keys: Vec<_> = grid.iter().map(|cell| cell.key()).collect();
//! assert_eq!(keys, [[0, 0, -1], [1, 0, -1], [2, 0, -1]]);
//!
//! let dense = grid.dense(5, Connectivity::Faces);
//! assert_eq!(dense.neighbours(1), [0, 2]);
//! # Ok::<(), terrace_grid::GridError>(())
//! ```
//!
//! # Two rules of assignment
//! [`Assignment::Voxel`]: a point belongs to the voxel it lies in. The result does not depend on the order of points,
//! and grids of parts merge into the grid of the whole. [`Assignment::ExpectedDistance`]: the paper's rule, by the
//! smallest expected squared distance to the virtual centres around; it depends on the order of points.
//!
//! # Many points
//! [`VoxelGrid::insert_all`] takes a scan at once, on all threads and with the bits of point by point, and tells the cell of
//! each point and where in it the point is. [`VoxelGrid::halved`] makes cells of twice the edge from the sums.
//!
//! # Errors and limits
//! Cell sizes that are not lengths ([`validate_cell_size`]) are refused, and so are points that are not finite or
//! further than [`MAX_INDEX`] voxels from the origin: see [`GridError`]. Nothing panics on such input, and a refused
//! point leaves the grid as it was. A grid holds at most 2³² − 2 cells.

mod ahead;
mod assignment;
mod block;
mod bulk;
mod cell;
mod dense;
mod error;
mod grid;
mod halved;
mod index;
mod insert;
mod key;
mod neighbourhood;
mod part;
mod slots;

pub use assignment::Assignment;
pub use bulk::{Locator, Motion, PointErrors, PointVoxels, Taken};
pub use cell::{Cell, CellId};
pub use dense::{Connectivity, DenseCells};
pub use error::GridError;
pub use grid::VoxelGrid;
pub use index::CellIndex;
pub use key::{MAX_CELL_SIZE, MAX_INDEX, MIN_CELL_SIZE, VoxelKey, validate_cell_size};
pub use neighbourhood::Walk;

/// The examples of the README are tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
