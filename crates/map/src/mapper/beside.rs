//! Points into the cells on one thread, while the other puts those before into the samples and those after into the world.
//!
//! Two threads are done sooner so than with each step on both: that of many points into cells takes half as much again in all then.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use terrace_grid::{CellId, GridError, Taken, VoxelGrid};
use terrace_regions::Samples;
use terrace_types::Scan;

use super::insert::both;
use super::line::{Line, lock};
use super::{Kept, Mapper, cell_number};
use crate::InsertError;
use crate::seen::Seen;
use crate::world::World;

/// Points that are in the same step: they stay in the cache.
const AT_ONCE: usize = 1 << 12;
// Too few for a step to be shared among threads: it might then wait for the other, which is in the line.
const _: () = assert!(AT_ONCE <= crate::world::AT_ONCE);
/// Parts between the first step and the last: so far one thread may be ahead of the other.
const ROOM: usize = 6;

/// The steps: into the world, into the cells, and what becomes of points then.
const WORLD: usize = 0;
const CELLS: usize = 1;
const BEHIND: usize = 2;

/// Some points on their way.
#[derive(Default)]
struct Part {
    world: World,
    cells: Vec<Option<CellId>>,
    places: Vec<[i16; 3]>,
}

/// Where points go first.
struct Front<'m> {
    grid: &'m mut VoxelGrid,
    /// Whether it matters where in their cells they are.
    places: bool,
    taken: Result<Taken, GridError>,
}

/// What becomes of points once their cells are known.
struct Behind<'m> {
    /// Where regions are grown.
    samples: Option<&'m mut Samples>,
    /// Where it is asked for.
    seen: Option<&'m mut Seen>,
    /// Where points are kept.
    kept: Option<&'m mut Kept>,
}

impl Mapper {
    /// Adds points with weight 1.
    pub(super) fn add_beside(&mut self, scan: &Scan) -> Result<Taken, InsertError> {
        let mut kept = self.lend_kept(scan.len());
        let before = kept.cells.len();
        let matters = self.sightings_matter(scan);
        let keeps = self.seen.is_none();
        let grows = self.params.grows().is_some();
        let Self { fine: Some(grid), samples, seen, .. } = self else { return Ok(Taken::default()) };
        let seen = seen.as_mut().filter(|_| matters);
        let behind = Mutex::new(Behind { samples: samples.as_mut(), seen, kept: keeps.then_some(&mut kept) });
        let front = Mutex::new(Front { grid, places: grows, taken: Ok(Taken::default()) });
        // Each is in one step at a time, which no other thread waits for.
        let parts: [Mutex<Part>; ROOM] = Default::default();
        let step = |step: usize, number: usize| {
            let first = number * AT_ONCE;
            let range = first..(first + AT_ONCE).min(scan.len());
            let part = &mut *lock(&parts[number % ROOM]);
            match step {
                WORLD => part.world.make(scan, range),
                CELLS => return lock(&front).take(part, scan, range),
                _ => lock(&behind).take(part),
            }
            true
        };
        let line = Line::new(scan.len().div_ceil(AT_ONCE), ROOM);
        rayon::join(|| line.work([CELLS, WORLD, BEHIND], step), || line.work([BEHIND, WORLD, CELLS], step));
        let taken = front.into_inner().unwrap_or_else(PoisonError::into_inner).taken;
        self.give_back(kept, if taken.is_ok() { usize::MAX } else { before });
        Ok(taken?)
    }
}

impl Front<'_> {
    fn take(&mut self, part: &mut Part, scan: &Scan, range: Range<usize>) -> bool {
        let Part { world, cells, places } = part;
        cells.clear();
        places.clear();
        let (points, errors) = world.made(scan, range);
        let taken = self.grid.insert_alone(points, None, errors, cells, self.places.then_some(places));
        self.taken = self.taken.and_then(|all| Ok(both(&all, &taken?)));
        self.taken.is_ok()
    }
}

impl Behind<'_> {
    fn take(&mut self, part: &Part) {
        let Part { cells, places, .. } = part;
        if let Some(samples) = &mut self.samples {
            samples.push_alone(|at| cells[at].map(cell_number), places);
        }
        if let Some(seen) = &mut self.seen {
            seen.push(cells);
        }
        if let Some(kept) = &mut self.kept {
            kept.cells.extend_from_slice(cells);
            kept.places.extend_from_slice(places);
        }
    }
}
