//! Cells and what tells them apart.

use std::num::NonZeroU32;

use terrace_stats::{Moments, Stats};

use crate::VoxelKey;
use crate::key::{Lattice, centre_of};

/// Identity of a cell within its grid, stable as the grid grows. `Option<CellId>` takes four bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct CellId(NonZeroU32);

impl CellId {
    /// Place of the cell in the order in which cells were founded, from 0: for lists kept beside the grid.
    #[inline]
    pub fn index(self) -> usize {
        self.0.get() as usize - 1
    }

    #[inline]
    pub(crate) fn from_index(index: usize) -> Option<Self> {
        u32::try_from(index).ok()?.checked_add(1).and_then(NonZeroU32::new).map(Self)
    }
}

/// What a grid keeps of a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Slot {
    pub(crate) key: VoxelKey,
    /// Relative to the anchor of the voxel.
    pub(crate) moments: Moments,
}

/// A cell of a grid: its place and the statistics of its points.
#[derive(Debug, Clone, Copy)]
pub struct Cell<'a> {
    id: CellId,
    slot: &'a Slot,
    lattice: Lattice,
}

impl<'a> Cell<'a> {
    #[inline]
    pub(crate) fn new(id: CellId, slot: &'a Slot, lattice: Lattice) -> Self {
        Self { id, slot, lattice }
    }

    /// Identity within the grid.
    pub fn id(&self) -> CellId {
        self.id
    }

    /// Index of the voxel.
    pub fn key(&self) -> VoxelKey {
        self.slot.key
    }

    /// Centre of the voxel in metres.
    pub fn centre(&self) -> [f64; 3] {
        centre_of(self.slot.key, self.lattice.size)
    }

    /// What the statistics are relative to, in metres: the centre, or, in a grid [of halves](crate::VoxelGrid::of_halves), that of the
    /// larger voxel.
    pub fn anchor(&self) -> [f64; 3] {
        self.lattice.anchor_of(self.slot.key)
    }

    /// Number of points.
    pub fn density(&self) -> u64 {
        self.slot.moments.count()
    }

    /// Statistics of the points.
    pub fn stats(&self) -> Stats {
        Stats::from_moments(self.anchor(), self.slot.moments)
    }

    /// The sums of the points about the [anchor](Self::anchor).
    pub fn moments(&self) -> &'a Moments {
        &self.slot.moments
    }
}
