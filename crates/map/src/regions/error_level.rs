//! The errors of points from the places around cells, where none are stated.

use terrace_grid::CellId;
use terrace_normals::fit_plane;
use terrace_regions::Field;
use terrace_stats::{Stats, SymmetricMatrix3};

use super::directed::{Place, by_direction};
use crate::estimate::{Errors, NoiseLevel, Residual};

/// Places with fewer points say little of their scatter.
const FEWEST: u64 = 12;
/// Places whose points scatter across their longer direction by less than this share of the variance along it are strips.
const WIDTH: f64 = 0.2;

impl Errors<'_> {
    /// Finds the level of noise from how the points around each cell scatter about a plane of their own, in the median; by direction
    /// where distances from the sensor are not known.
    /// `of` is the cell of the grid that each is a part of.
    pub(crate) fn find_level(&mut self, field: &Field, of: &[CellId]) {
        let residual = |cell: usize, around: &Stats| {
            let seen = self.seen(of.get(cell)?.index());
            if around.count() < FEWEST {
                return None;
            }
            let fit = fit_plane(around).ok()?;
            let [_, across, along] = fit.variances;
            let residual = (across >= WIDTH * along).then(|| Residual::of(self, seen, around, fit.normal));
            Some((fit.normal, residual??))
        };
        let seen: Vec<([f64; 3], Residual)> = field.sums_around(residual).into_iter().flatten().collect();
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
