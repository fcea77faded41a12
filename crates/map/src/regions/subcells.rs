//! Cells of half the edge, from where points lie in their cell.

use terrace_grid::{CellId, VoxelGrid};
use terrace_regions::{Cell, Points, Segmentation};
use terrace_stats::{Moments, Stats, UncertainVector};
use terrace_types::PlaneId;

use super::MOSTLY;
use crate::Mapper;
use crate::estimate::Errors;

/// The eighths of the cells of a grid that hold points, in the order of the keys of the cells.
pub(crate) struct Subcells<'m> {
    grid: &'m VoxelGrid,
    places: &'m [[f32; 3]],
    /// The points of each, about the centre of its cell.
    moments: Vec<Moments>,
    keys: Vec<[i32; 3]>,
    /// The cell that each is an eighth of.
    of: Vec<CellId>,
    /// That of each point.
    points: Vec<Option<u32>>,
}

impl<'m> Subcells<'m> {
    pub(crate) fn of(mapper: &'m Mapper, grid: &'m VoxelGrid) -> Self {
        // Sums that overflow are no cell of a region: their points are of no plane.
        let mut usable = vec![false; grid.len()];
        for cell in grid.iter() {
            usable[cell.id().index()] = cell.stats().moments().noise().is_finite();
        }
        let of_points = || {
            let known = |(cell, place): (&Option<CellId>, &'m [f32; 3])| {
                let at = (*cell)?.index();
                (usable[at] && place.iter().all(|x| x.is_finite())).then_some((at, place))
            };
            mapper.cells_of_points().iter().zip(mapper.places()).map(known)
        };
        let mut occupied = vec![0_u8; grid.len()];
        for (at, place) in of_points().flatten() {
            occupied[at] |= 1 << eighth(place);
        }
        let (mut keys, mut of) = (Vec::new(), Vec::new());
        let mut first = vec![0_u32; grid.len()];
        for cell in grid.iter() {
            let at = cell.id().index();
            first[at] = number(keys.len());
            for eighth in (0..8).filter(|eighth| occupied[at] >> eighth & 1 == 1) {
                keys.push([0, 1, 2].map(|i| 2 * cell.key()[i] + (eighth >> i & 1)));
                of.push(cell.id());
            }
        }
        let mut moments = vec![Moments::EMPTY; keys.len()];
        let points = of_points().map(|point| {
            let (at, place) = point?;
            let before = occupied[at] & ((1 << eighth(place)) - 1);
            let subcell = first[at] + before.count_ones();
            moments[subcell as usize].push(&UncertainVector::exact(place.map(f64::from)));
            Some(subcell)
        });
        let points: Vec<Option<u32>> = points.collect();
        Self { grid, places: mapper.places(), moments, keys, of, points }
    }

    /// The points, as regions take them.
    pub(crate) fn points(&self) -> Points<'_> {
        Points { cells: &self.points, places: self.places }
    }

    /// The cells, each with the errors of its points: those of the larger cell where they are stated, else those that flat places
    /// show, which are then in `errors`.
    pub(crate) fn with_errors(&self, errors: &mut Errors, stated: bool) -> Vec<Cell> {
        let sums = |at: usize| {
            let cell = self.grid.get(self.of[at])?;
            Some((cell, Stats::from_moments(cell.centre(), self.moments[at])))
        };
        let of_cells = |errors: Option<&Errors>| -> Vec<Cell> {
            let cell = |at: usize| {
                let (cell, stats) = sums(at)?;
                let of_point = errors.map_or_else(
                    || {
                        let all = cell.stats();
                        all.moments().noise() * (1.0 / all.count().max(1) as f64)
                    },
                    |errors| errors.of_place(&stats, cell.id()),
                );
                let stats = stats.with_noise(of_point * stats.count() as f64);
                Some(Cell { key: self.keys[at], stats })
            };
            (0..self.keys.len()).filter_map(cell).collect()
        };
        let cells = of_cells(None);
        if stated {
            return cells;
        }
        errors.find_level(&cells, &self.of);
        of_cells(Some(errors))
    }

    /// For each cell of the grid the plane that most of its points are of.
    pub(crate) fn planes_of_cells(&self, found: &Segmentation) -> Vec<Option<PlaneId>> {
        let mut shares: Vec<(CellId, u32, u64)> =
            found.shares.iter().map(|s| (self.of[s.cell as usize], s.region, u64::from(s.points))).collect();
        shares.sort_unstable();
        shares.dedup_by(|next, first| {
            let same = (next.0, next.1) == (first.0, first.1);
            first.2 += if same { next.2 } else { 0 };
            same
        });
        let mut owner = vec![None; self.grid.len()];
        for of_cell in shares.chunk_by(|a, b| a.0 == b.0) {
            let Some((cell, region, points)) = of_cell.iter().rev().max_by_key(|(_, _, points)| points)
            else {
                continue;
            };
            let density = self.grid.get(*cell).map_or(0, |cell| cell.density());
            if *points as f64 >= MOSTLY * density as f64 {
                owner[cell.index()] = PlaneId::from_index(*region as usize);
            }
        }
        owner
    }
}

/// Which eighth of its cell a point is in, by its place from the centre.
fn eighth(place: &[f32; 3]) -> u8 {
    (0..3).map(|i| u8::from(place[i] >= 0.0) << i).sum()
}

/// A grid numbers its cells with 32 bits, and eighths without points are not numbered; points of more than 2³² eighths would not fit
/// into memory.
#[allow(clippy::cast_possible_truncation)]
fn number(place: usize) -> u32 {
    place as u32
}
