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
const _: () =
    assert!(PARTS.is_power_of_two() && PARTS <= 256, "a part is told by the highest bits, in a byte");

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

    /// The part it is of: without a branch, so that those of several are told at a time.
    // Into what it is dispatched to.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    pub(crate) fn part(self) -> u8 {
        let [x, y, z] = self.0.map(i32::cast_unsigned);
        let mix = x.wrapping_mul(0x9e37_79b9)
            ^ y.wrapping_mul(0x85eb_ca6b).rotate_left(11)
            ^ z.wrapping_mul(0xc2b2_ae35).rotate_left(22);
        // As many as the highest bits count.
        #[allow(clippy::cast_possible_truncation)]
        let part = ((mix ^ mix >> 15).wrapping_mul(0x2c1b_3c6d) >> (32 - PARTS.ilog2())) as u8;
        part
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

/// The place of a voxel in its block.
#[inline]
pub(crate) fn place_of(key: VoxelKey) -> usize {
    let [x, y, z] = key.map(|k| k.cast_unsigned() % (1 << BITS));
    ((x << BITS | y) << BITS | z) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_of_a_surface_are_of_all_parts() {
        for axis in 0..3 {
            for (at, step) in [(-40, 1), (100_000, 1), (0, 16)] {
                let mut parts = [0; PARTS];
                for k in 0..64 * 64 {
                    let mut key = [at; 3];
                    key[axis] += step * (k % 64);
                    key[(axis + 1) % 3] += step * (k / 64);
                    parts[usize::from(BlockKey(key).part())] += 1;
                }
                // 32 in the mean.
                assert!(parts.iter().all(|blocks| (8..80).contains(blocks)), "{axis} {at} {parts:?}");
            }
        }
    }
}
