//! A map taken apart, and put together again.

use terrace_grid::{CellId, GridError, VoxelGrid, VoxelKey};
use terrace_regions::{SampleError, Samples};
use terrace_stats::Moments;

use super::{Mapper, View};
use crate::estimate::{Sighting, Sightings};
use crate::seen::Seen;
use crate::{CellSizeChoice, Params, StreamingError};

/// What rounding may add to the distance of a point from the centre of its cell, as a share of it.
const ROUNDING: f64 = 1e-3;

/// A cell of a map. Cells have the edge of [`Mapper::edge`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapCell<'m> {
    /// Index of the voxel: the point p lies in `floor(p / edge)`.
    pub key: VoxelKey,
    /// Number of points, L, S and E, relative to the centre of the cell of the map's cell size that the cell is or is in, in metres.
    pub sums: Moments,
    /// Places of some of the points relative to the same centre, in metres; empty where no regions are grown.
    pub sample: &'m [[f32; 3]],
    /// How often the sample was halved, see [`Samples::halvings`].
    pub halvings: u8,
    /// How many points each view saw, in the order of the views.
    pub seen: &'m [Sighting],
}

/// A map taken apart: [`Mapper::parts`].
pub struct MapParts<'m> {
    mapper: &'m Mapper,
    sightings: Sightings,
}

/// Why parts are not those of a map.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum PartsError {
    /// The parameters are of no map that can do without its points.
    #[error(transparent)]
    Params(#[from] StreamingError),
    /// A cell size was chosen where one was given, or what it follows from is no length.
    #[error("the chosen cell size of {} m (spacing {} m, noise {} m) is not one, or another was given", .0.cell_size, .0.spacing, .0.sigma)]
    Choice(CellSizeChoice),
    /// There are cells and no cell size.
    #[error("there is no cell size")]
    NoCellSize,
    /// The grid refuses the cell size, or a cell.
    #[error(transparent)]
    Grid(#[from] GridError),
    /// A view without its sensor has an uncertain pose, a sensor that is not finite, more points missing than it has, or more than can be
    /// counted.
    #[error("view {view} contradicts itself: {points} points, the sensor at {sensor:?}")]
    View {
        /// Its place among the views, from 0.
        view: usize,
        /// Its points.
        points: usize,
        /// Its sensor.
        sensor: Option<[f64; 3]>,
    },
    /// A voxel has two cells.
    #[error("there are two cells of the voxel {key:?}")]
    SameKey {
        /// The voxel.
        key: VoxelKey,
    },
    /// Sums are not finite, or no points in the cell have these sums.
    #[error("the sums of the cell {key:?} are not those of {points} points in it")]
    Sums {
        /// The voxel.
        key: VoxelKey,
        /// The number of its points.
        points: u64,
    },
    /// A sample is none, or larger than the number of points.
    #[error("the sample of the cell {key:?}: {error}")]
    Sample {
        /// The voxel.
        key: VoxelKey,
        /// What is wrong.
        error: SampleError,
    },
    /// Views that do not exist or are not in order have seen a cell, or all together not as many points as it has.
    #[error("what views saw of the cell {key:?} are not its {points} points")]
    Seen {
        /// The voxel.
        key: VoxelKey,
        /// The number of its points.
        points: u64,
    },
    /// The cells have more or fewer points of a view than it has.
    #[error("the cells hold {found} points of view {view}, which has {points}")]
    ViewPoints {
        /// Its place among the views, from 0.
        view: usize,
        /// How many of its points are in the map.
        points: usize,
        /// How many the cells hold.
        found: u64,
    },
}

impl Mapper {
    /// The map taken apart: its views and cells, from which [`MapBuilder`] makes the same map again, but for points that were kept.
    ///
    /// # Errors
    /// [`StreamingError::NotByPlace`] where cells and views do not tell all of a map.
    pub fn parts(&self) -> Result<MapParts<'_>, StreamingError> {
        if !self.params.by_place() {
            return Err(StreamingError::NotByPlace);
        }
        Ok(MapParts { mapper: self, sightings: Sightings::of_fine(self) })
    }

    /// Edge of the cells that points are added to, in metres: half the cell size where regions are grown. `None` before there is a cell
    /// size.
    pub fn edge(&self) -> Option<f64> {
        Some(if self.params.grows().is_some() { 0.5 * self.cell_size()? } else { self.cell_size()? })
    }

    /// The cell size, in metres: given, or chosen from the first scan. `None` before there is one.
    pub fn cell_size(&self) -> Option<f64> {
        self.params.cell_size.or(self.chosen.map(|chosen| chosen.cell_size))
    }

    /// The scans so far, in the order of insertion.
    pub fn views(&self) -> &[View] {
        &self.views
    }

    /// Number of cells that points were added to.
    pub fn cells(&self) -> usize {
        self.fine.as_ref().map_or(0, VoxelGrid::len)
    }

    /// Whether the standard errors of any point are known.
    pub fn knows_errors(&self) -> bool {
        let known = |cell: terrace_grid::Cell| cell.stats().moments().noise().trace() > 0.0;
        self.fine.iter().flat_map(VoxelGrid::founded).any(known)
    }
}

