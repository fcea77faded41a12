//! Points into their cells as they come.

use super::batch::Batch;
use super::locate::{BATCH, Located};
use super::split::Split;
use super::{Chunk, Motion, PointErrors, Taken, sums};
use crate::ahead::Ahead;
use crate::block::{BlockKey, RECENT};
use crate::grid::Home;
use crate::{CellId, VoxelGrid, VoxelKey};

/// Batches that are looked at to tell in which order points come.
const LOOKS: usize = 16;
/// And at most one in so many is.
const SPARSE: usize = 16;
/// Points are in order when so few of them, at most one in so many, are in a block that was not met just before.
const IN_ORDER: usize = 8;

/// What finds the cells of a batch, kept from one to the next.
struct Finder {
    split: Split,
    homes: [Home; BATCH],
    found: [Option<CellId>; BATCH],
}

impl Finder {
    fn new() -> Self {
        Self { split: Split::new(), homes: [Home::default(); BATCH], found: [None; BATCH] }
    }
}

impl VoxelGrid {
    /// Whether most points are near those before, as in the order of a scan, by looking at two thousand of them.
    pub fn are_in_order(&self, points: &[[f64; 3]]) -> bool {
        let stride = (points.len() / LOOKS).max(SPARSE * BATCH);
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

    /// On one thread, point by point. Cells, identities and sums are those of the other ways.
    ///
    /// Noise carries points of a surface to and fro over the faces of voxels: to look for those that follow each other in one costs
    /// more than to find the cell of each, which takes no branch that is hard to predict.
    // On its own: among what other ways need the loops have too few registers left.
    #[inline(never)]
    pub(super) fn insert_in_order(
        &mut self,
        chunk: &Chunk<'_>,
        motion: Option<&Motion<'_>>,
        cells: &mut Vec<Option<CellId>>,
        mut places: Option<&mut Vec<[i16; 3]>>,
    ) -> Taken {
        let mut taken = Taken::default();
        let (mut batch, mut finder) = (Batch::new(), Finder::new());
        let (lattice, ahead) = (self.lattice, Ahead::new());
        let mut moved = [[0.0; 3]; BATCH];
        for (number, points) in chunk.points.chunks(BATCH).enumerate() {
            let begin = number * BATCH;
            let next = chunk.points.get(begin + BATCH..).unwrap_or(&[]);
            chunk.errors.fetch(begin + BATCH..begin + BATCH + next.len().min(BATCH), ahead);
            let errors = chunk.errors.part(begin..begin + points.len());
            batch.locate(points, (motion, &mut moved), &errors, lattice, &mut taken);
            if let Some(places) = &mut places {
                places.extend_from_slice(batch.places());
            }
            taken.points += self.insert_batch(&batch, &mut finder, &errors, next, cells);
        }
        taken
    }

    /// As [`insert_in_order`](Self::insert_in_order), of points whose voxels were found before; tells how many are inserted.
    #[inline(never)]
    pub(super) fn insert_batches(
        &mut self,
        batches: &[Batch],
        errors: &PointErrors<'_>,
        cells: &mut Vec<Option<CellId>>,
    ) -> usize {
        let mut finder = Finder::new();
        let mut points = 0;
        let mut begin = 0;
        for batch in batches {
            let errors = errors.part(begin..begin + batch.len());
            points += self.insert_batch(batch, &mut finder, &errors, &[], cells);
            begin += batch.len();
        }
        points
    }

    /// Adds the points of a batch, of which these are all errors, that can be inserted; tells how many. The memory of those that come
    /// `next` is asked for meanwhile.
    #[allow(clippy::inline_always, reason = "a loop that knows its caller")]
    #[inline(always)]
    fn insert_batch(
        &mut self,
        batch: &Batch,
        finder: &mut Finder,
        errors: &PointErrors<'_>,
        next: &[[f64; 3]],
        cells: &mut Vec<Option<CellId>>,
    ) -> usize {
        let ahead = Ahead::new();
        let keys = batch.keys();
        let Finder { split, homes, found } = finder;
        let (homes, found) = (&mut homes[..keys.len()], &mut found[..keys.len()]);
        split.split(keys);
        let with_places = keys.iter().zip(&split.blocks).zip(&split.recent).zip(&split.places);
        for (at, ((((key, block), recent), place), (home, found))) in
            with_places.zip(homes.iter_mut().zip(&mut *found)).enumerate()
        {
            if let Some(next) = next.get(at) {
                ahead.fetch(next);
            }
            match self.met(*block, *recent as usize, *place as usize) {
                Some(met) => (*home, *found) = (met, Some(self.id_of(met))),
                None => *found = self.founded_at(*key, home),
            }
        }
        sums::add_each(&mut self.parts, homes, batch.local(), &batch.errors(errors));
        batch.append(found, cells);
        keys.len()
    }

    /// Finds or founds the cell of a voxel, and tells where it is kept.
    #[inline]
    fn founded_at(&mut self, key: VoxelKey, home: &mut Home) -> Option<CellId> {
        // There is room: the caller sees to it.
        *home = self.home_or_new(key).ok()?.0;
        Some(self.id_of(*home))
    }
}
