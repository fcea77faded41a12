//! The plane of least variance and its covariance, from the errors of points and poses.

mod cells;
mod columns;
mod faces;
mod level;
mod noise_around;
mod shared;
mod sightings;
mod support;

use glam::DVec3;
use rayon::prelude::*;
use terrace_grid::VoxelGrid;
use terrace_normals::{CovariantPlane, FitTo, estimate as min_max};
use terrace_stats::{Stats, SymmetricMatrix3};
use terrace_types::{Plane, PlaneId};

use crate::mapper::{Kept, View};
use crate::nodes::Nodes;
use crate::{ExtractedPlane, Mapper};

pub use cells::CellPlane;
use columns::{Columns, Near};
pub use level::{NoiseKnot, NoiseLevel};
pub(crate) use level::{Residual, Residuals};
pub use sightings::Sighting;
pub(crate) use sightings::Sightings;

/// Where a plane is taken for one with something else, the search for the larger part takes so many rounds at most.
const CORE_ROUNDS: usize = 10;
/// Cells are taken for their number of points, which near their faces depends on the errors: columns hold so many times the
/// density threshold, on average, for that not to matter.
const DENSE: f64 = 2.0;
/// What is left of a plane tells of it when it is at least so many columns, and at least one in so many.
const FEWEST_COLUMNS: usize = 4;
const SMALLEST_SHARE: usize = 5;
/// What scatters by more than this, in units of the variance usual in the map, is no plane: a strip along an edge, say.
pub(crate) const ROUGHEST: f64 = 2.0;
/// The share of the points' variance across a plane that lies between columns, at least, for their min-max to be told.
const CENTRES: f64 = 0.6;
/// What lies on a plane is looked for near the plane before, so many times.
const SUPPORT_ROUNDS: usize = 2;
/// The level of noise is first taken from about so many cells.
const SAMPLES: usize = 2000;
/// Residuals are larger than the errors say from so many of their own standard errors on.
const SIGNIFICANT: f64 = 3.0;

/// The plane of least variance, and how sure it is, from the standard errors of the points.
///
/// # What is covered
/// * Errors of points, independent of each other, of any covariance each. To first order: they are to be small against the
///   plane, and below about a sixth of a cell, those of poses at their distance included.
/// * Errors of poses, which all points of a scan share ([`Mapper::insert_from`]), and a floor below which nothing averages
///   out ([`Estimate::floor`](crate::Estimate::floor)).
/// * Residuals larger than all of these say, as far as they show within the plane: [`growth`](Self::growth).
///
/// Not covered: what moves or bends a whole plane and is none of these, and points of another surface within a cell's
/// reach of it that no test tells from the plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaneEstimate {
    /// The plane; its normal points to the same side as that of the [extracted plane](crate::ExtractedPlane).
    pub plane: Plane,
    /// The place on it that `tilt_offset` is about, in metres.
    pub centroid: [f64; 3],
    /// Unit vectors in the plane, along which the tilts are.
    pub axes: [[f64; 3]; 2],
    /// Covariance of (tilt₁, tilt₂, offset): radians and metres. The true normal is `n + tilt₁ e₁ + tilt₂ e₂`, the true plane
    /// `offset` further along the normal at the centroid, to first order. The same for the normal turned round.
    pub tilt_offset: [[f64; 3]; 3],
    /// Covariance of the coefficients (a, b, c, d), of rank 3.
    pub coefficients: [[f64; 4]; 4],
    /// Mean squared distance of the points from the plane in units of their errors: about 1 where the errors are right and
    /// the surface is flat.
    pub reduced_chi_squared: f64,
    /// What the part of the covariance that comes from points was multiplied by, because residuals are larger than errors
    /// say: the reduced χ² of the points or that of the means of cells, whichever is larger. 1 where neither is
    /// significantly above 1.
    pub growth: f64,
    /// Largest change of each component of the normal, were the centre of each column of cells off by its standard error in the
    /// worst way: the paper's min-max (Definition 3) for the plane. `None` when the centres lie nearly on a line.
    pub min_max: Option<[f64; 3]>,
    /// Number of columns of cells that it rests on.
    pub columns: usize,
}

impl PlaneEstimate {
    /// The standard error of the orientation where it is least sure, in radians.
    pub fn largest_tilt(&self) -> f64 {
        let [[a, b, _], [_, c, _], _] = self.tilt_offset;
        let middle = f64::midpoint(a, c);
        (middle + (0.5 * (a - c)).hypot(b)).max(0.0).sqrt()
    }

    /// With the normal on the side of `normal`.
    fn of(found: &Found, normal: [f64; 3]) -> Option<Self> {
        let fit = found.plane.fit;
        let plane = Plane::through(fit.centroid, fit.normal).ok()?;
        let opposite = DVec3::from(plane.normal()).dot(normal.into()) < 0.0;
        Some(Self {
            plane: if opposite { plane.flipped() } else { plane },
            centroid: fit.centroid,
            axes: fit.axes,
            tilt_offset: found.plane.tilt_offset.rows(),
            coefficients: found.plane.covariance_of_coefficients(),
            reduced_chi_squared: found.reduced_chi_squared,
            growth: found.growth,
            min_max: found.min_max,
            columns: found.columns,
        })
    }
}

