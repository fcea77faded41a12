//! Points into the cells of a part of the grid.

use super::locate::{BATCH, Located};
use super::section::{Portion, SECTION};
use super::split::Split;
use super::sums;
use crate::ahead::Ahead;
use crate::block::{BlockKey, RECENT};
use crate::grid::Home;
use crate::key::Lattice;
use crate::part::Part;

/// What one part of the grid gets of a chunk.
#[derive(Debug, Default)]
pub(super) struct Share<'c> {
    /// Section by section.
    pub(super) portions: Vec<Portion<'c>>,
    /// For each cell founded its first point, counted within the chunk.
    pub(super) founded: Vec<u32>,
}

impl Share<'_> {
    /// Adds the points in their order.
    ///
    /// Their voxels are found once more: that takes less time than to write them to memory and to read them again.
    pub(super) fn add(&mut self, part: &mut Part, lattice: Lattice) {
        let Self { portions, founded } = self;
        let (mut located, mut split) = (Located::new(), Split::new());
        let mut homes = [Home::default(); BATCH];
        let mut recent = [(BlockKey::NOWHERE, 0); RECENT];
        let ahead = Ahead::new();
        let of_sections = portions.iter_mut().zip((0..).step_by(SECTION));
        let batches =
            of_sections.flat_map(|(portion, begin)| portion.batches().zip(std::iter::repeat(begin)));
        for (Portion { points, errors, numbers, slots }, begin) in batches {
            located.locate(points, lattice);
            let keys = &located.keys[..points.len()];
            split.split(keys);
            let found = keys.iter().zip(&split.blocks).zip(&split.recent).zip(&split.places);
            let of_points = numbers.iter().zip(slots).zip(&mut homes);
            for ((((key, block), recent_at), place), ((number, slot), home)) in found.zip(of_points) {
                let known = &mut recent[*recent_at as usize % RECENT];
                if known.0 != *block {
                    *known = (*block, part.block_or_new(*block, block.hash()));
                }
                *slot = part.slot(known.1, *place as usize).unwrap_or_else(|| {
                    founded.push(begin + u32::from(*number));
                    part.found(known.1, *place as usize, *key)
                });
                *home = Home { part: 0, slot: *slot };
                // Its sums are not needed before those of all points of the batch are on their way.
                ahead.fetch(&part.slots[*slot]);
            }
            sums::add_each(std::slice::from_mut(part), &homes[..points.len()], &located.local, &errors);
        }
    }
}
