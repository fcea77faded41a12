//! The blocks of many voxels, and the places there.

use super::locate::BATCH;
use crate::VoxelKey;
use crate::block::{BlockKey, place_of};

/// For each of up to [`BATCH`] voxels what finds its cell.
pub(super) struct Split {
    pub(super) blocks: [BlockKey; BATCH],
    /// Where blocks are remembered.
    pub(super) recent: [u32; BATCH],
    /// Where voxels are in their blocks.
    pub(super) places: [u32; BATCH],
}

impl Split {
    pub(super) fn new() -> Self {
        Self { blocks: [BlockKey::NOWHERE; BATCH], recent: [0; BATCH], places: [0; BATCH] }
    }

    pub(super) fn split(&mut self, keys: &[VoxelKey]) {
        // The same instructions, for more numbers at a time where the processor can.
        pulp::Arch::new().dispatch(Several { keys, to: self });
    }
}

struct Several<'a> {
    keys: &'a [VoxelKey],
    to: &'a mut Split,
}

impl pulp::WithSimd for Several<'_> {
    type Output = ();

    // Into what it is dispatched to.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let Split { blocks, recent, places } = self.to;
        for (block, key) in blocks.iter_mut().zip(self.keys) {
            *block = BlockKey::of(*key);
        }
        // Both are below 512.
        #[allow(clippy::cast_possible_truncation)]
        for ((recent, place), key) in recent.iter_mut().zip(&mut *places).zip(self.keys) {
            (*recent, *place) = (BlockKey::of(*key).recent() as u32, place_of(*key) as u32);
        }
    }
}

/// The part that the block of each of up to [`BATCH`] voxels is of.
pub(super) fn parts(keys: &[VoxelKey], to: &mut [u8]) {
    pulp::Arch::new().dispatch(Parts { keys, to });
}

struct Parts<'a> {
    keys: &'a [VoxelKey],
    to: &'a mut [u8],
}

impl pulp::WithSimd for Parts<'_> {
    type Output = ();

    // Into what it is dispatched to.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        for (part, key) in self.to.iter_mut().zip(self.keys) {
            *part = BlockKey::of(*key).part();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn voxels_are_split_as_one_by_one(keys in prop::collection::vec(prop::array::uniform3(any::<i32>()), 0..BATCH)) {
            let mut split = Split::new();
            split.split(&keys);
            let mut parts = [0; BATCH];
            super::parts(&keys, &mut parts);
            for (at, key) in keys.iter().enumerate() {
                let block = BlockKey::of(*key);
                prop_assert_eq!(split.blocks[at], block);
                prop_assert_eq!(parts[at], block.part());
                prop_assert_eq!(split.recent[at] as usize, block.recent());
                prop_assert_eq!(split.places[at] as usize, place_of(*key));
            }
        }
    }
}
