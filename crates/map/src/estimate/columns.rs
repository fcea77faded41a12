//! The cells of a plane in columns along its normal.

use std::ops::RangeInclusive;

use glam::DVec3;
use terrace_grid::VoxelKey;
use terrace_normals::CovariantPlane;
use terrace_stats::{Moments, Stats, SymmetricMatrix3};
use terrace_types::PlaneId;

use super::level::{NoiseLevel, Residuals, scatter_along};
use super::shared::SharedErrors;
use super::sightings::{Sighting, merged};
use super::{Errors, ExtractedPlane, Owned};

/// Errors of this many standard errors are still looked for beyond the cells of a plane.
const FAR: f64 = 4.0;
/// Voxels above and below that are looked at, at most: errors larger than cells say little of a plane.
const REACH: i32 = 4;
/// The level of noise around a column is taken from so many columns at least.
const FEWEST_AROUND: usize = 4;
/// And is at most this, in units of the variance of the level of the map.
const MOST_NOISE: f64 = 4.0;

/// A plane that another one is near to.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Near {
    pub(crate) centroid: DVec3,
    pub(crate) normal: DVec3,
}

impl Near {
    pub(crate) fn to(plane: &ExtractedPlane) -> Self {
        Self { centroid: plane.centroid.into(), normal: plane.plane.normal().into() }
    }

    pub(crate) fn of(plane: &CovariantPlane) -> Self {
        Self { centroid: plane.fit.centroid.into(), normal: plane.fit.normal.into() }
    }
}

/// A column of voxels along the main axis.
#[derive(Debug, Clone)]
pub(crate) struct Column {
    /// Its other two indices.
    pub(crate) place: [i32; 2],
    /// Of its cells near the plane, about the anchor of the columns, with the errors that are known or were found out.
    pub(crate) sum: Moments,
    /// What its cells are of.
    pub(crate) of: Of,
    /// From where it was seen, where that matters.
    pub(crate) seen: Option<Box<Seen>>,
}

/// From where the points of a column were seen.
#[derive(Debug, Clone)]
pub(crate) struct Seen {
    pub(crate) from: Vec<Sighting>,
    pub(crate) shared: SharedErrors,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Of {
    /// The plane, and of no other.
    Plane,
    /// Another plane as well.
    Others,
    /// No cell is of the plane: it goes on there with fewer points, or ends beside it.
    Rim,
}

/// In rising order of their places.
pub(crate) struct Columns {
    pub(crate) axis: usize,
    /// What the sums are relative to.
    pub(crate) anchor: [f64; 3],
    pub(crate) all: Vec<Column>,
    /// For each column those after it along its two directions.
    pub(crate) after: Vec<[Option<u32>; 2]>,
    /// And those before it.
    pub(crate) before: Vec<[Option<u32>; 2]>,
}

/// What the columns of a plane are made from.
struct Building<'a> {
    owned: &'a Owned<'a>,
    plane: Option<PlaneId>,
    level: Option<&'a NoiseLevel>,
    axis: usize,
    anchor: [f64; 3],
}

impl Owned<'_> {
    /// The columns with cells of the plane, in a fixed order.
    pub(crate) fn columns(
        &self,
        plane: Option<PlaneId>,
        of: &[u32],
        near: &Near,
        level: Option<&NoiseLevel>,
    ) -> Columns {
        let axis = main_axis(near.normal);
        let building = Building { owned: self, plane, level, axis, anchor: near.centroid.to_array() };
        let heights = building.heights(of, near.normal);
        let mut all: Vec<Column> = Vec::with_capacity(heights.len());
        all.extend(
            heights.iter().filter_map(|(place, heights)| building.column(*place, heights.clone(), level)),
        );
        let mut columns =
            Columns { axis, anchor: building.anchor, all, after: Vec::new(), before: Vec::new() };
        let rim: Vec<Column> = heights
            .iter()
            .flat_map(|(place, heights)| beside(*place).map(|beside| (beside, heights.clone())))
            .filter(|(beside, _)| columns.find(*beside).is_none())
            .filter_map(|(beside, heights)| building.column(beside, heights, None))
            .map(|column| Column { of: Of::Rim, ..column })
            .collect();
        if !rim.is_empty() {
            columns.all.extend(rim);
            columns.all.sort_by_key(|column| column.place);
            columns.all.dedup_by_key(|column| column.place);
        }
        columns.connect();
        if level.is_some() {
            columns.take_noise_from_around(near);
        }
        columns
    }
}

