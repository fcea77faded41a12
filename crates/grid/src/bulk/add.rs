//! Runs into the cells of a part of the grid.

use terrace_stats::Run as Sums;

use super::PointErrors;
use super::runs::{Run, SECTION};
use crate::block::{BlockKey, place_of};
use crate::key::centre_of;
use crate::part::Part;

/// What one part of the grid gets of a chunk.
#[derive(Debug, Default)]
pub(super) struct Share<'c> {
    /// Section by section.
    pub(super) runs: Vec<&'c mut [Run]>,
    /// For each cell founded its first point, counted within the chunk.
    pub(super) founded: Vec<u32>,
}

impl Share<'_> {
    /// Adds the runs in the order of the points.
    pub(super) fn add(&mut self, part: &mut Part, points: &[[f64; 3]], errors: &PointErrors<'_>, size: f64) {
        let sections = points.chunks(SECTION).enumerate();
        for (runs, (section, points)) in self.runs.iter_mut().zip(sections) {
            let begin = section * SECTION;
            // Cells first, then sums: neither loop waits for the memory of the step before.
            find_slots(part, runs, begin, &mut self.founded);
            let errors = errors.part(begin..begin + points.len());
            for run in runs.iter() {
                let slot = &mut part.slots[run.slot as usize];
                let centre = centre_of(run.key, size);
                let mut sums = Sums::EMPTY;
                for point in &points[run.points()] {
                    sums.push([0, 1, 2].map(|i| point[i] - centre[i]));
                }
                slot.moments.push_run(&sums, &errors.noise(run.points()));
            }
        }
    }
}

/// Finds the slot of each run, and founds those missing.
fn find_slots(part: &mut Part, runs: &mut [Run], begin: usize, founded: &mut Vec<u32>) {
    let mut last = None;
    for run in runs {
        let key = BlockKey::of(run.key);
        let block = match last {
            Some((known, block)) if known == key => block,
            _ => part.block_or_new(key, key.hash()),
        };
        last = Some((key, block));
        let place = place_of(run.key);
        run.slot = part.slot(block, place).unwrap_or_else(|| {
            // A chunk has no more points than 32 bits can count.
            #[allow(clippy::cast_possible_truncation)]
            founded.push((begin + run.points().start) as u32);
            part.found(block, place, run.key)
        });
    }
}
