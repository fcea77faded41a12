//! Which cells a grid has.

use crate::slots::Slots;
use crate::{CellId, VoxelGrid};

/// The cells of a grid without the sums of their points, which are most of its memory: it still tells of which cell a point is.
///
/// ```
/// use terrace_grid::{Assignment, PointErrors, VoxelGrid};
///
/// let points = [[0.01, 0.02, 0.0], [0.13, 0.02, 0.0], [9.0, 0.0, 0.0]];
/// let mut grid = VoxelGrid::new(0.1, Assignment::Voxel)?;
/// let (mut cells, mut again, mut places) = (Vec::new(), Vec::new(), Vec::new());
/// grid.insert_all(&points[..2], PointErrors::Same(0.005), &mut cells, None)?;
/// let index = grid.into_index();
/// index.find_all(&points, &mut again, &mut places);
/// assert_eq!((index.len(), &again[..2], again[2]), (2, &cells[..], None));
/// # Ok::<(), terrace_grid::GridError>(())
/// ```
#[derive(Debug, Clone)]
pub struct CellIndex {
    /// Without its sums.
    grid: VoxelGrid,
    len: usize,
}

impl VoxelGrid {
    /// Forgets the sums.
    #[must_use]
    pub fn into_index(mut self) -> CellIndex {
        let len = self.len();
        self.parts.iter_mut().for_each(|part| part.slots = Slots::default());
        (self.homes, self.scratch) = Default::default();
        CellIndex { grid: self, len }
    }
}

impl CellIndex {
    /// Number of cells.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// As [`VoxelGrid::find_all`] of the grid it was.
    pub fn find_all(&self, points: &[[f64; 3]], cells: &mut Vec<Option<CellId>>, places: &mut Vec<[f32; 3]>) {
        self.grid.find_all(points, cells, places);
    }
}