/// A plane whose covariance holds everything.
pub(crate) struct Found {
    plane: CovariantPlane,
    reduced_chi_squared: f64,
    growth: f64,
    min_max: Option<[f64; 3]>,
    columns: usize,
}

/// What is known of the errors.
pub(crate) struct Errors<'m> {
    views: &'m [View],
    /// Where each cell was seen from, where that matters.
    sightings: Option<Sightings>,
    /// Found from the residuals, where no error is given.
    pub(crate) level: Option<NoiseLevel>,
    /// The same, by direction, where distances from the sensor are not known; only for regions.
    pub(crate) directed: Option<SymmetricMatrix3>,
    floor: f64,
}

/// The cells of a grid, which plane each is of, and their errors.
pub(crate) struct Owned<'g, 'm> {
    pub(crate) grid: &'g VoxelGrid,
    pub(crate) nodes: &'g Nodes,
    /// By cell.
    pub(crate) plane_of_cell: &'g [Option<PlaneId>],
    /// The density threshold.
    pub(crate) tau: u64,
    pub(crate) errors: Errors<'m>,
}

/// Puts beside each plane the one of least variance, and how sure that is. Needs cells whose points are those of a place,
/// each with weight 1. Gives back the errors, with the level that was found where none are stated.
pub(crate) fn estimate_planes<'m>(
    planes: &mut [ExtractedPlane],
    mut cells: Owned<'_, 'm>,
    plane_of_node: &[Option<PlaneId>],
) -> Errors<'m> {
    let nodes = cells.nodes;
    let mut nodes_of: Vec<Vec<u32>> = vec![Vec::new(); planes.len()];
    for (node, plane) in (0..).zip(plane_of_node) {
        if let Some(nodes) = plane.and_then(|plane| nodes_of.get_mut(plane.index())) {
            nodes.push(node);
        }
    }
    let known = nodes.know_errors(cells.grid);
    let level = if known { None } else { cells.level_of_cells(planes, &nodes_of) };
    if level.is_none() && !known {
        return cells.errors;
    }
    let mut columns: Vec<(Near, Columns)> = planes
        .par_iter()
        .zip(&nodes_of)
        .map(|(plane, of)| {
            let near = Near::to(plane);
            (near, cells.columns(Some(plane.id), of, &near, level.as_ref()))
        })
        .collect();
    if let Some(first) = level {
        // Single cells cut noise at their faces; columns of them show all of it.
        let mut residuals = Residuals::default();
        for (near, columns) in &columns {
            columns.residuals(near, &cells.errors, &mut residuals);
        }
        let level = NoiseLevel::of(&residuals).unwrap_or(first);
        columns.par_iter_mut().for_each(|(near, columns)| columns.take_level(near, &level, &cells.errors));
        cells.errors.level = Some(level);
    }
    planes.par_iter_mut().zip(&columns).for_each(|(plane, (near, columns))| {
        let found = cells.estimate(columns, near);
        plane.estimate = found.and_then(|found| PlaneEstimate::of(&found, plane.plane.normal()));
    });
    let limit = ROUGHEST * usual_chi_squared(planes);
    for plane in planes {
        plane.estimate = plane.estimate.filter(|estimate| estimate.reduced_chi_squared <= limit);
        if let Some(estimate) = plane.estimate {
            plane.plane = estimate.plane;
        }
    }
    cells.errors
}

/// That of the plane which has half of the points on smoother ones, and at least 1.
pub(crate) fn usual_chi_squared(planes: &[ExtractedPlane]) -> f64 {
    let mut seen: Vec<(f64, u64)> =
        planes.iter().filter_map(|plane| Some((plane.estimate?.reduced_chi_squared, plane.points))).collect();
    seen.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = seen.iter().map(|(_, points)| points).sum::<u64>() / 2;
    let mut sum = 0;
    let middle = seen.iter().find(|(_, points)| {
        sum += points;
        sum > half
    });
    middle.map_or(1.0, |(value, _)| value.max(1.0))
}

impl<'m> Errors<'m> {
    /// `kept` is what the map keeps of its points.
    pub(crate) fn of(mapper: &'m Mapper, kept: &[Kept], known: bool, floor: f64) -> Self {
        let views = mapper.views();
        let matters = |view: &View| view.pose.is_some() || (!known && view.sensor.is_some());
        let sightings = views.iter().any(matters).then(|| Sightings::of(mapper, kept));
        Self { views, sightings, level: None, directed: None, floor }
    }
}

