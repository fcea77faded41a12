//! Cells well inside a plane.

use foldhash::fast::FixedState;
use hashbrown::HashMap;
use terrace::{Mapper, VoxelKey};
use terrace_types::PlaneId;

/// How far around a cell all points must be of its plane, in cells beyond the neighbourhood of its normal.
const BEYOND: u32 = 1;
/// Cells taken are so many cells apart beyond twice their neighbourhood, so that no two share a point.
const APART: u32 = 1;

/// Which cells have points of one known plane only around them.
pub(crate) struct Interiors {
    /// The plane of all points of a voxel; `None` when they are of several, or of none.
    of: HashMap<VoxelKey, Option<PlaneId>, FixedState>,
    depth: u32,
}

impl Interiors {
    pub(crate) fn of(mapper: &Mapper, truth: &[Option<PlaneId>]) -> Self {
        let mut of: HashMap<VoxelKey, Option<PlaneId>, FixedState> = HashMap::default();
        let grid = mapper.grid();
        for (cell, label) in mapper.cells_of_points().zip(truth) {
            let Some(cell) = cell.and_then(|id| grid?.get(id)) else { continue };
            let all = of.entry(cell.key()).or_insert(*label);
            if all != label {
                *all = None;
            }
        }
        Self { of, depth: mapper.params().depth }
    }

    /// The plane of an interior cell, for cells on a lattice so wide that the neighbourhoods of two share no point.
    pub(crate) fn plane_of(&self, key: VoxelKey) -> Option<PlaneId> {
        let step = i32::try_from(2 * self.depth + APART).ok()?;
        if !key.iter().all(|k| k.rem_euclid(step) == 0) {
            return None;
        }
        let own = (*self.of.get(&key)?)?;
        let reach = i32::try_from(self.depth + BEYOND).ok()?;
        for dx in -reach..=reach {
            for dy in -reach..=reach {
                for dz in -reach..=reach {
                    let around = [(key[0], dx), (key[1], dy), (key[2], dz)].map(|(k, d)| k.saturating_add(d));
                    if self.of.get(&around).is_some_and(|label| *label != Some(own)) {
                        return None;
                    }
                }
            }
        }
        Some(own)
    }
}