impl Building<'_> {
    /// For each place with cells of the plane, in order, the heights at which its points may be.
    fn heights(&self, of: &[u32], normal: DVec3) -> Vec<([i32; 2], RangeInclusive<i32>)> {
        let Owned { grid, nodes, errors, .. } = self.owned;
        let size = grid.cell_size();
        let cells = of.iter().filter_map(|node| {
            let (stats, id) = (nodes.stats.get(*node as usize)?, *nodes.dense.cells().get(*node as usize)?);
            let noise = match self.level {
                Some(level) => level.covariance(errors, stats, errors.seen(id.index())),
                None => mean_noise(stats.moments()),
            };
            let reach = reach(noise.quadratic_form(normal.to_array()), size);
            let key = grid.get(id)?.key();
            let height = key[self.axis];
            Some((place_of(key, self.axis), height.saturating_sub(reach)..=height.saturating_add(reach)))
        });
        let mut cells: Vec<_> = cells.collect();
        cells.sort_unstable_by_key(|(place, heights)| (*place, *heights.start()));
        cells.dedup_by(|next, first| {
            let same = next.0 == first.0;
            if same {
                first.1 = *first.1.start()..=*first.1.end().max(next.1.end());
            }
            same
        });
        cells
    }

    fn column(
        &self,
        place: [i32; 2],
        heights: RangeInclusive<i32>,
        level: Option<&NoiseLevel>,
    ) -> Option<Column> {
        let Owned { grid, plane_of_cell, errors, .. } = self.owned;
        let mut of = Of::Plane;
        let mut sum = Stats::new(self.anchor);
        let mut seen: Vec<Sighting> = Vec::new();
        for height in heights {
            let mut key = [height; 3];
            key[(self.axis + 1) % 3] = place[0];
            key[(self.axis + 2) % 3] = place[1];
            let Some(cell) = grid.find(key) else { continue };
            let index = cell.id().index();
            if plane_of_cell.get(index).copied().flatten().is_some_and(|other| Some(other) != self.plane) {
                of = Of::Others;
            }
            sum.merge(&cell.stats());
            seen.extend(errors.seen(index));
        }
        if sum.count() == 0 {
            return None;
        }
        let seen = (!seen.is_empty()).then(|| Seen::of(merged(seen), &sum, errors.views)).map(Box::new);
        let sum = match level {
            Some(level) => {
                let from = seen.as_ref().map_or(&[][..], |seen| &seen.from);
                sum.with_noise(level.covariance(errors, &sum, from) * sum.count() as f64)
            }
            None => sum,
        };
        Some(Column { place, sum: *sum.moments(), of, seen })
    }
}

impl Columns {
    pub(crate) fn find(&self, place: [i32; 2]) -> Option<usize> {
        self.all.binary_search_by_key(&place, |column| column.place).ok()
    }

    /// Takes the level of noise from the columns around each, in their median, where the level of the whole map was taken: it
    /// knows how far a surface is, but not how it reflects or at what angle it was seen. What scatters far more than the level is no
    /// noise.
    fn take_noise_from_around(&mut self, near: &Near) {
        let shown: Vec<Option<f64>> = self
            .all
            .iter()
            .map(|column| {
                let level = variance_along(&column.sum, near.normal);
                let shown =
                    scatter_along(&column.sum, near.normal.to_array()).filter(|_| column.of == Of::Plane)?;
                Some(shown.min(MOST_NOISE * level))
            })
            .collect();
        let near_normal = near.normal;
        for at in 0..self.all.len() {
            let around = around(self.all[at].place).filter_map(|place| self.find(place));
            let mut near: Vec<f64> = around.filter_map(|at| shown.get(at).copied().flatten()).collect();
            near.sort_by(f64::total_cmp);
            if near.len() >= FEWEST_AROUND
                && let Some(variance) = near.get(near.len() / 2).filter(|variance| **variance > 0.0)
            {
                let column = &mut self.all[at];
                let level = variance_along(&column.sum, near_normal);
                column.sum = column.sum.with_noise(column.sum.noise() * (variance / level));
            }
        }
    }

    /// Finds the neighbours of each column.
    fn connect(&mut self) {
        self.after = vec![[None; 2]; self.all.len()];
        self.before = self.after.clone();
        for at in 0..self.all.len() {
            let [a, b] = self.all[at].place;
            for (side, place) in [[a.saturating_add(1), b], [a, b.saturating_add(1)]].into_iter().enumerate()
            {
                let Some(found) = self.find(place).filter(|found| *found != at) else { continue };
                // Columns are as many as cells at most, which are numbered with 32 bits.
                self.after[at][side] = u32::try_from(found).ok();
                self.before[found][side] = u32::try_from(at).ok();
            }
        }
    }

