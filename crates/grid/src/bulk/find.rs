//! The cells that many points are in.

use super::locate::{BATCH, Located, NOWHERE, Place, is_outside};
use crate::block::{BlockKey, RECENT, place_of};
use crate::{CellId, VoxelGrid};

/// A block, and where it is if it has a cell.
type LookedUp = (BlockKey, Option<(u32, u32)>);

impl VoxelGrid {
    /// Appends for each point the cell of its voxel, as [`insert_all`](Self::insert_all) told it: `None` for points that are not finite
    /// or in no cell. Appends to `places` where each is from the [anchor](crate::Cell::anchor) of its voxel, 0 if it is in none.
    ///
    /// For points that are read again: with [`Assignment::Voxel`](crate::Assignment::Voxel) nothing else tells the cell of a point.
    pub fn find_all(&self, points: &[[f64; 3]], cells: &mut Vec<Option<CellId>>, places: &mut Vec<[f32; 3]>) {
        let mut located = Located::new();
        let unit = self.place_unit();
        let mut recent: [Option<LookedUp>; RECENT] = [None; RECENT];
        let mut last = (NOWHERE, None);
        for points in points.chunks(BATCH) {
            if !located.locate(points, self.lattice) {
                let all = located.keys.iter_mut().zip(&mut located.places).take(points.len());
                for (key, place) in all.filter(|(key, _)| is_outside(**key)) {
                    (*key, *place) = (NOWHERE, [0; 3]);
                }
            }
            places.extend_from_slice(&unpacked(&located.places, unit)[..points.len()]);
            for key in &located.keys[..points.len()] {
                if *key != last.0 {
                    let block_key = BlockKey::of(*key);
                    let block = match recent[block_key.recent()] {
                        Some((known, block)) if known == block_key => block,
                        _ => self.block_of(block_key),
                    };
                    recent[block_key.recent()] = Some((block_key, block));
                    let cell = |(part, block): (u32, u32)| {
                        let part = &self.parts[part as usize];
                        part.ids.get(part.slot(block, place_of(*key))? as usize).copied()
                    };
                    last = (*key, block.and_then(cell));
                }
                cells.push(last.1);
            }
        }
    }
}

/// Places in metres, several at a time.
fn unpacked(places: &[Place; BATCH], unit: f64) -> [[f32; 3]; BATCH] {
    let mut metres = [[0.0; 3]; BATCH];
    pulp::Arch::new().dispatch(|| {
        for (metres, place) in metres.as_flattened_mut().iter_mut().zip(places.as_flattened()) {
            // Exact, for cells of any size that is of use.
            #[allow(clippy::cast_possible_truncation)]
            let rounded = (f64::from(*place) * unit) as f32;
            *metres = rounded;
        }
    });
    metres
}
