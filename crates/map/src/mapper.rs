//! The growing map: scans in.

use std::sync::OnceLock;

use terrace_grid::{CellId, GridError, Taken, VoxelGrid};
use terrace_noise::PoseNoise;
use terrace_regions::Samples;
use terrace_stats::UncertainVector;
use terrace_types::Scan;

use crate::cell_size::choose_from;
use crate::seen::Seen;
use crate::world::World;
use crate::{CellSizeChoice, InsertError, Optimise, Params, ParamsError, StreamingError, Weighting};

/// Points that are moved to the world at once.
const AT_ONCE: usize = 1 << 20;

/// Gathers scans into a grid of statistics, from which planes are extracted. See the [crate page](crate).
#[derive(Debug, Clone)]
pub struct Mapper {
    params: Params,
    chosen: Option<CellSizeChoice>,
    /// The cells that points are added to: of half the cell size where regions are grown.
    fine: Option<VoxelGrid>,
    /// Cells of the cell size, where they are not those that points are added to.
    coarse: OnceLock<Option<Coarse>>,
    /// Some points of each fine cell, where regions are grown.
    samples: Samples,
    kept: Kept,
    /// What each view saw of which cell, where points are not kept.
    seen: Option<Seen>,
    /// Where the sensors stood, scan after scan.
    views: Vec<View>,
}

/// Cells of the cell size, made of those of half of it.
#[derive(Debug, Clone)]
pub(crate) struct Coarse {
    pub(crate) grid: VoxelGrid,
    /// For each fine cell, the one it is a part of.
    pub(crate) of: Vec<CellId>,
}

/// What is kept of every point so far, scan after scan.
#[derive(Debug, Clone, Default)]
pub(crate) struct Kept {
    /// The fine cell; `None` for points that were left out.
    pub(crate) cells: Vec<Option<CellId>>,
    /// Where it is, from the centre of its voxel, where labels are those of points.
    pub(crate) places: Vec<[f32; 3]>,
}

impl Kept {
    fn clear(&mut self) {
        self.cells.clear();
        self.places.clear();
    }
}

/// The points of a scan and where they were seen from.
#[derive(Debug, Clone, Copy)]
pub(crate) struct View {
    pub(crate) points: usize,
    pub(crate) sensor: Option<[f64; 3]>,
    /// How sure its pose is.
    pub(crate) pose: Option<PoseNoise>,
}

/// What became of the points of a scan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inserted {
    /// Points that are now in the map.
    pub points: usize,
    /// Absent points: not finite.
    pub absent: usize,
    /// Points left out: too many cells away from the origin, or beyond the number of cells a grid holds.
    pub out_of_range: usize,
    /// The reason for the first point left out.
    pub first_refusal: Option<GridError>,
}

impl Mapper {
    /// An empty map.
    ///
    /// # Errors
    /// [`ParamsError`] when a parameter cannot be used.
    pub fn new(params: Params) -> Result<Self, ParamsError> {
        params.validate()?;
        Ok(Self {
            params,
            chosen: None,
            fine: None,
            coarse: OnceLock::new(),
            samples: Samples::default(),
            kept: Kept::default(),
            seen: None,
            views: Vec::new(),
        })
    }

    /// An empty map that forgets points once they are added: its memory grows with the cells that hold one, and with how many
    /// scans saw each. For scans that do not fit into memory, see [`Mapper::insert_more`] and [`Mapper::extract_streamed`].
    ///
    /// # Errors
    /// [`StreamingError`] when a parameter cannot be used, or points could not be told again by where they are
    /// ([`Params::by_place`]).
    pub fn streaming(params: Params) -> Result<Self, StreamingError> {
        if !params.by_place() {
            return Err(StreamingError::NotByPlace);
        }
        Ok(Self { seen: Some(Seen::default()), ..Self::new(params)? })
    }

    /// Changes how the next extractions search for φ; the points need not be inserted again.
    ///
    /// # Errors
    /// [`ParamsError`] when a setting cannot be used; the old ones stay.
    pub fn set_optimise(&mut self, optimise: Option<Optimise>) -> Result<(), ParamsError> {
        let params = Params { optimise, ..self.params };
        params.validate()?;
        self.params = params;
        Ok(())
    }

    /// The parameters as given.
    pub fn params(&self) -> &Params {
        &self.params
    }

    /// The grid, from the first scan on. Where regions are grown it is made of cells of half the size when it is asked for the first
    /// time after an insertion.
    pub fn grid(&self) -> Option<&VoxelGrid> {
        if self.params.grows().is_some() {
            self.coarse().map(|coarse| &coarse.grid)
        } else {
            self.fine.as_ref()
        }
    }

    /// The cells that points are added to.
    pub(crate) fn fine(&self) -> Option<&VoxelGrid> {
        self.fine.as_ref()
    }

