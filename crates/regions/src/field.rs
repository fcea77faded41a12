//! All that is known of the cells before a region is grown.

use rayon::prelude::*;
use terrace_normals::PlaneFit;
use terrace_stats::Stats;

use crate::cell::{Noise, Sums};
use crate::flat::{Fitted, Flat};
use crate::level::Level;
use crate::{Cell, RegionsError};

/// Resolutions: that of the cells, and coarser ones, each with twice the edge of the one before.
pub(crate) const LEVELS: u32 = 4;
/// The level whose groups are as large as noise and spacing suggest for a cell.
pub(crate) const COARSE: usize = 1;
/// A neighbourhood with fewer points says too little.
const FEWEST: u64 = 8;
/// Points that scatter by less than this across their longer direction, in units of the variance of their errors, are a row.
const ROW: f64 = 2.0;

/// The cells, at several resolutions, and the plane around each group.
#[derive(Debug)]
pub(crate) struct Field {
    pub(crate) cells: Vec<Sums>,
    pub(crate) keys: Vec<[i32; 3]>,
    pub(crate) levels: Vec<Level>,
    /// By level and group: the plane of the points of a group and of those it touches.
    pub(crate) around: Vec<Vec<Option<Around>>>,
    /// The edge of a cell, in metres.
    pub(crate) edge: f64,
}

/// The plane of a neighbourhood.
#[derive(Debug, Clone)]
pub(crate) struct Around {
    pub(crate) plane: Flat,
    fit: PlaneFit,
    points: f64,
    /// Mean variance of the errors along the normal and across the longer direction in the plane, as stated, in m².
    stated: f64,
    stated_across: f64,
}

impl Field {
    /// # Errors
    /// [`RegionsError`] for a cell without points or whose sums are not finite, and for more cells than are numbered.
    pub(crate) fn of(cells: &[Cell], edge: f64) -> Result<Self, RegionsError> {
        if !(edge.is_normal() && edge > 0.0) {
            return Err(RegionsError::Edge { edge });
        }
        if u32::try_from(cells.len()).is_err() {
            return Err(RegionsError::TooMany { cells: cells.len() });
        }
        let keys: Vec<[i32; 3]> = cells.iter().map(|cell| cell.key).collect();
        let sums = cells
            .par_iter()
            .enumerate()
            .map(|(cell, of)| Sums::of(of.stats).ok_or(RegionsError::Cell { cell }))
            .collect::<Result<Vec<Sums>, RegionsError>>()?;
        let levels: Vec<Level> = (0..LEVELS).into_par_iter().map(|level| Level::of(&keys, level)).collect();
        if let Some(places) = levels.first().map(Level::len).filter(|places| *places != cells.len()) {
            return Err(RegionsError::SameKey { cells: cells.len(), places });
        }
        let around = levels.iter().map(|level| planes_around(level, &sums)).collect();
        Ok(Self { cells: sums, keys, levels, around, edge })
    }

    /// The edge of a group of the level that suits noise and spacing, in metres.
    pub(crate) fn coarse_edge(&self) -> f64 {
        self.edge * f64::from(1_u32 << COARSE)
    }

    /// The plane of some cells.
    pub(crate) fn fit(&self, cells: &[u32], noise: Noise) -> Option<Fitted> {
        Fitted::of_cells(cells.iter().map(|cell| &self.cells[*cell as usize]), noise)
    }
}

/// For each cell the sums of its points and those of the up to 26 cells that share a face, an edge or a corner with it.
/// The keys of cells are to be different.
pub fn sums_around(cells: &[Cell]) -> Vec<Stats> {
    let keys: Vec<[i32; 3]> = cells.iter().map(|cell| cell.key).collect();
    let level = Level::of(&keys, 0);
    let around = |cell: usize| {
        let mut sum = cells[cell].stats;
        level.near(cell).iter().for_each(|near| sum.merge(&cells[*near as usize].stats));
        sum
    };
    (0..level.len()).into_par_iter().map(around).collect()
}

fn planes_around(level: &Level, cells: &[Sums]) -> Vec<Option<Around>> {
    let sum = |group: usize| -> Option<Stats> {
        let mut members = level.cells(group).iter().map(|cell| &cells[*cell as usize].stats);
        let mut sum = *members.next()?;
        members.for_each(|stats| sum.merge(stats));
        Some(sum)
    };
    let sums: Vec<Option<Stats>> = (0..level.len()).into_par_iter().map(sum).collect();
    let around = |group: usize| {
        let mut sum = sums[group]?;
        level
            .near(group)
            .iter()
            .filter_map(|near| sums[*near as usize].as_ref())
            .for_each(|near| sum.merge(near));
        Around::of(&sum)
    };
    (0..level.len()).into_par_iter().map(around).collect()
}

impl Around {
    fn of(sum: &Stats) -> Option<Self> {
        if sum.count() < FEWEST {
            return None;
        }
        let fit = terrace_normals::fit_plane(sum).ok()?;
        let points = sum.count() as f64;
        let stated = sum.moments().noise().quadratic_form(fit.normal) / points;
        let stated_across = sum.moments().noise().quadratic_form(fit.axes[1]) / points;
        Some(Self { plane: Flat::of(&fit), fit, points, stated, stated_across })
    }

    fn variance(&self, noise: Noise) -> f64 {
        (noise.scale * self.stated).max(noise.floor)
    }

    /// Variance of the points along the normal. Three of their freedoms went into the plane.
    fn thickness(&self) -> f64 {
        self.fit.variances[0] * self.points / (self.points - 3.0)
    }

    /// Standard error of the orientation where it is least sure, in radians.
    pub(crate) fn tilt(&self, noise: Noise) -> f64 {
        (self.thickness().max(self.variance(noise)) / (self.points * self.fit.variances[1])).sqrt()
    }

    /// Whether the points are a row: what they scatter across it is little more than their errors, so that the plane through them
    /// turns about the row as those fall. A ring of a lidar is one, a step of a depth image another.
    pub(crate) fn is_row(&self, noise: Noise) -> bool {
        let [_, across, _] = self.fit.variances;
        across <= ROW * (noise.scale * self.stated_across).max(noise.floor)
    }

    /// Whether the points lie as flat as their errors say, give or take what so few of them tell, and not along a line.
    pub(crate) fn is_flat(&self, noise: Noise, chi_squared: f64, narrowest: f64) -> bool {
        let [_, across, along] = self.fit.variances;
        let allowed = chi_squared * (1.0 + 3.0 * (2.0 / self.points).sqrt());
        self.thickness() <= allowed * self.variance(noise)
            && across >= narrowest * along
            && !self.is_row(noise)
    }
}
