//! Some points and where they are in a grid, before they are in it.

use super::locate::{BATCH, Located, Place};
use super::present::Present;
use super::{Motion, PointErrors, Taken};
use crate::key::Lattice;
use crate::{CellId, VoxelKey};

/// Up to [`BATCH`] points.
#[derive(Debug)]
pub(super) struct Batch {
    located: Located,
    present: Present,
    points: usize,
    /// How many can be inserted; these are in front.
    left: usize,
}

impl Batch {
    pub(super) fn new() -> Self {
        Self { located: Located::new(), present: Present::new(), points: 0, left: 0 }
    }

    /// Finds the voxels of some points, where a motion takes them, and counts those that cannot be inserted.
    #[allow(clippy::inline_always, reason = "a loop that knows its caller")]
    #[inline(always)]
    pub(super) fn locate(
        &mut self,
        points: &[[f64; 3]],
        (motion, moved): (Option<&Motion<'_>>, &mut [[f64; 3]; BATCH]),
        errors: &PointErrors<'_>,
        lattice: Lattice,
        taken: &mut Taken,
    ) {
        let moved = &mut moved[..points.len()];
        let points = motion.map_or(points, |motion| {
            motion(points, moved);
            moved
        });
        self.points = points.len();
        self.left = points.len();
        if !(self.located.locate(points, lattice) && errors.are_valid()) {
            self.located.refuse(points, errors, lattice, taken);
            self.left = self.present.gather(&mut self.located, points.len(), errors);
        }
    }

    /// How many points there are.
    pub(super) fn len(&self) -> usize {
        self.points
    }

    /// The voxels of the points that can be inserted.
    pub(super) fn keys(&self) -> &[VoxelKey] {
        &self.located.keys[..self.left]
    }

    /// Where these are from the anchors of their voxels.
    pub(super) fn local(&self) -> &[[f64; 3]] {
        &self.located.local
    }

    /// Where all are, in whole units.
    pub(super) fn places(&self) -> &[Place] {
        &self.located.places[..self.points]
    }

    /// The errors of those that can be inserted, of those of all.
    pub(super) fn errors<'e>(&'e self, errors: &PointErrors<'e>) -> PointErrors<'e> {
        if self.left == self.points { *errors } else { self.present.errors(errors) }
    }

    /// Appends the cells of all points by those of the ones that were inserted.
    pub(super) fn append(&self, found: &[Option<CellId>], cells: &mut Vec<Option<CellId>>) {
        if self.left == self.points {
            cells.extend_from_slice(found);
        } else {
            cells.extend_from_slice(&self.present.spread(found)[..self.points]);
        }
    }
}