    pub(crate) fn coarse(&self) -> Option<&Coarse> {
        let made = || {
            let (grid, of) = self.fine.as_ref()?.halved().ok()?;
            Some(Coarse { grid, of })
        };
        self.coarse.get_or_init(made).as_ref()
    }

    pub(crate) fn samples(&self) -> &Samples {
        &self.samples
    }

    pub(crate) fn kept(&self) -> &Kept {
        &self.kept
    }

    /// What each view saw, where points are not kept.
    pub(crate) fn seen(&self) -> Option<&Seen> {
        self.seen.as_ref()
    }

    /// Whether points are forgotten once they are added: the map was made by [`Mapper::streaming`].
    pub fn is_streaming(&self) -> bool {
        self.seen.is_some()
    }

    /// Whether the first scan will be asked for a cell size: none is given, and none was chosen yet.
    pub fn wants_cell_size(&self) -> bool {
        self.fine.is_none() && self.params.cell_size.is_none()
    }

    /// Begins the map with a cell size that was chosen beforehand, from all of a scan that is inserted in chunks: see
    /// [`CellSizeSample`](crate::CellSizeSample). Nothing happens where none is [wanted](Self::wants_cell_size).
    ///
    /// # Errors
    /// [`InsertError::Grid`] when the grid refuses it.
    pub fn begin_with(&mut self, choice: CellSizeChoice) -> Result<(), InsertError> {
        if self.wants_cell_size() {
            self.fine = Some(self.grid_of(choice.cell_size)?);
            self.chosen = Some(choice);
        }
        Ok(())
    }

    fn grid_of(&self, size: f64) -> Result<VoxelGrid, GridError> {
        match self.params.grows() {
            Some(_) => VoxelGrid::of_halves(size),
            None => VoxelGrid::new(size, self.params.assignment),
        }
    }

    /// The cell size that was chosen from the first scan; `None` when one was given, or before the first scan.
    pub fn chosen_cell_size(&self) -> Option<CellSizeChoice> {
        self.chosen
    }

    /// Number of points so far, absent ones included: the number of labels.
    pub fn len(&self) -> usize {
        self.views.iter().map(|view| view.points).sum()
    }

    /// Whether no scan with a point was inserted.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The cell of each point so far, scan after scan; `None` for points that were left out. None at all where they are not kept.
    pub fn cells_of_points(&self) -> impl ExactSizeIterator<Item = Option<CellId>> {
        let coarse = self.params.grows().and_then(|_| self.coarse());
        self.kept.cells.iter().map(move |cell| match coarse {
            None => *cell,
            Some(coarse) => coarse.of.get((*cell)?.index()).copied(),
        })
    }

    pub(crate) fn views(&self) -> &[View] {
        &self.views
    }

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
            self.fine = Some(self.grid_of(size)?);
        }
        self.chosen = choice;
        if let (Some(seen), Some(last)) = (&mut self.seen, self.views.len().checked_sub(1)) {
            seen.end_view(last);
        }
        self.views.push(View { points: 0, sensor: scan.sensor_position(), pose });
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
            Weighting::Uniform => self.add_all(scan)?,
            Weighting::Information => self.add_weighted(scan),
        };
        if let Some(view) = self.views.last_mut() {
            view.points += scan.len();
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

    /// Adds points with weight 1, many at once.
    fn add_all(&mut self, scan: &Scan) -> Result<Taken, InsertError> {
        let mut all = Taken::default();
        let Some(grid) = &mut self.fine else { return Ok(all) };
        let grows = self.params.grows().is_some();
        let mut world = World::default();
        let mut forgotten = Kept::default();
        let kept = if self.seen.is_some() { &mut forgotten } else { &mut self.kept };
        for first in (0..scan.len()).step_by(AT_ONCE) {
            let (points, errors) = world.part(scan, first..(first + AT_ONCE).min(scan.len()));
            if self.seen.is_some() {
                kept.clear();
            }
            let begin = kept.cells.len();
            let places = grows.then_some(&mut kept.places);
            let taken = grid.insert_all(points, errors, &mut kept.cells, places)?;
            all = Taken {
                points: all.points + taken.points,
                not_finite: all.not_finite + taken.not_finite,
                refused: all.refused + taken.refused,
                first_refusal: all.first_refusal.or(taken.first_refusal),
            };
            if let Some(seen) = &mut self.seen {
                seen.push(&kept.cells);
            }
            if grows {
                let cells = &kept.cells[begin..];
                // A grid numbers its cells with 32 bits.
                #[allow(clippy::cast_possible_truncation)]
                let cell = |at: usize| cells[at].map(|cell| cell.index() as u32);
                self.samples.push_all(cell, &kept.places[begin..]);
            }
        }
        Ok(all)
    }

    /// Adds points that weigh what they tell, one by one.
    fn add_weighted(&mut self, scan: &Scan) -> Taken {
        let mut taken = Taken::default();
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
            self.kept.cells.push(added.and_then(Result::ok));
        }
        taken
    }
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
