//! The grid: cells by voxel, merging, iteration in a fixed order.

use terrace_stats::Moments;

use crate::ahead::Ahead;
use crate::block::{BlockKey, PARTS, RECENT, place_of};
use crate::bulk::{Scratch, unit_of};
use crate::cell::{Cell, CellId};
use crate::dense::{Connectivity, DenseCells};
use crate::key::Lattice;
use crate::part::Part;
use crate::{Assignment, GridError, MAX_INDEX, VoxelKey, validate_cell_size};

/// How many cells later the memory of one is needed that is asked for.
const AHEAD: usize = 8;

/// Cells a grid can number.
pub(crate) const MOST_CELLS: usize = u32::MAX as usize - 1;

/// A sparse grid of cubic cells. See the [crate page](crate) for an example.
#[derive(Debug, Clone)]
pub struct VoxelGrid {
    pub(crate) lattice: Lattice,
    pub(crate) assignment: Assignment,
    /// By the [part](BlockKey::part) of a block.
    pub(crate) parts: Vec<Part>,
    /// Where each cell is kept, by its identity.
    pub(crate) homes: Vec<Home>,
    /// Blocks of the last points, by [`BlockKey::recent`]: scans come in order, and a surface in the face of a block is on both sides.
    last: [Met; RECENT],
    pub(crate) scratch: Scratch,
}

/// Where a cell is kept: its part, and its slot there.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Home {
    pub(crate) part: u32,
    pub(crate) slot: u32,
}

/// A block that was met: its part, and its number there.
#[derive(Debug, Clone, Copy)]
struct Met {
    key: BlockKey,
    part: u32,
    block: u32,
}

impl Met {
    const NONE: Self = Self { key: BlockKey::NOWHERE, part: 0, block: 0 };
}

/// A number that rises with keys, and is faster to compare.
#[inline]
fn in_order(key: VoxelKey) -> u128 {
    let [x, y, z] = key.map(|k| u128::from(k.cast_unsigned() ^ (1 << 31)));
    x << 64 | y << 32 | z
}

impl VoxelGrid {
    /// An empty grid of cubic cells with edges of `size` metres.
    ///
    /// # Errors
    /// [`GridError::CellSize`] when `size` is not positive and finite, see [`validate_cell_size`].
    pub fn new(size: f64, assignment: Assignment) -> Result<Self, GridError> {
        let lattice = Lattice { size: validate_cell_size(size)?, halves: false };
        Ok(Self::of_lattice(lattice, assignment))
    }

    /// An empty grid of cells with edges of half of `size` metres, for [`VoxelGrid::halved`] to make one of cells of `size` from: the
    /// sums of its cells are about the centres of those, so that they need only be added.
    ///
    /// # Errors
    /// As [`VoxelGrid::new`] for cells of `size`.
    pub fn of_halves(size: f64) -> Result<Self, GridError> {
        let lattice = Lattice { size: 0.5 * validate_cell_size(size)?, halves: true };
        Ok(Self::of_lattice(lattice, Assignment::Voxel))
    }

    pub(crate) fn of_lattice(lattice: Lattice, assignment: Assignment) -> Self {
        Self {
            lattice,
            assignment,
            parts: vec![Part::default(); PARTS],
            homes: Vec::new(),
            last: [Met::NONE; RECENT],
            scratch: Scratch::default(),
        }
    }

    /// Edge of a cell in metres.
    pub fn cell_size(&self) -> f64 {
        self.lattice.size
    }

    /// What [places](Self::insert_all) of points are whole multiples of, in metres: a power of two, between 2⁻¹⁵ and 2⁻¹⁴ of a cell.
    /// By voxel they fit into 16 bits.
    pub fn place_unit(&self) -> f64 {
        unit_of(self.lattice.size).0
    }

    /// The rule by which points are added.
    pub fn assignment(&self) -> Assignment {
        self.assignment
    }

    /// Number of cells that hold a point.
    pub fn len(&self) -> usize {
        self.homes.len()
    }

    /// Whether no point was added.
    pub fn is_empty(&self) -> bool {
        self.homes.is_empty()
    }