    pub(crate) fn counted<'c>(&'c self, counts: &'c [bool]) -> impl Iterator<Item = &'c Column> + Clone {
        self.all.iter().zip(counts).filter(|(_, counts)| **counts).map(|(column, _)| column)
    }

    /// The plane of least variance through the columns that count, near one with this normal.
    pub(crate) fn fit(&self, counts: &[bool], normal: DVec3) -> Option<CovariantPlane> {
        let sums = self.counted(counts).map(|column| &column.sum);
        CovariantPlane::near(self.anchor, sums, normal.to_array()).ok()?
    }

    /// What flat columns off the borders of the plane tell of the noise.
    pub(crate) fn residuals(&self, near: &Near, errors: &Errors, residuals: &mut Residuals) {
        let counts = self.near(near, errors.floor);
        for column in self.counted(&counts) {
            let from = column.seen.as_ref().map_or(&[][..], |seen| &seen.from);
            let place = Stats::from_moments(self.anchor, column.sum);
            residuals.push(errors, from, &place, near.normal.into());
        }
    }

    /// Those in a block about a place.
    pub(crate) fn block(&self, place: [i32; 2], reach: u32) -> Vec<bool> {
        let within = |column: &Column| (0..2).all(|i| column.place[i].abs_diff(place[i]) <= reach);
        self.all.iter().map(|column| column.of == Of::Plane && within(column)).collect()
    }

    /// The place of a voxel.
    pub(crate) fn place(&self, key: VoxelKey) -> [i32; 2] {
        place_of(key, self.axis)
    }

    /// The variance of the means of columns along an axis, each counting by its points.
    pub(crate) fn spread_along(&self, counts: &[bool], axis: [f64; 3]) -> f64 {
        let axis = DVec3::from(axis);
        let places = || self.counted(counts).map(|c| (c.sum.count() as f64, axis.dot(c.mean())));
        let points: f64 = places().map(|(points, _)| points).sum();
        let mean = places().map(|(points, at)| points * at).sum::<f64>() / points;
        places().map(|(points, at)| points * (at - mean).powi(2)).sum::<f64>() / points
    }
}

impl Column {
    /// Of its points, from the anchor of the columns.
    pub(crate) fn mean(&self) -> DVec3 {
        DVec3::from(self.sum.sum()) / self.sum.weight()
    }

    /// The mean covariance of the error of a point.
    pub(crate) fn noise_of_points(&self) -> SymmetricMatrix3 {
        let shared = self.seen.as_ref().map_or(SymmetricMatrix3::ZERO, |seen| seen.shared.of_points);
        mean_noise(&self.sum) + shared
    }
}

/// A place and the eight beside it.
pub(crate) fn around([a, b]: [i32; 2]) -> impl Iterator<Item = [i32; 2]> {
    (-1..=1).flat_map(move |x: i32| (-1..=1).map(move |y: i32| [a.saturating_add(x), b.saturating_add(y)]))
}

/// The four places at its sides.
fn beside([a, b]: [i32; 2]) -> impl Iterator<Item = [i32; 2]> {
    let beside = [[-1, 0], [1, 0], [0, -1], [0, 1]];
    beside.into_iter().map(move |[x, y]: [i32; 2]| [a.saturating_add(x), b.saturating_add(y)])
}

fn place_of(key: VoxelKey, axis: usize) -> [i32; 2] {
    [key[(axis + 1) % 3], key[(axis + 2) % 3]]
}

/// The axis that the normal is nearest to.
fn main_axis(normal: DVec3) -> usize {
    normal.abs().max_position()
}

fn mean_noise(cell: &Moments) -> SymmetricMatrix3 {
    cell.noise() * (1.0 / cell.count().max(1) as f64)
}

pub(crate) fn variance_along(cell: &Moments, direction: DVec3) -> f64 {
    cell.noise().quadratic_form(direction.to_array()) / cell.count().max(1) as f64
}

/// Voxels that errors may carry a point of this variance to.
fn reach(variance: f64, size: f64) -> i32 {
    let voxels = (FAR * variance.max(0.0).sqrt() / size).ceil();
    // Also where it is NaN.
    (1..REACH).find(|reach| voxels <= f64::from(*reach)).unwrap_or(REACH)
}
