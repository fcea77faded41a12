//! The grid: cells by voxel, insertion by either rule, merging, iteration in a fixed order.

use std::num::NonZeroU32;

use foldhash::fast::FixedState;
use hashbrown::HashMap;
use terrace_stats::{Moments, Stats, SymmetricMatrix3, UncertainVector};

use crate::dense::{Connectivity, DenseCells};
use crate::key::{centre_of, key_of};
use crate::{GridError, VoxelKey, validate_cell_size};

/// Which cell a point is added to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Assignment {
    /// The cell of the voxel the point lies in. Independent of the order of points.
    #[default]
    Voxel,
    /// The paper's rule (section III-A, Eq. 3): a point in an empty voxel founds a cell there; otherwise it joins, of
    /// its own voxel and the occupied ones among the 26 around it, the cell with the smallest expected squared
    /// distance to its virtual centre. Ties go to the point's own voxel, then to the smaller key. Depends on the order
    /// of points.
    ExpectedDistance,
}

/// Identity of a cell within its grid, stable as the grid grows. `Option<CellId>` takes four bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct CellId(NonZeroU32);

impl CellId {
    /// Place of the cell in the order in which cells were founded, from 0: for lists kept beside the grid.
    pub fn index(self) -> usize {
        self.0.get() as usize - 1
    }

    fn from_index(index: u32) -> Option<Self> {
        NonZeroU32::new(index.checked_add(1)?).map(Self)
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Slot {
    key: VoxelKey,
    /// Relative to the centre of the voxel.
    moments: Moments,
}

/// A sparse grid of cubic cells. See the [crate page](crate) for an example.
#[derive(Debug, Clone)]
pub struct VoxelGrid {
    size: f64,
    assignment: Assignment,
    slots: Vec<Slot>,
    index: HashMap<VoxelKey, u32, FixedState>,
    /// The voxel of the last point: scans come in order, so the next point is often there too.
    last: Option<(VoxelKey, u32)>,
}

/// A cell of a grid: its place and the statistics of its points.
#[derive(Debug, Clone, Copy)]
pub struct Cell<'a> {
    id: CellId,
    slot: &'a Slot,
    size: f64,
}

impl Cell<'_> {
    /// Identity within the grid.
    pub fn id(&self) -> CellId {
        self.id
    }

    /// Index of the voxel.
    pub fn key(&self) -> VoxelKey {
        self.slot.key
    }

    /// Centre of the voxel in metres: the anchor of the statistics.
    pub fn centre(&self) -> [f64; 3] {
        centre_of(self.slot.key, self.size)
    }

    /// Number of points.
    pub fn density(&self) -> u64 {
        self.slot.moments.count()
    }

    /// Statistics of the points.
    pub fn stats(&self) -> Stats {
        Stats::from_moments(self.centre(), self.slot.moments)
    }
}

impl VoxelGrid {
    /// An empty grid of cubic cells with edges of `size` metres.
    ///
    /// # Errors
    /// [`GridError::CellSize`] when `size` is not positive and finite, see [`validate_cell_size`].
    pub fn new(size: f64, assignment: Assignment) -> Result<Self, GridError> {
        let size = validate_cell_size(size)?;
        Ok(Self { size, assignment, slots: Vec::new(), index: HashMap::default(), last: None })
    }

    /// Edge of a cell in metres.
    pub fn cell_size(&self) -> f64 {
        self.size
    }

    /// The rule by which points are added.
    pub fn assignment(&self) -> Assignment {
        self.assignment
    }

    /// Number of cells that hold a point.
    pub fn len(&self) -> usize {
        self.slots.len()
    }

    /// Whether no point was added.
    pub fn is_empty(&self) -> bool {
        self.slots.is_empty()
    }

    /// Adds a point with weight 1 and returns its cell.
    ///
    /// # Errors
    /// [`GridError`] for a point or error that is not finite, a negative error, a point out of range, a full grid. The
    /// grid is then unchanged.
    #[inline]
    pub fn insert(&mut self, point: &UncertainVector) -> Result<CellId, GridError> {
        let (slot, local) = self.place(point)?;
        self.slots[slot as usize].moments.push(&local);
        CellId::from_index(slot).ok_or(GridError::Full { cells: self.slots.len() })
    }

    /// Adds a point with weight 1 whose error has this covariance, in m², and returns its cell. The rule of assignment
    /// looks at its diagonal.
    ///
    /// # Errors
    /// As [`VoxelGrid::insert`], and for a covariance that is not finite or has a negative variance.
    #[inline]
    pub fn insert_covariant(
        &mut self,
        point: [f64; 3],
        covariance: &SymmetricMatrix3,
    ) -> Result<CellId, GridError> {
        if !covariance.is_finite() || covariance.diagonal_entries().iter().any(|variance| *variance < 0.0) {
            return Err(GridError::Covariance { covariance: covariance.0 });
        }
        let error = covariance.diagonal_entries().map(f64::sqrt);
        let (slot, local) = self.place(&UncertainVector { value: point, error })?;
        self.slots[slot as usize].moments.push_covariant(local.value, covariance);
        CellId::from_index(slot).ok_or(GridError::Full { cells: self.slots.len() })
    }

