//! The voxels of points, found by one thread while another inserts those before.

use super::batch::Batch;
use super::locate::BATCH;
use super::{Motion, PointErrors, Taken};
use crate::key::Lattice;
use crate::{Assignment, CellId, GridError, VoxelGrid};

/// Where points are in a grid, before they are in it: see [`VoxelGrid::locator`]. Memory is kept from one use to the next.
#[derive(Debug, Default)]
pub struct PointVoxels {
    batches: Vec<Batch>,
    places: Vec<[i16; 3]>,
    /// Of the points that cannot be inserted.
    refused: Taken,
    /// Of the grid, and how many numbers there were for the error of a point.
    of: Option<(Lattice, usize)>,
}

/// Finds where points are in a grid that others add points to.
#[derive(Debug, Clone, Copy)]
pub struct Locator {
    lattice: Lattice,
}

impl Locator {
    /// Finds the voxels of points, where the motion takes them, for [`VoxelGrid::insert_located`], and the places of points there.
    ///
    /// # Errors
    /// [`GridError::Lengths`] when there are not as many errors as points; nothing is changed then.
    pub fn locate(
        &self,
        points: &[[f64; 3]],
        motion: Option<&Motion<'_>>,
        errors: PointErrors<'_>,
        to: &mut PointVoxels,
    ) -> Result<(), GridError> {
        errors.require(points.len())?;
        to.of = Some((self.lattice, errors.width()));
        to.refused = Taken::default();
        to.places.clear();
        to.batches.resize_with(points.len().div_ceil(BATCH), Batch::new);
        let mut moved = [[0.0; 3]; BATCH];
        for (number, (batch, points)) in to.batches.iter_mut().zip(points.chunks(BATCH)).enumerate() {
            let begin = number * BATCH;
            let errors = errors.part(begin..begin + points.len());
            batch.locate(points, (motion, &mut moved), &errors, self.lattice, &mut to.refused);
            to.places.extend_from_slice(batch.places());
        }
        Ok(())
    }
}

impl PointVoxels {
    /// Where each point is from the [anchor](crate::Cell::anchor) of its voxel, as [`VoxelGrid::insert_all`] tells it: in whole
    /// [units](VoxelGrid::place_unit), 0 if it is refused.
    pub fn places(&self) -> &[[i16; 3]] {
        &self.places
    }
}

impl VoxelGrid {
    /// What finds the voxels of points for this grid, also while others are inserted; `None` where the cell of a point depends on the
    /// points before it ([`Assignment::ExpectedDistance`]).
    ///
    /// ```
    /// use terrace_grid::{Assignment, PointErrors, PointVoxels, VoxelGrid};
    ///
    /// let [first, second] = [[[0.01, 0.02, 0.0], [0.03, 0.02, 0.0]], [[0.02, 0.01, 0.0], [0.11, 0.02, 0.0]]];
    /// let errors = PointErrors::Same(0.005);
    /// let mut grid = VoxelGrid::new(0.1, Assignment::Voxel)?;
    /// let (mut cells, mut voxels) = (Vec::new(), PointVoxels::default());
    /// if let Some(locator) = grid.locator() {
    ///     std::thread::scope(|scope| {
    ///         scope.spawn(|| locator.locate(&second, None, errors, &mut voxels));
    ///         grid.insert_alone(&first, None, errors, &mut cells, None)
    ///     })?;
    ///     grid.insert_located(&voxels, (&second, None), errors, &mut cells)?;
    /// }
    /// assert_eq!((cells.len(), grid.len()), (4, 2));
    /// # Ok::<(), terrace_grid::GridError>(())
    /// ```
    pub fn locator(&self) -> Option<Locator> {
        (self.assignment == Assignment::Voxel).then_some(Locator { lattice: self.lattice })
    }

    /// As [`insert_alone`](Self::insert_alone), to the bit, with less left to do: the voxels are known. They are to be those that a [`Locator`] of
    /// this grid found for the same points, motion and errors; of a grid of other cells, of another number of points, or of errors of another
    /// kind, they are found again.
    ///
    /// # Errors
    /// As [`insert_all`](Self::insert_all).
    pub fn insert_located(
        &mut self,
        voxels: &PointVoxels,
        (points, motion): (&[[f64; 3]], Option<&Motion<'_>>),
        errors: PointErrors<'_>,
        cells: &mut Vec<Option<CellId>>,
    ) -> Result<Taken, GridError> {
        let PointVoxels { batches, places, refused, of } = voxels;
        let is_of_these = *of == Some((self.lattice, errors.width())) && places.len() == points.len();
        // Where cells may run out, the first points get them, as one by one.
        if !(is_of_these && self.has_room(points.len())) {
            return self.insert_alone(points, motion, errors, cells, None);
        }
        errors.require(points.len())?;
        cells.reserve(points.len());
        let points = self.insert_batches(batches, &errors, cells);
        Ok(Taken { points, ..*refused })
    }
}
