//! A map put together from its parts.

use terrace_grid::{GridError, VoxelKey};
use terrace_regions::{SampleError, SampledPoint};
use terrace_stats::Moments;

use super::parts::MapCell;
use super::{Mapper, View, cell_number};
use crate::seen::Seen;
use crate::{CellSizeChoice, Params, StreamingError};

/// What rounding may add to the distance of a point from the centre of its cell, as a share of it.
const ROUNDING: f64 = 1e-3;
/// The same of a place that a sample keeps, rounded to a 128th of that at most.
const ROUNDING_OF_SAMPLES: f64 = 0.5 / 128.0;

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
            mapper.begin(size)?;
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
        Ok(Self { mapper, seen: Seen::default(), of_views, reach })
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
        if !cell.sample.is_empty() || cell.halvings > 0 {
            let reach = self.reach * (1.0 + ROUNDING_OF_SAMPLES);
            let far = |point: &SampledPoint| point.place.iter().any(|x| f64::from(x.abs()) > reach);
            if let Some(SampledPoint { place, endures }) = cell.sample.iter().copied().find(far) {
                return Err(sample(SampleError::Place { place, endures, halvings: cell.halvings }));
            }
            // A map that grows no regions has none.
            if let Some(samples) = &mut self.mapper.samples {
                samples.restore(cell_number(id), &cell.sample, cell.halvings).map_err(sample)?;
            }
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
        let Self { mut mapper, seen, of_views, .. } = self;
        for (view, (found, full)) in of_views.into_iter().enumerate() {
            let points = mapper.views[view].present().unwrap_or(0);
            if !(found == points as u64 || (full && found < points as u64)) {
                return Err(PartsError::ViewPoints { view, points, found });
            }
        }
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