    /// The cell of this voxel, if it holds a point.
    pub fn find(&self, key: VoxelKey) -> Option<Cell<'_>> {
        let Home { part, slot } = self.home_of(key)?;
        let part = &self.parts[part as usize];
        Some(Cell::new(part.ids[slot as usize], &part.slots[slot], self.lattice))
    }

    /// The cell of this identity; `None` for an identity from another, larger grid.
    pub fn get(&self, id: CellId) -> Option<Cell<'_>> {
        self.homes.get(id.index()).map(|home| self.cell(id, *home))
    }

    /// Has the memory of a cell brought near, if there is one of this identity: for cells that are looked at soon, in an order that only the
    /// caller knows.
    #[inline]
    pub fn fetch(&self, id: CellId) {
        if let Some(home) = self.homes.get(id.index()) {
            Ahead::new().fetch(&self.parts[home.part as usize].slots[home.slot]);
        }
    }

    /// All cells in the order of their keys (x first, then y, then z), which does not depend on the order of insertion.
    /// Sorts them on every call.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = Cell<'_>> {
        let sorted = self.sorted(|_| true);
        sorted.into_iter().map(|(_, id)| self.cell(id, self.homes[id.index()]))
    }

    /// The dense cells, those with at least `tau` points, and which of them are directly connected.
    pub fn dense(&self, tau: u64, connectivity: Connectivity) -> DenseCells {
        DenseCells::connect(&self.sorted(|moments| moments.count() >= tau), connectivity)
    }

    /// Some of the cells in the order of their keys.
    fn sorted(&self, which: impl Fn(&Moments) -> bool) -> Vec<(VoxelKey, CellId)> {
        // Part by part, for so they lie in memory.
        let all = self.parts.iter().flat_map(Part::cells);
        let mut cells: Vec<(VoxelKey, CellId)> =
            all.filter(|(_, slot)| which(&slot.moments)).map(|(id, slot)| (slot.key, id)).collect();
        cells.sort_unstable_by_key(|(key, _)| in_order(*key));
        cells
    }

    /// Adds the points of another grid of the same cell size: cell by cell, in the order of the other's keys.
    ///
    /// With [`Assignment::Voxel`] the result is the grid of all points, whichever part they came from.
    ///
    /// # Errors
    /// [`GridError::SizesDiffer`], before anything is changed; [`GridError::Full`].
    pub fn merge(&mut self, other: &Self) -> Result<(), GridError> {
        if self.lattice.size.to_bits() != other.lattice.size.to_bits() {
            return Err(GridError::SizesDiffer { ours: self.lattice.size, theirs: other.lattice.size });
        }
        for cell in other.iter() {
            let (home, _) = self.home_or_new(cell.key())?;
            let moments = cell.moments();
            if self.lattice.halves == other.lattice.halves {
                self.moments_mut(home).merge(moments);
            } else {
                let (from, to) = (cell.anchor(), self.lattice.anchor_of(cell.key()));
                self.moments_mut(home).merge(&moments.translated([0, 1, 2].map(|i| from[i] - to[i])));
            }
        }
        Ok(())
    }

    /// Adds sums to the cell of a voxel, and founds it where there is none: a grid is put together again from its cells, in the order
    /// of [`founded`](Self::founded). The sums are relative to what [`Cell::anchor`] tells of that voxel.
    ///
    /// ```
    /// use terrace_grid::{Assignment, VoxelGrid};
    /// use terrace_stats::UncertainVector;
    ///
    /// let mut grid = VoxelGrid::new(0.1, Assignment::Voxel)?;
    /// for x in [0.01, 0.22, 0.03] {
    ///     grid.insert(&UncertainVector::exact([x, 0.0, 0.0]))?;
    /// }
    /// let mut again = VoxelGrid::new(0.1, Assignment::Voxel)?;
    /// for cell in grid.founded() {
    ///     let id = again.add_cell(cell.key(), cell.stats().moments())?;
    ///     assert_eq!(id, cell.id());
    /// }
    /// assert!(again.iter().zip(grid.iter()).all(|(a, b)| (a.key(), a.stats()) == (b.key(), b.stats())));
    /// # Ok::<(), terrace_grid::GridError>(())
    /// ```
    ///
    /// # Errors
    /// [`GridError::KeyOutOfRange`], [`GridError::Full`]; the grid is then unchanged. The sums are not checked.
    pub fn add_cell(&mut self, key: VoxelKey, sums: &Moments) -> Result<CellId, GridError> {
        if !key.iter().all(|k| (-MAX_INDEX..=MAX_INDEX).contains(k)) {
            return Err(GridError::KeyOutOfRange { key });
        }
        let (home, _) = self.home_or_new(key)?;
        self.moments_mut(home).merge(sums);
        Ok(self.id_of(home))
    }

    /// All cells in the order in which they were founded: that of [`CellId::index`].
    pub fn founded(&self) -> impl Iterator<Item = Cell<'_>> {
        let ahead = Ahead::new();
        let with_id = move |(index, home): (usize, &Home)| {
            // In this order cells are anywhere in memory.
            if let Some(later) = self.homes.get(index + AHEAD) {
                ahead.fetch(&self.parts[later.part as usize].slots[later.slot]);
            }
            Some(self.cell(CellId::from_index(index)?, *home))
        };
        self.homes.iter().enumerate().filter_map(with_id)
    }

    #[inline]
    fn cell(&self, id: CellId, home: Home) -> Cell<'_> {
        Cell::new(id, &self.parts[home.part as usize].slots[home.slot], self.lattice)
    }

    #[inline]
    pub(crate) fn moments(&self, home: Home) -> &Moments {
        &self.parts[home.part as usize].slots[home.slot].moments
    }

    #[inline]
    pub(crate) fn moments_mut(&mut self, home: Home) -> &mut Moments {
        &mut self.parts[home.part as usize].slots[home.slot].moments
    }

    #[inline]
    pub(crate) fn id_of(&self, home: Home) -> CellId {
        self.parts[home.part as usize].ids[home.slot as usize]
    }

    /// The part of a block that has a cell, and its number there.
    #[inline]
    pub(crate) fn block_of(&self, key: BlockKey) -> Option<(u32, u32)> {
        let last = self.last[key.recent()];
        if last.key == key {
            return Some((last.part, last.block));
        }
        let part = key.part();
        Some((part.into(), self.parts[usize::from(part)].block(key, key.hash())?))
    }

    /// Where the cell of this voxel is kept, if there is one.
    #[inline]
    pub(crate) fn home_of(&self, key: VoxelKey) -> Option<Home> {
        let (part, block) = self.block_of(BlockKey::of(key))?;
        let slot = self.parts[part as usize].slot(block, place_of(key))?;
        Some(Home { part, slot })
    }

    /// Where the cell of this voxel is kept, and whether it was founded for this.
    #[inline]
    pub(crate) fn home_or_new(&mut self, key: VoxelKey) -> Result<(Home, bool), GridError> {
        let block = BlockKey::of(key);
        match self.met(block, block.recent(), place_of(key)) {
            Some(home) => Ok((home, false)),
            None => self.looked_up_or_new(key[0], key[1], key[2]),
        }
    }

    /// Where the cell at a place in a block is kept, if it is a block that was met just before. `recent` is where it is remembered.
    #[inline]
    pub(crate) fn met(&self, block: BlockKey, recent: usize, place: usize) -> Option<Home> {
        let last = &self.last[recent % RECENT];
        if last.key != block {
            return None;
        }
        let slot = self.parts[last.part as usize].slot(last.block, place)?;
        Some(Home { part: last.part, slot })
    }

    /// The same, for a block or a cell that was not met just before. The key is handed over in registers: as an array it is written to
    /// memory by all who might call this, number by number, and read at once, which the processor has to wait for.
    #[inline(never)]
    fn looked_up_or_new(&mut self, x: i32, y: i32, z: i32) -> Result<(Home, bool), GridError> {
        let key = [x, y, z];
        let block_key = BlockKey::of(key);
        let (part, block) = match self.block_of(block_key) {
            Some(known) => known,
            None if self.homes.len() < MOST_CELLS => {
                let part = block_key.part();
                let block = self.parts[usize::from(part)].block_or_new(block_key, block_key.hash());
                (part.into(), block)
            }
            None => return Err(GridError::Full { cells: self.homes.len() }),
        };
        self.last[block_key.recent()] = Met { key: block_key, part, block };
        let place = place_of(key);
        if let Some(slot) = self.parts[part as usize].slot(block, place) {
            return Ok((Home { part, slot }, false));
        }
        let full = GridError::Full { cells: self.homes.len() };
        let id = CellId::from_index(self.homes.len()).filter(|id| id.index() < MOST_CELLS).ok_or(full)?;
        let in_part = &mut self.parts[part as usize];
        let home = Home { part, slot: in_part.found(block, place, key) };
        in_part.ids.push(id);
        self.homes.push(home);
        Ok((home, true))
    }
}
