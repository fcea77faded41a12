//! Points into their cells as they come.

use super::locate::{BATCH, Located, NOWHERE};
use super::{Chunk, PointErrors, Taken, records};
use crate::block::{BlockKey, RECENT};
use crate::{CellId, VoxelGrid, VoxelKey};

/// Batches that are looked at to tell in which order points come.
const LOOKS: usize = 16;
/// Points are in order when so few of them, at most one in so many, are in a block that was not met just before.
const IN_ORDER: usize = 8;

impl VoxelGrid {
    /// Whether most points are near those before, so that cells need not be brought together first.
    pub(super) fn are_in_order(&self, points: &[[f64; 3]]) -> bool {
        let stride = (points.len() / LOOKS).max(BATCH);
        let (mut seen, mut new) = (0, 0);
        let mut located = Located::new();
        for part in points.chunks(stride) {
            let part = &part[..part.len().min(BATCH)];
            located.locate(part, self.lattice);
            let mut recent = [None; RECENT];
            for block in located.keys[..part.len()].iter().map(|key| BlockKey::of(*key)) {
                let before = recent[block.recent()].replace(block);
                // The first of each place is new wherever the batch begins.
                new += usize::from(before.is_some_and(|before| before != block));
            }
            seen += part.len();
        }
        seen >= IN_ORDER * new
    }

    /// On one thread, run by run. Cells, identities and sums are those of the other ways.
    pub(super) fn insert_in_order(
        &mut self,
        chunk: &Chunk<'_>,
        cells: &mut [Option<CellId>],
        mut places: Option<&mut [[f32; 3]]>,
    ) -> Taken {
        let mut taken = Taken::default();
        let mut located = Located::new();
        let lattice = self.lattice;
        for (batch, points) in chunk.points.chunks(BATCH).enumerate() {
            let begin = batch * BATCH;
            let errors = chunk.errors.part(begin..begin + points.len());
            let inside = located.locate(points, lattice);
            if !(inside && errors.are_valid()) {
                located.refuse(points, &errors, lattice, &mut taken);
            }
            if let Some(places) =
                places.as_mut().and_then(|places| places.get_mut(begin..begin + points.len()))
            {
                places.copy_from_slice(&located.places[..points.len()]);
            }
            let keys = &located.keys[..points.len()];
            let mut first = 0;
            while let Some(key) = keys.get(first) {
                let run = first..first + keys[first..].iter().take_while(|other| *other == key).count();
                first = run.end;
                if *key != NOWHERE {
                    let cell = self.add_run(*key, &points[run.clone()], &errors.part(run.clone()));
                    cells[begin + run.start..begin + run.end].fill(cell);
                    taken.points += run.len();
                }
            }
        }
        taken
    }

    fn add_run(&mut self, key: VoxelKey, points: &[[f64; 3]], errors: &PointErrors<'_>) -> Option<CellId> {
        let anchor = self.lattice.anchor_of(key);
        // There is room: the caller sees to it.
        let (home, _) = self.home_or_new(key).ok()?;
        records::add_points(self.moments_mut(home), points, anchor, errors);
        Some(self.id_of(home))
    }
}
