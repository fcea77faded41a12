//! Runs into the cells of a part of the grid.

use super::runs::{Run, SECTION};
use super::{PointErrors, records};
use crate::ahead::Ahead;
use crate::block::{BlockKey, RECENT, place_of};
use crate::part::Part;

/// What one part of the grid gets of a chunk.
#[derive(Debug, Default)]
pub(super) struct Share<'c> {
    /// Runs and what is known of their points, section by section.
    pub(super) runs: Vec<(&'c mut [Run], &'c [f64])>,
    /// For each cell founded its first point, counted within the chunk.
    pub(super) founded: Vec<u32>,
}

impl Share<'_> {
    /// Adds the runs in the order of the points.
    pub(super) fn add(&mut self, part: &mut Part, errors: &PointErrors<'_>) {
        let mut recent = [(BlockKey::NOWHERE, 0); RECENT];
        for (section, (runs, records)) in self.runs.iter_mut().enumerate() {
            // Cells first, then sums: neither loop waits for the memory of the step before.
            find_slots(part, runs, section * SECTION, &mut recent, &mut self.founded);
            records::add_runs(&mut part.slots, runs, errors, records);
        }
    }
}

/// Finds the slot of each run, and founds those missing.
fn find_slots(
    part: &mut Part,
    runs: &mut [Run],
    begin: usize,
    recent: &mut [(BlockKey, u32); RECENT],
    founded: &mut Vec<u32>,
) {
    let ahead = Ahead::new();
    for run in runs {
        let key = BlockKey::of(run.key);
        let known = &mut recent[key.recent() % RECENT];
        if known.0 != key {
            *known = (key, part.block_or_new(key, key.hash()));
        }
        let block = known.1;
        let place = place_of(run.key);
        run.slot = part.slot(block, place).unwrap_or_else(|| {
            // A chunk has no more points than 32 bits can count.
            #[allow(clippy::cast_possible_truncation)]
            founded.push((begin + run.points().start) as u32);
            part.found(block, place, run.key)
        });
        // Its sums are not needed before those of all runs of the section are on their way.
        ahead.fetch(&part.slots[run.slot]);
    }
}
