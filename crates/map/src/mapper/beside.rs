//! Points into the cells on one thread, and those before them into the samples on the other.
//!
//! Two threads are done sooner so than with each step on both: that of many points into cells takes half as much again in all then.

use terrace_grid::Taken;
use terrace_regions::Samples;
use terrace_types::Scan;

use super::insert::{both, number};
use super::{Kept, Mapper};
use crate::InsertError;
use crate::seen::Seen;
use crate::world::World;

/// Points that are in the same step: long enough for threads to wait for each other, and short enough to stay in the cache.
const AT_ONCE: usize = 1 << 16;

impl Mapper {
    /// Adds points with weight 1, where regions are grown.
    pub(super) fn add_beside(&mut self, scan: &Scan) -> Result<Taken, InsertError> {
        let mut all = Taken::default();
        let matters = self.sightings_matter(scan);
        let mut world = World::default();
        let mut before: Option<Kept> = None;
        for first in (0..scan.len()).step_by(AT_ONCE) {
            let range = first..(first + AT_ONCE).min(scan.len());
            let mut now = self.kept_of(range.len());
            let Self { fine: Some(grid), samples, seen, .. } = self else { return Ok(all) };
            let (taken, ()) = rayon::join(
                || {
                    let (points, errors) = world.part(scan, range);
                    grid.insert_alone(points, errors, &mut now.cells, Some(&mut now.places))
                },
                || look_at(before.as_ref(), samples, seen.as_mut().filter(|_| matters)),
            );
            all = both(&all, &taken?);
            self.keep(before.replace(now));
        }
        look_at(before.as_ref(), &mut self.samples, self.seen.as_mut().filter(|_| matters));
        self.keep(before);
        Ok(all)
    }

    fn keep(&mut self, points: Option<Kept>) {
        if self.seen.is_none() {
            self.kept.extend(points);
        }
    }
}

/// What is to be known of points whose cells are known.
fn look_at(points: Option<&Kept>, samples: &mut Samples, seen: Option<&mut Seen>) {
    if let Some(Kept { cells, places, .. }) = points {
        samples.push_alone(|at| number(cells[at]), places);
        if let Some(seen) = seen {
            seen.push(cells);
        }
    }
}
