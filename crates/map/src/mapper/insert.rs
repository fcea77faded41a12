//! Scans, or chunks of them, into the cells.

use std::sync::OnceLock;

use terrace_grid::{GridError, Taken};
use terrace_noise::PoseNoise;
use terrace_stats::UncertainVector;
use terrace_types::Scan;

use super::{Kept, Mapper, View, cell_number};
use crate::cell_size::choose_from;
use crate::world::{World, errors_there, motion};
use crate::{InsertError, Inserted, Weighting};

/// Points that go through all steps together: on several threads, and on one, where they stay in the cache.
const AT_ONCE: usize = 1 << 20;
const ALONE: usize = 1 << 13;

impl Mapper {
    /// Adds the points of a scan.
    ///
    /// # Errors
    /// [`InsertError`], with the map as it was: when no cell size was given and none can be chosen from this first
    /// scan; when points are to be weighted by information and one has no standard error to weight it by. Single points
    /// that the grid refuses are left out and counted, see [`Inserted`].
    pub fn insert(&mut self, scan: &Scan) -> Result<Inserted, InsertError> {
        self.insert_from(scan, None)
    }

    /// Adds the points of a scan whose pose is only known to within `pose`. All its points share that error: it goes into
    /// the covariances of planes once for the scan. `None` is a pose without error.
    ///
    /// # Errors
    /// As [`Mapper::insert`], and [`InsertError::NoSensor`] when it is not known where the sensor stood.
    pub fn insert_from(&mut self, scan: &Scan, pose: Option<PoseNoise>) -> Result<Inserted, InsertError> {
        if pose.is_some() && scan.sensor_position().is_none() {
            return Err(InsertError::NoSensor);
        }
        if self.params.weighting == Weighting::Information {
            require_errors(scan)?;
        }
        let (choice, size) = match (&self.fine, self.params.cell_size) {
            (Some(_), _) => (self.chosen, None),
            (None, Some(size)) => (None, Some(size)),
            (None, None) => {
                let choice = choose_from(scan, pose.as_ref())
                    .ok_or(InsertError::NoCellSize { present: scan.present() })?;
                (Some(choice), Some(choice.cell_size))
            }
        };
        if let Some(size) = size {
            self.begin(size)?;
        }
        self.chosen = choice;
        if let (Some(seen), Some(last)) = (&mut self.seen, self.views.len().checked_sub(1)) {
            seen.end_view(last);
        }
        self.views.push(View { points: 0, absent: 0, out_of_range: 0, sensor: scan.sensor_position(), pose });
        self.take(scan)
    }

    /// Adds more points of the scan before: for one that comes in chunks, all of one frame. They were seen from the same place, and
    /// share the error of its pose. The first chunk goes to [`Mapper::insert_from`]; a map of chunks is that of the whole scan to the
    /// bit, if it has the same [cell size](Self::begin_with). Without a scan before it is [`Mapper::insert`].
    ///
    /// # Errors
    /// [`InsertError::NoWeight`] as for [`Mapper::insert`], with the map as it was.
    pub fn insert_more(&mut self, chunk: &Scan) -> Result<Inserted, InsertError> {
        if self.views.is_empty() {
            return self.insert(chunk);
        }
        if self.params.weighting == Weighting::Information {
            require_errors(chunk)?;
        }
        self.take(chunk)
    }

    /// Adds points to the last view.
    fn take(&mut self, scan: &Scan) -> Result<Inserted, InsertError> {
        self.coarse = OnceLock::new();
        let taken = match self.params.weighting {
            // With more of them, insertion itself is what they do.
            Weighting::Uniform if rayon::current_num_threads() == 2 && self.is_in_order(scan) => {
                self.add_beside(scan)?
            }
            Weighting::Uniform => self.add_all(scan)?,
            Weighting::Information => self.add_weighted(scan),
        };
        if let Some(view) = self.views.last_mut() {
            view.points += scan.len();
            view.absent += taken.not_finite;
            view.out_of_range += taken.refused;
        }
        Ok(Inserted {
            points: taken.points,
            absent: taken.not_finite,
            out_of_range: taken.refused,
            first_refusal: taken.first_refusal.map(|refusal| self.in_cells_of_the_map(refusal)),
        })
    }

    /// A refusal tells the cell size, also where points are added to cells of half of it.
    fn in_cells_of_the_map(&self, refusal: GridError) -> GridError {
        match refusal {
            GridError::OutOfRange { position, size } if self.params.grows().is_some() => {
                GridError::OutOfRange { position, size: 2.0 * size }
            }
            other => other,
        }
    }

    /// Whether the points of a scan follow each other: in its frame as well as in the world.
    fn is_in_order(&self, scan: &Scan) -> bool {
        self.fine.as_ref().is_some_and(|grid| grid.are_in_order(scan.points()))
    }

    /// Adds points with weight 1, many at once.
    fn add_all(&mut self, scan: &Scan) -> Result<Taken, InsertError> {
        let mut kept = self.lend_kept(scan.len());
        let before = kept.cells.len();
        let taken = self.add_and_keep(scan, &mut kept);
        self.give_back(kept, if taken.is_ok() { usize::MAX } else { before });
        Ok(taken?)
    }

