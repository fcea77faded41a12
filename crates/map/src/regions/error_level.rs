//! The errors of points from the places around cells, where none are stated.

use terrace_grid::CellId;
use terrace_normals::{PlaneFit, fit_planes};
use terrace_regions::Field;
use terrace_stats::{Stats, SymmetricMatrix3};

use super::directed::{Place, by_direction};
use crate::estimate::{Errors, NoiseLevel, Residual};

/// Places with fewer points say little of their scatter.
const FEWEST: u64 = 12;
/// Planes that are fitted at once: as many as the widest vectors hold.
const SIDE_BY_SIDE: usize = 8;
/// Places whose points scatter across their longer direction by less than this share of the variance along it are strips.
const WIDTH: f64 = 0.2;

impl Errors<'_> {
    /// Finds the level of noise from how the points around each cell scatter about a plane of their own, in the median; by direction
    /// where distances from the sensor are not known.
    /// `of` is the cell of the grid that each is a part of.
    pub(crate) fn find_level(&mut self, field: &mut Field, of: &[CellId]) {
        let residual = |cell: usize, around: &Stats, fit: &PlaneFit| {
            let seen = self.seen(of.get(cell)?.index());
            let [_, across, along] = fit.variances;
            let is_told = around.count() >= FEWEST && across >= WIDTH * along;
            let residual = is_told.then(|| Residual::of(self, seen, around, fit.normal));
            Some((fit.normal, residual??))
        };
        let residuals = |cells: [Option<usize>; SIDE_BY_SIDE], around: &[Stats; SIDE_BY_SIDE]| {
            let fits = fit_planes(around);
            std::array::from_fn(|at| residual(cells[at]?, &around[at], fits[at].as_ref().ok()?))
        };
        let mut seen: Vec<([f64; 3], Residual)> = Vec::with_capacity(of.len());
        seen.extend(field.sums_around_several(residuals).flatten());
        self.level = NoiseLevel::of(&seen.iter().map(|(_, residual)| *residual).collect());
        let is_known = |level: &NoiseLevel| level.knots.iter().all(|knot| knot.range.is_some());
        if !self.level.as_ref().is_none_or(is_known) {
            let place = |(normal, residual): &([f64; 3], Residual)| Place {
                normal: *normal,
                variance: residual.variance,
            };
            self.directed = by_direction(&seen.iter().map(place).collect::<Vec<Place>>());
        }
    }

    /// The mean covariance of the error of a point of some place in a cell; zero when none is known.
    pub(crate) fn of_place(&self, place: &Stats, cell: CellId) -> SymmetricMatrix3 {
        if let Some(directed) = self.directed {
            return directed;
        }
        let level = self.level.as_ref();
        level.map_or(SymmetricMatrix3::ZERO, |level| level.covariance(self, place, self.seen(cell.index())))
    }
}
