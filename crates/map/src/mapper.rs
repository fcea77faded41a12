//! The growing map: scans in.

use terrace_grid::{CellId, GridError, VoxelGrid};
use terrace_noise::PoseNoise;
use terrace_stats::{SymmetricMatrix3, UncertainVector};
use terrace_types::{Scan, WorldPoint};

use crate::cell_size::choose_from;
use crate::{CellSizeChoice, InsertError, Optimise, Params, ParamsError, Weighting};

/// Gathers scans into a grid of statistics, from which planes are extracted. See the [crate page](crate).
#[derive(Debug, Clone)]
pub struct Mapper {
    params: Params,
    chosen: Option<CellSizeChoice>,
    grid: Option<VoxelGrid>,
    /// The cell of every point so far, scan after scan; `None` for points that were left out.
    cell_of_point: Vec<Option<CellId>>,
    /// Where each point is, from the centre of its voxel, where labels are those of points.
    places: Vec<[f32; 3]>,
    /// Where the sensors stood, scan after scan.
    views: Vec<View>,
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
            grid: None,
            cell_of_point: Vec::new(),
            places: Vec::new(),
            views: Vec::new(),
        })
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

    /// The grid, from the first scan on.
    pub fn grid(&self) -> Option<&VoxelGrid> {
        self.grid.as_ref()
    }

    /// The cell size that was chosen from the first scan; `None` when one was given, or before the first scan.
    pub fn chosen_cell_size(&self) -> Option<CellSizeChoice> {
        self.chosen
    }

    /// Number of points so far, absent ones included: the number of labels.
    pub fn len(&self) -> usize {
        self.cell_of_point.len()
    }

    /// Whether no scan with a point was inserted.
    pub fn is_empty(&self) -> bool {
        self.cell_of_point.is_empty()
    }

    /// The cell of each point so far, scan after scan; `None` for points that were left out.
    pub fn cells_of_points(&self) -> &[Option<CellId>] {
        &self.cell_of_point
    }

    pub(crate) fn views(&self) -> &[View] {
        &self.views
    }

    pub(crate) fn places(&self) -> &[[f32; 3]] {
        &self.places
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
        let (choice, size) = match (&self.grid, self.params.cell_size) {
            (Some(grid), _) => (self.chosen, grid.cell_size()),
            (None, Some(size)) => (None, size),
            (None, None) => {
                let choice = choose_from(scan, pose.as_ref())
                    .ok_or(InsertError::NoCellSize { present: scan.present() })?;
                (Some(choice), choice.cell_size)
            }
        };
        let mut grid = match self.grid.take() {
            Some(grid) => grid,
            None => VoxelGrid::new(size, self.params.assignment)?,
        };
        self.chosen = choice;
        let mut inserted = Inserted { points: 0, absent: 0, out_of_range: 0, first_refusal: None };
        self.views.push(View { points: scan.len(), sensor: scan.sensor_position(), pose });
        self.cell_of_point.reserve(scan.len());
        let by_points = self.params.grows().is_some();
        if by_points {
            self.places.reserve(scan.len());
        }
        for point in scan.world_points() {
            let cell = match point {
                None => {
                    inserted.absent += 1;
                    None
                }
                Some(point) => match self.add(&mut grid, &point) {
                    Ok(cell) => Some(cell),
                    Err(refusal) => {
                        inserted.out_of_range += 1;
                        inserted.first_refusal.get_or_insert(refusal);
                        None
                    }
                },
            };
            inserted.points += usize::from(cell.is_some());
            self.cell_of_point.push(cell);
            if by_points {
                let centre = cell.and_then(|cell| grid.get(cell)).map(|cell| cell.centre());
                self.places.push(centre.zip(point).map_or([0.0; 3], |(centre, point)| {
                    // A thousandth of a per mille of a cell is enough.
                    #[allow(clippy::cast_possible_truncation)]
                    [0, 1, 2].map(|i| (point.position[i] - centre[i]) as f32)
                }));
            }
        }
        self.grid = Some(grid);
        Ok(inserted)
    }

    fn add(&self, grid: &mut VoxelGrid, point: &WorldPoint) -> Result<CellId, GridError> {
        let v = UncertainVector { value: point.position, error: point.sigma.unwrap_or([0.0; 3]) };
        match (self.params.weighting, point.covariance) {
            (Weighting::Uniform, None) => grid.insert(&v),
            (Weighting::Uniform, Some(c)) => grid.insert_covariant(point.position, &SymmetricMatrix3(c)),
            (Weighting::Information, _) => grid.insert_weighted(&v, information(v.variance())),
        }
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