impl Owned<'_, '_> {
    /// The level of noise that the cells of planes show.
    fn level_of_cells(&self, planes: &[ExtractedPlane], nodes_of: &[Vec<u32>]) -> Option<NoiseLevel> {
        let mut residuals = Residuals::default();
        let stride = nodes_of.iter().map(Vec::len).sum::<usize>() / SAMPLES + 1;
        for (plane, of) in planes.iter().zip(nodes_of) {
            for node in of.iter().step_by(stride) {
                let place = *node as usize;
                let cell = self.nodes.stats(self.grid, place).zip(self.nodes.dense.cells().get(place));
                let Some((stats, cell)) = cell else { continue };
                residuals.push(&self.errors, self.errors.seen(cell.index()), &stats, plane.plane.normal());
            }
        }
        NoiseLevel::of(&residuals)
    }

    /// The plane that the larger part of the columns lies on, and, where it is determined well enough, that of least variance with
    /// its covariance. `None` when no error
    /// is known, or what is left of the cells determines none.
    ///
    /// # Algorithm
    /// 1. A plane that lies near the face of a voxel has points on both sides of it, and few on one: too few for a dense
    ///    cell. Without them it would lie off, by far more than its error. So cells are taken in columns along the main axis
    ///    of the normal, whether dense or not.
    /// 2. Columns that hold cells of other planes, or whose points lie off or scatter by more than their errors do, are left
    ///    out, and those beside them.
    /// 3. Where the plane goes on beyond the last column, errors carry points over the border: those with an error to one
    ///    side in, those to the other out. What that adds to the sums is known, `∓ d/ξ nᵀ C e` for a face across the axis e of a
    ///    column of d points, and is taken back.
    /// 4. The covariance of the points' errors grows with the residuals; those of the poses and the floor are added.
    fn estimate(&self, columns: &Columns, near: &Near) -> Option<Found> {
        let floor = self.errors.floor;
        let fit = |counts: &[bool], near: &Near| {
            let mut found = columns.fit(counts, near.normal)?;
            columns.take_back_cuts(counts, &mut found, self.grid.cell_size());
            Some((Near::of(&found), found))
        };
        let (mut near, _) = fit(&columns.near(near, floor), near)?;
        for _ in 0..CORE_ROUNDS {
            let Some(core) = columns.core(&near, floor) else { break };
            let Some((better, _)) = fit(&core, &near) else { break };
            near = better;
        }
        let mut estimate: Option<(CovariantPlane, Vec<bool>)> = None;
        for _ in 0..SUPPORT_ROUNDS {
            let counts = columns.support(&near, floor);
            if estimate.as_ref().is_some_and(|(_, before)| *before == counts) {
                break;
            }
            let Some((better, found)) = fit(&counts, &near) else {
                estimate = None;
                break;
            };
            near = better;
            estimate = Some((found, counts));
        }
        estimate.and_then(|(found, counts)| self.supported(found, columns, &counts))
    }

    /// The estimate, if it rests on enough.
    fn supported(&self, found: CovariantPlane, columns: &Columns, counts: &[bool]) -> Option<Found> {
        let (of_plane, supporting) = (columns.of_plane(), columns.counted(counts).count());
        if supporting < FEWEST_COLUMNS || SMALLEST_SHARE * supporting < of_plane {
            return None;
        }
        self.complete(found, columns, counts)
    }

    /// The covariance with all that the points' errors do not tell.
    fn complete(&self, mut plane: CovariantPlane, columns: &Columns, counts: &[bool]) -> Option<Found> {
        let residuals = columns.chi_squared(counts, &plane, self.errors.floor);
        let growth = residuals
            .iter()
            .filter(|(value, freedom)| *value > 1.0 + SIGNIFICANT * (2.0 / freedom).sqrt())
            .fold(1.0, |growth: f64, (value, _)| growth.max(*value));
        plane.tilt_offset = plane.tilt_offset * growth;
        plane.tilt_offset +=
            columns.shared_by_scans(counts, &plane, self.errors.views, self.grid.cell_size());
        // What does not average out tells of a plane as much as a single point: of each tilt, one at the rms extent.
        let floor = self.errors.floor * self.errors.floor;
        let [_, across, along] = plane.fit.variances;
        plane.tilt_offset += SymmetricMatrix3::diagonal([floor / along, floor / across, floor]);
        let [(reduced_chi_squared, _), _] = residuals;
        let supporting = columns.counted(counts);
        // Only centres are moved: across a strip of one row of columns, they say nothing of what moves the plane.
        let sums: Vec<Stats> =
            supporting.map(|column| column.with_sample_variance(columns.anchor, plane.fit.normal)).collect();
        let points: u64 = sums.iter().map(Stats::count).sum();
        if (points as f64) < DENSE * self.tau as f64 * sums.len() as f64 {
            return None;
        }
        let min_max = min_max(&sums, FitTo::Points)
            .ok()
            .filter(|_| columns.spread_along(counts, plane.fit.axes[1]) >= CENTRES * plane.fit.variances[1]);
        Some(Found {
            plane,
            reduced_chi_squared,
            growth,
            min_max: min_max.map(|found| found.uncertainty),
            columns: sums.len(),
        })
    }
}
