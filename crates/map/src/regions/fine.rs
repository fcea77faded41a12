//! The fine cells, as regions take them.

use terrace_grid::{CellId, VoxelGrid};
use terrace_regions::{Cell, Field, Found, RegionsError};
use terrace_stats::{Stats, SymmetricMatrix3};
use terrace_types::PlaneId;

use super::MOSTLY;
use crate::estimate::Errors;
use crate::mapper::Coarse;

/// The cells of half the cell size.
pub(crate) struct Fine<'m> {
    grid: &'m VoxelGrid,
    coarse: &'m Coarse,
    cells: Vec<CellId>,
    /// The larger cell that each is a part of.
    of: Vec<CellId>,
    pub(crate) places: Places,
    /// Points of all cells.
    pub(crate) points: u64,
}

/// By cell of the grid, its place among the cells; empty where that is the same for all.
#[derive(Debug, Clone, Default)]
pub(crate) struct Places(Vec<Option<u32>>);

impl Places {
    /// The place among the cells of a cell of the grid.
    #[inline]
    pub(crate) fn of(&self, cell: CellId) -> Option<u32> {
        if self.0.is_empty() { u32::try_from(cell.index()).ok() } else { *self.0.get(cell.index())? }
    }
}

impl<'m> Fine<'m> {
    /// Sums that overflow are no cell of a region: their points are of no plane.
    pub(crate) fn of(grid: &'m VoxelGrid, coarse: &'m Coarse) -> Self {
        let mut fine = Self {
            grid,
            coarse,
            cells: Vec::with_capacity(grid.len()),
            of: Vec::with_capacity(grid.len()),
            places: Places::default(),
            points: 0,
        };
        let mut places: Vec<Option<u32>> = Vec::with_capacity(grid.len());
        for (cell, of) in grid.founded().zip(&coarse.of) {
            let (moments, place) = (cell.moments(), u32::try_from(fine.cells.len()).ok());
            let usable = moments.noise().is_finite() && moments.second().is_finite();
            places.push(place.filter(|_| usable));
            if usable {
                fine.cells.push(cell.id());
                fine.of.push(*of);
                fine.points += cell.density();
            }
        }
        if fine.cells.len() < places.len() {
            fine.places = Places(places);
        }
        fine
    }

    /// The cells laid out for regions to grow over.
    pub(crate) fn field(&self) -> Result<Field, RegionsError> {
        let cell = |at: usize| {
            let cell = self.cells.get(at).and_then(|id| self.grid.get(*id));
            // All are cells of the grid.
            cell.map_or(Cell { key: [0; 3], stats: Stats::new([0.0; 3]) }, |cell| Cell {
                key: cell.key(),
                stats: cell.stats(),
            })
        };
        Field::of_each(self.cells.len(), cell, self.grid.cell_size())
    }

    /// The number of the cell of the grid at a place.
    pub(crate) fn number(&self, place: usize) -> Option<u32> {
        u32::try_from(self.cells.get(place)?.index()).ok()
    }

    /// Gives the cells the errors that flat places show, which are then in `errors`.
    pub(crate) fn find_errors(&self, field: &mut Field, errors: &mut Errors) -> Result<(), RegionsError> {
        errors.find_level(field, &self.of);
        field.set_noise(|at| {
            let stats = self.grid.get(self.cells[at]).map(|cell| cell.stats());
            stats.map_or(SymmetricMatrix3::ZERO, |stats| {
                errors.of_place(&stats, self.of[at]) * stats.count() as f64
            })
        })
    }

    /// For each cell of the cell size the plane that most of its points are of.
    pub(crate) fn planes_of_cells(&self, found: &Found) -> Vec<Option<PlaneId>> {
        let mut shares: Vec<(CellId, u32, u64)> =
            found.shares.iter().map(|s| (self.of[s.cell as usize], s.region, u64::from(s.points))).collect();
        shares.sort_unstable();
        shares.dedup_by(|next, first| {
            let same = (next.0, next.1) == (first.0, first.1);
            first.2 += if same { next.2 } else { 0 };
            same
        });
        let mut owner = vec![None; self.coarse.grid.len()];
        for of_cell in shares.chunk_by(|a, b| a.0 == b.0) {
            let Some((cell, region, points)) = of_cell.iter().rev().max_by_key(|(_, _, points)| points)
            else {
                continue;
            };
            let density = self.coarse.grid.get(*cell).map_or(0, |cell| cell.density());
            if *points as f64 >= MOSTLY * density as f64 {
                owner[cell.index()] = PlaneId::from_index(*region as usize);
            }
        }
        owner
    }
}
