//! Points into the cells on one thread, while the other puts those before into the samples, and takes those after into the world and finds
//! their voxels.
//!
//! Two threads are done sooner so than with each step on both: that of many points into cells takes half as much again in all then.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use terrace_grid::{CellId, GridError, Locator, Motion, PointErrors, PointVoxels, Taken, VoxelGrid};
use terrace_regions::Samples;
use terrace_types::Scan;

use super::insert::both;
use super::line::{Line, lock};
use super::{Kept, Mapper, cell_number};
use crate::InsertError;
use crate::seen::Seen;
use crate::world::{World, errors_there, motion};

/// Points that are in the same step: they stay in the cache.
const AT_ONCE: usize = 1 << 12;
// Too few for a step to be shared among threads: it might then wait for the other, which is in the line.
const _: () = assert!(AT_ONCE <= crate::world::AT_ONCE);
/// Parts between the first step and the last: so far one thread may be ahead of the other.
const ROOM: usize = 6;

/// The steps: to their voxels in the world, into the cells, and what becomes of points then.
const VOXELS: usize = 0;
const CELLS: usize = 1;
const BEHIND: usize = 2;

/// Some points on their way.
#[derive(Default)]
struct Part {
    world: World,
    voxels: PointVoxels,
    cells: Vec<Option<CellId>>,
}

/// Points, what takes them into the world if they are not there, and their errors there.
type Points<'p> = (&'p [[f64; 3]], Option<&'p Motion<'p>>, PointErrors<'p>);

/// From where points come.
struct Source<'s> {
    scan: &'s Scan,
    motion: Option<Box<Motion<'static>>>,
    /// Where voxels can be found apart from the grid.
    locator: Option<Locator>,
}

/// Where points go first.
struct Front<'m> {
    grid: &'m mut VoxelGrid,
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
        let Self { fine: Some(grid), samples, seen, .. } = self else { return Ok(Taken::default()) };
        let seen = seen.as_mut().filter(|_| matters);
        let source = Source { scan, motion: motion(scan), locator: grid.locator() };
        let behind = Mutex::new(Behind { samples: samples.as_mut(), seen, kept: keeps.then_some(&mut kept) });
        let front = Mutex::new(Front { grid, taken: Ok(Taken::default()) });
        // Each is in one step at a time, which no other thread waits for.
        let parts: [Mutex<Part>; ROOM] = Default::default();
        let step = |step: usize, number: usize| {
            let first = number * AT_ONCE;
            let range = first..(first + AT_ONCE).min(scan.len());
            let part = &mut *lock(&parts[number % ROOM]);
            match step {
                VOXELS => return source.find(range, part),
                CELLS => return lock(&front).take(&source, range, part),
                _ => lock(&behind).take(part),
            }
            true
        };
        let line = Line::new(scan.len().div_ceil(AT_ONCE), ROOM);
        rayon::join(|| line.work([CELLS, VOXELS, BEHIND], step), || line.work([BEHIND, VOXELS, CELLS], step));
        let taken = front.into_inner().unwrap_or_else(PoisonError::into_inner).taken;
        self.give_back(kept, if taken.is_ok() { usize::MAX } else { before });
        Ok(taken?)
    }
}

impl Source<'_> {
    fn points<'p>(&'p self, range: Range<usize>, world: &'p World) -> Points<'p> {
        if let Some(errors) = errors_there(self.scan, range.clone()) {
            return (&self.scan.points()[range], self.motion.as_deref(), errors);
        }
        let (points, errors) = world.made(self.scan, range);
        (points, None, errors)
    }

    fn find(&self, range: Range<usize>, part: &mut Part) -> bool {
        if errors_there(self.scan, range.clone()).is_none() {
            part.world.make(self.scan, range.clone());
        }
        let (points, motion, errors) = self.points(range, &part.world);
        self.locator.is_none_or(|locator| locator.locate(points, motion, errors, &mut part.voxels).is_ok())
    }
}

impl Front<'_> {
    fn take(&mut self, source: &Source<'_>, range: Range<usize>, part: &mut Part) -> bool {
        let Part { world, voxels, cells } = part;
        cells.clear();
        let (points, motion, errors) = source.points(range, world);
        let taken = match source.locator {
            Some(_) => self.grid.insert_located(voxels, (points, motion), errors, cells),
            None => self.grid.insert_alone(points, motion, errors, cells, None),
        };
        self.taken = self.taken.and_then(|all| Ok(both(&all, &taken?)));
        self.taken.is_ok()
    }
}

impl Behind<'_> {
    fn take(&mut self, part: &Part) {
        let Part { cells, voxels, .. } = part;
        let places = voxels.places();
        if let Some(samples) = &mut self.samples {
            samples.push_alone(|at| cells[at].map(cell_number), places);
        }
        if let Some(seen) = &mut self.seen {
            seen.push(cells);
        }
        if let Some(kept) = &mut self.kept {
            kept.cells.extend_from_slice(cells);
            if self.samples.is_some() {
                kept.places.extend_from_slice(places);
            }
        }
    }
}
