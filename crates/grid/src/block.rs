//! Blocks of 8×8×8 voxels.

use std::hash::{BuildHasher, Hash, Hasher};

use foldhash::fast::FixedState;

use crate::VoxelKey;

/// Voxels along an edge of a block, as a power of two.
const BITS: u32 = 3;

/// Voxels of a block.
pub(crate) const VOXELS: usize = 1 << (3 * BITS);

/// Parts of a grid, so many that the cells of one stay in the cache. Each block is of one of them, told by its key.
pub(crate) const PARTS: usize = 128;

/// Places for blocks that are remembered.
pub(crate) const RECENT: usize = 64;

/// Index of a block along x, y and z.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct BlockKey([i32; 3]);

impl BlockKey {
    /// That of no block.
    pub(crate) const NOWHERE: Self = Self([i32::MAX; 3]);

    /// The block of a voxel.
    #[inline]
    pub(crate) fn of(key: VoxelKey) -> Self {
        Self(key.map(|k| k >> BITS))
    }

    /// Where it is remembered: not where any of the blocks are that share a face, an edge or a corner with it.
    #[inline]
    pub(crate) fn recent(self) -> usize {
        let [x, y, z] = self.0.map(|k| k.cast_unsigned() & 3);
        (x | y << 2 | z << 4) as usize
    }

    /// The same for every grid and every run.
    #[inline]
    pub(crate) fn hash(self) -> u64 {
        FixedState::default().hash_one(self)
    }
}

impl Hash for BlockKey {
    #[inline]
    fn hash<H: Hasher>(&self, state: &mut H) {
        let [x, y, z] = self.0.map(i32::cast_unsigned);
        state.write_u64(u64::from(x) << 32 | u64::from(y));
        state.write_u32(z);
    }
}

/// The part a block of this hash is of. The lowest and the highest bits tell its place in a table.
#[inline]
pub(crate) fn part_of(hash: u64) -> usize {
    (hash >> 40) as usize % PARTS
}

/// The place of a voxel in its block.
#[inline]
pub(crate) fn place_of(key: VoxelKey) -> usize {
    let [x, y, z] = key.map(|k| k.cast_unsigned() % (1 << BITS));
    ((x << BITS | y) << BITS | z) as usize
}