impl MapParts<'_> {
    /// The map.
    pub fn mapper(&self) -> &Mapper {
        self.mapper
    }

    /// Its cells, in the order in which they were founded.
    pub fn cells(&self) -> impl Iterator<Item = MapCell<'_>> {
        let cells = self.mapper.fine.iter().flat_map(VoxelGrid::founded);
        cells.map(|cell| {
            let number = number(cell.id());
            MapCell {
                key: cell.key(),
                sums: *cell.stats().moments(),
                sample: self.mapper.samples.of(number),
                halvings: self.mapper.samples.halvings(number),
                seen: self.sightings.of_cell(cell.id().index()),
            }
        })
    }
}

/// Puts a map together from its parts, which may come from anywhere: all are checked.
///
/// ```
/// use terrace::{Frame, MapBuilder, Mapper, Params, Scan, Sigma};
///
/// let floor = (0..10_000).map(|k| [0.02 * f64::from(k % 100), 0.02 * f64::from(k / 100), 0.0]);
/// let scan = Scan::new(floor.collect(), Sigma::Uniform(0.005), Frame::World { sensor: None })?;
/// let mut mapper = Mapper::streaming(Params::default())?;
/// mapper.insert(&scan)?;
///
/// let parts = mapper.parts()?;
/// let mut builder = MapBuilder::new(*mapper.params(), mapper.chosen_cell_size(), mapper.views().to_vec())?;
/// for cell in parts.cells() {
///     builder.push(&cell)?;
/// }
/// let again = builder.finish()?;
/// assert_eq!(again.extract()?, mapper.extract()?);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct MapBuilder {
    mapper: Mapper,
    seen: Seen,
    samples: Samples,
    /// Points of each view that the cells hold, and whether a sighting is as large as any can be.
    of_views: Vec<(u64, bool)>,
    /// The largest distance of a point from what sums are relative to, along an axis.
    reach: f64,
}

impl MapBuilder {
    /// A map of these settings, of a cell size that was chosen where none was given, and of these views.
    ///
    /// # Errors
    /// [`PartsError`] for settings, a choice or a view that cannot be.
    pub fn new(params: Params, chosen: Option<CellSizeChoice>, views: Vec<View>) -> Result<Self, PartsError> {
        let mut mapper = Mapper::streaming(params)?;
        if let Some(choice) = chosen {
            let lengths = choice.spacing.is_finite() && choice.sigma.is_finite();
            if params.cell_size.is_some() || !lengths {
                return Err(PartsError::Choice(choice));
            }
        }
        mapper.chosen = chosen;
        if let Some(size) = mapper.cell_size() {
            mapper.fine = Some(mapper.grid_of(size)?);
        } else if !views.is_empty() {
            return Err(PartsError::NoCellSize);
        }
        let mut all = 0_usize;
        for (number, view) in views.iter().enumerate() {
            let whole = view.present().is_some() && u32::try_from(number).is_ok();
            let placed = view.sensor.map_or(view.pose.is_none(), |at| at.iter().all(|x| x.is_finite()));
            let sum = all.checked_add(view.points).filter(|_| whole && placed);
            let (points, sensor) = (view.points, view.sensor);
            all = sum.ok_or(PartsError::View { view: number, points, sensor })?;
        }
        let reach = 0.5 * (1.0 + ROUNDING) * mapper.cell_size().unwrap_or(0.0);
        let of_views = vec![(0, false); views.len()];
        mapper.views = views;
        Ok(Self { mapper, seen: Seen::default(), samples: Samples::default(), of_views, reach })
    }

