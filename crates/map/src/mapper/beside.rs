//! Points into the cells on one thread, while the other puts those before into the samples and those after into the world.
//!
//! Two threads are done sooner so than with each step on both: that of many points into cells takes half as much again in all then.

use std::mem::swap;

use terrace_grid::{CellId, Taken};
use terrace_regions::Samples;
use terrace_types::Scan;

use super::insert::{both, number};
use super::{Kept, Mapper};
use crate::InsertError;
use crate::seen::Seen;
use crate::world::World;

/// Points that are in the same step: long enough for threads to wait for each other, and short enough to stay in the cache.
const AT_ONCE: usize = 1 << 14;

/// Points whose cells are known.
#[derive(Default)]
struct Located {
    cells: Vec<Option<CellId>>,
    places: Vec<[f32; 3]>,
}

/// What becomes of points once their cells are known.
struct Behind<'m> {
    samples: &'m mut Samples,
    /// Where it is asked for.
    seen: Option<&'m mut Seen>,
    /// Where points are kept, and in what unit.
    kept: Option<&'m mut Kept>,
    unit: f64,
}

impl Mapper {
    /// Adds points with weight 1, where regions are grown.
    pub(super) fn add_beside(&mut self, scan: &Scan) -> Result<Taken, InsertError> {
        let mut all = Taken::default();
        let mut kept = self.kept_of(scan.len());
        let matters = self.sightings_matter(scan);
        let keeps = self.seen.is_none();
        let Self { fine: Some(grid), samples, seen, .. } = self else { return Ok(all) };
        let unit = grid.place_unit();
        let seen = seen.as_mut().filter(|_| matters);
        let mut behind = Behind { samples, seen, kept: keeps.then_some(&mut kept), unit };
        let (mut before, mut now) = (Located::default(), Located::default());
        let (mut world, mut next) = (World::default(), World::default());
        let range = |first: usize| first.min(scan.len())..(first + AT_ONCE).min(scan.len());
        world.make(scan, range(0));
        for first in (0..scan.len()).step_by(AT_ONCE) {
            now.cells.clear();
            now.places.clear();
            let (taken, ()) = rayon::join(
                || {
                    let (points, errors) = world.made(scan, range(first));
                    grid.insert_alone(points, errors, &mut now.cells, Some(&mut now.places))
                },
                || {
                    next.make(scan, range(first + AT_ONCE));
                    behind.take(&before);
                },
            );
            all = both(&all, &taken?);
            swap(&mut before, &mut now);
            swap(&mut world, &mut next);
        }
        behind.take(&before);
        if keeps {
            self.kept.push(kept);
        }
        Ok(all)
    }
}

impl Behind<'_> {
    fn take(&mut self, points: &Located) {
        let Located { cells, places } = points;
        self.samples.push_alone(|at| number(cells[at]), places);
        if let Some(seen) = &mut self.seen {
            seen.push(cells);
        }
        if let Some(kept) = &mut self.kept {
            kept.cells.extend_from_slice(cells);
            kept.places.extend(places, self.unit);
        }
    }
}
