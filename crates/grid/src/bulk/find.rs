//! The cells that many points are in.

use super::locate::{BATCH, Located, NOWHERE};
use crate::block::{BlockKey, part_of, place_of};
use crate::key::key_of;
use crate::{CellId, VoxelGrid};

impl VoxelGrid {
    /// Appends for each point the cell of its voxel, as [`insert_all`](Self::insert_all) told it: `None` for points that are not finite
    /// or in no cell. Appends to `places` where each is from the [anchor](crate::Cell::anchor) of its voxel, 0 if it is in none.
    ///
    /// For points that are read again: with [`Assignment::Voxel`](crate::Assignment::Voxel) nothing else tells the cell of a point.
    pub fn find_all(&self, points: &[[f64; 3]], cells: &mut Vec<Option<CellId>>, places: &mut Vec<[f32; 3]>) {
        let mut located = Located::new();
        let mut last_block: Option<(BlockKey, usize, Option<u32>)> = None;
        let mut last = (NOWHERE, None);
        for points in points.chunks(BATCH) {
            if !located.locate(points, self.lattice) {
                for (point, (key, place)) in
                    points.iter().zip(located.keys.iter_mut().zip(&mut located.places))
                {
                    if key_of(*point, self.lattice.size).is_err() {
                        (*key, *place) = (NOWHERE, [0.0; 3]);
                    }
                }
            }
            places.extend_from_slice(&located.places[..points.len()]);
            for key in &located.keys[..points.len()] {
                if *key != last.0 {
                    let block_key = BlockKey::of(*key);
                    let (part, block) = match last_block {
                        Some((known, part, block)) if known == block_key => (part, block),
                        _ => {
                            let hash = block_key.hash();
                            let part = part_of(hash);
                            (part, self.parts[part].block(block_key, hash))
                        }
                    };
                    last_block = Some((block_key, part, block));
                    let part = &self.parts[part];
                    let slot = block.and_then(|block| part.slot(block, place_of(*key)));
                    last = (*key, slot.and_then(|slot| part.ids.get(slot as usize).copied()));
                }
                cells.push(last.1);
            }
        }
    }
}