    /// Adds a point with a weight, such as `1/σ²`, and returns its cell.
    ///
    /// # Errors
    /// As [`VoxelGrid::insert`], and for a weight that is not positive and finite.
    pub fn insert_weighted(&mut self, point: &UncertainVector, weight: f64) -> Result<CellId, GridError> {
        if !(weight > 0.0 && weight.is_finite()) {
            return Err(GridError::Weight { weight });
        }
        let (slot, local) = self.place(point)?;
        self.slots[slot as usize].moments.push_weighted(&local, weight);
        CellId::from_index(slot).ok_or(GridError::Full { cells: self.slots.len() })
    }

    /// The slot that `point` belongs to, and the point relative to its centre.
    #[inline]
    fn place(&mut self, point: &UncertainVector) -> Result<(u32, UncertainVector), GridError> {
        if !point.error.iter().all(|e| e.is_finite() && *e >= 0.0) {
            return Err(GridError::StandardError { error: point.error });
        }
        let key = key_of(point.value, self.size)?;
        let known = match self.last {
            Some((last, slot)) if last == key => Some(slot),
            _ => self.index.get(&key).copied(),
        };
        let own = known.map_or_else(|| self.found(key), Ok)?;
        self.last = Some((key, own));
        let slot = match (known, self.assignment) {
            (Some(_), Assignment::ExpectedDistance) => self.nearest(key, own, point),
            _ => own,
        };
        Ok((slot, self.local(slot, point)))
    }

    fn found(&mut self, key: VoxelKey) -> Result<u32, GridError> {
        let slot = u32::try_from(self.slots.len())
            .ok()
            .filter(|slot| *slot < u32::MAX - 1)
            .ok_or(GridError::Full { cells: self.slots.len() })?;
        self.slots.push(Slot { key, moments: Moments::EMPTY });
        self.index.insert(key, slot);
        Ok(slot)
    }

    #[inline]
    fn local(&self, slot: u32, point: &UncertainVector) -> UncertainVector {
        let centre = centre_of(self.slots[slot as usize].key, self.size);
        UncertainVector { value: [0, 1, 2].map(|i| point.value[i] - centre[i]), error: point.error }
    }

    /// The cell around `key` with the smallest expected squared distance, `own` on a tie.
    fn nearest(&self, key: VoxelKey, own: u32, point: &UncertainVector) -> u32 {
        let distance = |slot: u32| {
            let local = self.local(slot, point);
            self.slots[slot as usize].moments.expected_squared_distance(&local).unwrap_or(f64::INFINITY)
        };
        let mut best = (distance(own), own);
        for dx in -1..=1 {
            for dy in -1..=1 {
                for dz in -1..=1 {
                    let around = [key[0] + dx, key[1] + dy, key[2] + dz];
                    if let Some(slot) = self.index.get(&around) {
                        let expected = distance(*slot);
                        if expected < best.0 {
                            best = (expected, *slot);
                        }
                    }
                }
            }
        }
        best.1
    }

    /// Adds the points of another grid of the same cell size: cell by cell, in the order of the other's keys.
    ///
    /// With [`Assignment::Voxel`] the result is the grid of all points, whichever part they came from.
    ///
    /// # Errors
    /// [`GridError::SizesDiffer`], before anything is changed; [`GridError::Full`].
    pub fn merge(&mut self, other: &Self) -> Result<(), GridError> {
        if self.size.to_bits() != other.size.to_bits() {
            return Err(GridError::SizesDiffer { ours: self.size, theirs: other.size });
        }
        for cell in other.iter() {
            let slot = match self.index.get(&cell.key()) {
                Some(slot) => *slot,
                None => self.found(cell.key())?,
            };
            self.slots[slot as usize].moments.merge(&cell.slot.moments);
        }
        Ok(())
    }

    /// The cell of this voxel, if it holds a point.
    pub fn find(&self, key: VoxelKey) -> Option<Cell<'_>> {
        let slot = *self.index.get(&key)?;
        self.get(CellId::from_index(slot)?)
    }

    /// The cell of this identity; `None` for an identity from another, larger grid.
    pub fn get(&self, id: CellId) -> Option<Cell<'_>> {
        self.slots.get(id.index()).map(|slot| Cell { id, slot, size: self.size })
    }

    /// All cells in the order of their keys (x first, then y, then z), which does not depend on the order of insertion.
    /// Sorts them on every call.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = Cell<'_>> {
        let mut cells: Vec<_> = self.founded().collect();
        cells.sort_unstable_by_key(Cell::key);
        cells.into_iter()
    }

    /// The dense cells, those with at least `tau` points, and which of them are directly connected.
    pub fn dense(&self, tau: u64, connectivity: Connectivity) -> DenseCells {
        let mut cells: Vec<_> =
            self.founded().filter(|c| c.density() >= tau).map(|c| (c.key(), c.id())).collect();
        cells.sort_unstable();
        DenseCells::connect(&cells, connectivity)
    }

    fn founded(&self) -> impl Iterator<Item = Cell<'_>> {
        (0u32..)
            .zip(&self.slots)
            .filter_map(|(index, slot)| Some(Cell { id: CellId::from_index(index)?, slot, size: self.size }))
    }
}
