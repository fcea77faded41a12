//! A part of a grid: the cells of some of its blocks, which no other part touches.

use hashbrown::HashTable;
use terrace_stats::Moments;

use crate::VoxelKey;
use crate::block::{BlockKey, VOXELS};
use crate::cell::{CellId, Slot};
use crate::slots::Slots;

/// The cells of some blocks.
#[derive(Debug, Clone, Default)]
pub(crate) struct Part {
    blocks: HashTable<(BlockKey, u32)>,
    /// For each voxel of each block one more than the number of its slot, or 0.
    tables: Vec<[u32; VOXELS]>,
    pub(crate) slots: Slots,
    /// Beside the slots: who they are in the grid. Those founded by a bulk insertion are told at its end.
    pub(crate) ids: Vec<CellId>,
}

impl Part {
    /// The number of a block that has a cell.
    #[inline]
    pub(crate) fn block(&self, key: BlockKey, hash: u64) -> Option<u32> {
        self.blocks.find(hash, |(other, _)| *other == key).map(|(_, block)| *block)
    }

    /// The number of a block, which is made if there is none.
    #[inline]
    pub(crate) fn block_or_new(&mut self, key: BlockKey, hash: u64) -> u32 {
        self.block(key, hash).unwrap_or_else(|| self.new_block(key, hash))
    }

    #[cold]
    fn new_block(&mut self, key: BlockKey, hash: u64) -> u32 {
        // A block holds a cell, and a grid numbers its cells with 32 bits.
        #[allow(clippy::cast_possible_truncation)]
        let block = self.tables.len() as u32;
        self.tables.push([0; VOXELS]);
        self.blocks.insert_unique(hash, (key, block), |(other, _)| other.hash());
        block
    }

    /// The slot of a voxel of a block.
    #[inline]
    pub(crate) fn slot(&self, block: u32, place: usize) -> Option<u32> {
        self.tables[block as usize][place % VOXELS].checked_sub(1)
    }

    /// Its cells in the order in which they were founded.
    pub(crate) fn cells(&self) -> impl Iterator<Item = (CellId, &Slot)> {
        self.ids.iter().copied().zip(self.slots.iter())
    }

    /// A slot for a voxel that has none. The caller tells who it is.
    #[inline]
    pub(crate) fn found(&mut self, block: u32, place: usize, key: VoxelKey) -> u32 {
        // A grid numbers its cells with 32 bits.
        #[allow(clippy::cast_possible_truncation)]
        let slot = self.slots.len() as u32;
        self.slots.push(Slot { key, moments: Moments::EMPTY });
        self.tables[block as usize][place] = slot + 1;
        slot
    }
}