    /// Adds a cell, after those that were founded before it.
    ///
    /// # Errors
    /// [`PartsError`] for one that is not of this map.
    pub fn push(&mut self, cell: &MapCell) -> Result<(), PartsError> {
        let (key, points) = (cell.key, cell.sums.count());
        if !are_sums(&cell.sums, self.reach) {
            return Err(PartsError::Sums { key, points });
        }
        self.count(cell)?;
        let grid = self.mapper.fine.as_mut().ok_or(PartsError::NoCellSize)?;
        let before = grid.len();
        let id = grid.add_cell(key, &cell.sums)?;
        if grid.len() == before {
            return Err(PartsError::SameKey { key });
        }
        let sample = |error| PartsError::Sample { key, error };
        if cell.sample.len() as u64 > points {
            return Err(sample(SampleError::TooMany { places: cell.sample.len() }));
        }
        // A map that keeps none has no room for them either.
        if !cell.sample.is_empty() || cell.halvings > 0 {
            let far = |place: &&[f32; 3]| place.iter().any(|x| f64::from(x.abs()) > self.reach);
            if let Some(place) = cell.sample.iter().find(far) {
                return Err(sample(SampleError::Place { place: *place, halvings: cell.halvings }));
            }
            self.samples.restore(number(id), cell.sample, cell.halvings).map_err(sample)?;
        }
        self.seen.restore(id, cell.seen);
        Ok(())
    }

    /// Counts the points of views.
    fn count(&mut self, cell: &MapCell) -> Result<(), PartsError> {
        let (mut sum, mut full, mut next) = (0, false, 0);
        for sighting in cell.seen {
            let view = sighting.view as usize;
            let known = self.of_views.get_mut(view).filter(|_| view >= next && sighting.points > 0);
            let error = PartsError::Seen { key: cell.key, points: cell.sums.count() };
            let of_view = known.ok_or(error)?;
            let points = u64::from(sighting.points);
            // Points beyond what a sighting counts are counted by the cell alone.
            let saturated = sighting.points == u32::MAX;
            *of_view = (of_view.0.saturating_add(points), of_view.1 | saturated);
            (sum, full, next) = (sum + points, full | saturated, view + 1);
        }
        let points = cell.sums.count();
        if sum == points || (full && sum < points) {
            Ok(())
        } else {
            Err(PartsError::Seen { key: cell.key, points })
        }
    }

    /// The map, which [forgets](Mapper::streaming) its points. It can grow on.
    ///
    /// # Errors
    /// [`PartsError::ViewPoints`] when cells are missing.
    pub fn finish(self) -> Result<Mapper, PartsError> {
        let Self { mut mapper, seen, samples, of_views, .. } = self;
        for (view, (found, full)) in of_views.into_iter().enumerate() {
            let points = mapper.views[view].present().unwrap_or(0);
            if !(found == points as u64 || (full && found < points as u64)) {
                return Err(PartsError::ViewPoints { view, points, found });
            }
        }
        mapper.samples = samples;
        mapper.seen = Some(seen);
        Ok(mapper)
    }
}

/// Whether there are points within this reach of the anchor, along each axis, that have these sums, weights of 1 and errors.
fn are_sums(sums: &Moments, reach: f64) -> bool {
    let count = sums.count() as f64;
    let (sum, second, noise) = (sums.sum(), sums.second(), sums.noise());
    let finite = sum.iter().all(|x| x.is_finite()) && second.is_finite() && noise.is_finite();
    let squares = second.diagonal_entries();
    let within = (0..3).all(|i| {
        let least = sum[i] * sum[i] / count * (1.0 - ROUNDING);
        sum[i].abs() <= count * reach && least <= squares[i] && squares[i] <= count * reach * reach
    });
    let covariances = (0..3).all(|i| noise.diagonal_entries()[i] >= 0.0);
    sums.count() > 0 && sums.weight().to_bits() == count.to_bits() && finite && within && covariances
}

/// The number of a cell, as samples take it.
pub(super) fn number(cell: CellId) -> u32 {
    // A grid numbers its cells with 32 bits.
    #[allow(clippy::cast_possible_truncation)]
    let number = cell.index() as u32;
    number
}
