//! The errors of points from the places around cells, where none are stated.

use terrace_grid::CellId;
use terrace_normals::fit_plane;
use terrace_regions::{Cell, sums_around};
use terrace_stats::{Stats, SymmetricMatrix3};

use crate::estimate::{Errors, NoiseLevel, Residuals};

/// Places with fewer points say little of their scatter.
const FEWEST: u64 = 12;
/// Places whose points scatter across their longer direction by less than this share of the variance along it are strips.
const WIDTH: f64 = 0.2;

impl Errors<'_> {
    /// Finds the level of noise from how the points around each cell scatter about a plane of their own, in the median.
    /// `of` is the cell of the grid that each is a part of.
    pub(crate) fn find_level(&mut self, cells: &[Cell], of: &[CellId]) {
        let mut residuals = Residuals::default();
        for (around, of) in sums_around(cells).iter().zip(of) {
            if around.count() < FEWEST {
                continue;
            }
            let Ok(fit) = fit_plane(around) else { continue };
            let [_, across, along] = fit.variances;
            if across >= WIDTH * along {
                residuals.push(self, self.seen(of.index()), around, fit.normal);
            }
        }
        self.level = NoiseLevel::of(&residuals);
    }

    /// The mean covariance of the error of a point of some place in a cell; zero when none is known.
    pub(crate) fn of_place(&self, place: &Stats, cell: CellId) -> SymmetricMatrix3 {
        let level = self.level.as_ref();
        level.map_or(SymmetricMatrix3::ZERO, |level| level.covariance(self, place, self.seen(cell.index())))
    }
}