    fn add_and_keep(&mut self, scan: &Scan, kept: &mut Kept) -> Result<Taken, GridError> {
        let mut all = Taken::default();
        let matters = self.sightings_matter(scan);
        let Some(grid) = &mut self.fine else { return Ok(all) };
        let grows = self.params.grows().is_some();
        let alone = rayon::current_num_threads() == 1;
        let at_once = if alone { ALONE } else { AT_ONCE };
        // Looked at once for the scan, not again for each part of it.
        let in_order = alone && grid.are_in_order(scan.points());
        let (mut world, motion) = (World::default(), motion(scan));
        for first in (0..scan.len()).step_by(at_once) {
            let range = first..(first + at_once).min(scan.len());
            if self.seen.is_some() {
                kept.cells.clear();
                kept.places.clear();
            }
            let begin = kept.cells.len();
            let (cells, to) = (&mut kept.cells, grows.then_some(&mut kept.places));
            let taken = match errors_there(scan, range.clone()) {
                Some(errors) if in_order => {
                    grid.insert_alone(&scan.points()[range], motion.as_deref(), errors, cells, to)
                }
                _ => {
                    let (points, errors) = world.part(scan, range);
                    if in_order {
                        grid.insert_alone(points, None, errors, cells, to)
                    } else {
                        grid.insert_all(points, errors, cells, to)
                    }
                }
            }?;
            all = both(&all, &taken);
            if let Some(seen) = self.seen.as_mut().filter(|_| matters) {
                seen.push(&kept.cells);
            }
            if let Some(samples) = self.samples.as_mut().filter(|_| grows) {
                let cells = &kept.cells[begin..];
                samples.push_all(|at| cells[at].map(cell_number), &kept.places[begin..]);
            }
        }
        Ok(all)
    }

    /// Whether it will be asked from where the points of a scan, the last one, were seen: where that is spared, not if errors are stated, and
    /// no pose is wrong.
    pub(super) fn sightings_matter(&self, scan: &Scan) -> bool {
        !self.spares || self.views.last().is_some_and(|view| view.pose.is_some()) || !states_errors(scan)
    }

    /// Room for what is kept of so many points more, behind what was kept last if that has it. It is to be [given back](Self::give_back).
    pub(super) fn lend_kept(&mut self, points: usize) -> Kept {
        match self.kept.pop_if(|kept| kept.has_room(points)) {
            Some(kept) => kept,
            None if self.seen.is_some() => Kept::default(),
            None => Kept::of(points, self.params.grows().is_some()),
        }
    }

    /// Keeps what is kept of points, up to so many; where they are forgotten nothing.
    pub(super) fn give_back(&mut self, mut kept: Kept, points: usize) {
        kept.truncate(points);
        if self.seen.is_none() {
            self.kept.push(kept);
        }
    }

    /// Adds points that weigh what they tell, one by one.
    fn add_weighted(&mut self, scan: &Scan) -> Taken {
        let mut taken = Taken::default();
        let mut kept = self.lend_kept(scan.len());
        let Some(grid) = &mut self.fine else { return taken };
        for point in scan.world_points() {
            let added = point.map(|point| {
                let v = UncertainVector { value: point.position, error: point.sigma.unwrap_or([0.0; 3]) };
                grid.insert_weighted(&v, information(v.variance()))
            });
            match added {
                None => taken.not_finite += 1,
                Some(Ok(_)) => taken.points += 1,
                Some(Err(refusal)) => {
                    taken.refused += 1;
                    taken.first_refusal.get_or_insert(refusal);
                }
            }
            kept.cells.push(added.and_then(Result::ok));
        }
        self.give_back(kept, usize::MAX);
        taken
    }
}

/// What became of points that were inserted one part after the other.
pub(super) fn both(all: &Taken, taken: &Taken) -> Taken {
    Taken {
        points: all.points + taken.points,
        not_finite: all.not_finite + taken.not_finite,
        refused: all.refused + taken.refused,
        first_refusal: all.first_refusal.or(taken.first_refusal),
    }
}

/// Whether the error of any point is stated. Then it does not matter from where those of a pose without error were seen.
fn states_errors(scan: &Scan) -> bool {
    scan.world_points().flatten().any(|point| point.sigma.is_some_and(|sigma| sigma.iter().any(|s| *s > 0.0)))
}

/// `1/σ²` with the mean of the variances along the axes.
fn information([x, y, z]: [f64; 3]) -> f64 {
    3.0 / (x + y + z)
}

fn require_errors(scan: &Scan) -> Result<(), InsertError> {
    let weighs = |sigma: [f64; 3]| {
        let weight = information(sigma.map(|s| s * s));
        sigma.iter().all(|s| *s > 0.0) && weight > 0.0 && weight.is_finite()
    };
    let without =
        (0..scan.len()).find(|i| scan.world_point(*i).is_some_and(|p| !p.sigma.is_some_and(weighs)));
    without.map_or(Ok(()), |point| Err(InsertError::NoWeight { point }))
}
