//! The same points in larger cells.

use crate::cell::CellId;
use crate::key::Lattice;
use crate::{GridError, VoxelGrid, validate_cell_size};

impl VoxelGrid {
    /// The grid of half the resolution, and for each cell, by [`CellId::index`], the cell it became part of.
    ///
    /// The edge is twice as long, and each cell is the sum of the up to eight cells in it: added, and the new cells
    /// numbered, in the order in which they were founded. With [`Assignment::Voxel`](crate::Assignment::Voxel) these are
    /// the cells that the points themselves would found, up to rounding of the sums.
    ///
    /// ```
    /// use terrace_grid::{Assignment, VoxelGrid};
    /// use terrace_stats::UncertainVector;
    ///
    /// let mut fine = VoxelGrid::new(0.5, Assignment::Voxel)?;
    /// for x in [-0.1, 0.1, 0.6] {
    ///     fine.insert(&UncertainVector::exact([x, 0.0, 0.0]))?;
    /// }
    /// let (coarse, of_cell) = fine.halved()?;
    /// assert_eq!((fine.len(), coarse.len(), coarse.cell_size()), (3, 2, 1.0));
    /// assert_eq!(of_cell[1], of_cell[2]);
    /// # Ok::<(), terrace_grid::GridError>(())
    /// ```
    ///
    /// # Errors
    /// [`GridError::CellSize`] when twice the edge is no edge of a voxel.
    pub fn halved(&self) -> Result<(Self, Vec<CellId>), GridError> {
        let size = if self.lattice.halves {
            2.0 * self.lattice.size
        } else {
            validate_cell_size(2.0 * self.lattice.size)?
        };
        let mut coarse = Self::of_lattice(Lattice { size, halves: false }, self.assignment);
        let mut of_cell = Vec::with_capacity(self.len());
        for cell in self.founded() {
            let key = cell.key().map(|k| k >> 1);
            let (home, _) = coarse.home_or_new(key)?;
            if self.lattice.halves {
                coarse.moments_mut(home).merge(cell.moments());
            } else {
                let (from, to) = (cell.anchor(), coarse.lattice.anchor_of(key));
                let apart = [0, 1, 2].map(|i| from[i] - to[i]);
                coarse.moments_mut(home).merge(&cell.moments().translated(apart));
            }
            of_cell.push(coarse.id_of(home));
        }
        Ok((coarse, of_cell))
    }
}
