//! The cells of a plane in columns along its normal.

use glam::DVec3;
use terrace_grid::VoxelKey;
use terrace_normals::CovariantPlane;
use terrace_stats::{Stats, SymmetricMatrix3};
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
    /// Of its cells near the plane, with the errors that are known or were found out.
    pub(crate) sum: Stats,
    /// What its cells are of.
    pub(crate) of: Of,
    /// From where it was seen; empty where that does not matter.
    pub(crate) seen: Vec<Sighting>,
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
    pub(crate) all: Vec<Column>,
    /// For each column those after it along its two directions.
    pub(crate) after: Vec<[Option<u32>; 2]>,
    /// And those before it.
    pub(crate) before: Vec<[Option<u32>; 2]>,
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
        let size = self.grid.cell_size();
        let mut keys: Vec<VoxelKey> = Vec::with_capacity(3 * of.len());
        for node in of {
            let Some(cell) = self.nodes.dense.cells().get(*node as usize).and_then(|id| self.grid.get(*id))
            else {
                continue;
            };
            let stats = cell.stats();
            let noise = match level {
                Some(level) => level.covariance(&self.errors, &stats, self.errors.seen(cell.id().index())),
                None => mean_noise(&stats),
            };
            let variance = noise.quadratic_form(near.normal.to_array());
            let reach = reach(variance, size);
            for step in -reach..=reach {
                let mut key = cell.key();
                key[axis] = key[axis].saturating_add(step);
                keys.push(key);
            }
        }
        let place = |key: &VoxelKey| [key[(axis + 1) % 3], key[(axis + 2) % 3]];
        keys.sort_unstable_by_key(|key| (place(key), key[axis]));
        keys.dedup();
        let columns = keys
            .chunk_by(|a, b| place(a) == place(b))
            .filter_map(|keys| self.column(plane, place(keys.first()?), keys, level))
            .collect();
        let mut columns = Columns { axis, all: columns, after: Vec::new(), before: Vec::new() };
        let rim: Vec<Column> = keys
            .chunk_by(|a, b| place(a) == place(b))
            .flat_map(|keys| self.rim(plane, axis, keys, &columns))
            .collect();
        columns.all.extend(rim);
        columns.all.sort_by_key(|column| column.place);
        columns.all.dedup_by_key(|column| column.place);
        columns.connect();
        if level.is_some() {
            columns.take_noise_from_around(near);
        }
        columns
    }

    /// What there is beside the column of these keys, at its height, where no column is.
    fn rim(&self, plane: Option<PlaneId>, axis: usize, keys: &[VoxelKey], columns: &Columns) -> Vec<Column> {
        let mut rim = Vec::new();
        for (side, step) in [(1, -1), (1, 1), (2, -1), (2, 1)] {
            let e = (axis + side) % 3;
            let beside: Vec<VoxelKey> = keys
                .iter()
                .map(|key| {
                    let mut key = *key;
                    key[e] = key[e].saturating_add(step);
                    key
                })
                .collect();
            let Some(place) = beside.first().map(|key| [key[(axis + 1) % 3], key[(axis + 2) % 3]]) else {
                continue;
            };
            if columns.find(place).is_none() {
                rim.extend(
                    self.column(plane, place, &beside, None).map(|column| Column { of: Of::Rim, ..column }),
                );
            }
        }
        rim
    }

    fn column(
        &self,
        plane: Option<PlaneId>,
        place: [i32; 2],
        keys: &[VoxelKey],
        level: Option<&NoiseLevel>,
    ) -> Option<Column> {
        let mut of = Of::Plane;
        let mut sum: Option<Stats> = None;
        let mut seen: Vec<Sighting> = Vec::new();
        for cell in keys.iter().filter_map(|key| self.grid.find(*key)) {
            let index = cell.id().index();
            if self.plane_of_cell.get(index).copied().flatten().is_some_and(|other| Some(other) != plane) {
                of = Of::Others;
            }
            sum.get_or_insert(Stats::new(cell.centre())).merge(&cell.stats());
            seen.extend(self.errors.seen(index));
        }
        let sum = sum?;
        let seen = merged(seen);
        let sum = match level {
            Some(level) => sum.with_noise(level.covariance(&self.errors, &sum, &seen) * sum.count() as f64),
            None => sum,
        };
        let mut column = Column { place, sum, of, seen, shared: SharedErrors::NONE };
        column.shared = SharedErrors::of(&column, self.errors.views);
        Some(column)
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
                column.sum = column.sum.with_noise(column.sum.moments().noise() * (variance / level));
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

    /// The plane of least variance through the columns that count.
    pub(crate) fn fit(&self, counts: &[bool]) -> Option<CovariantPlane> {
        CovariantPlane::of_cells(self.counted(counts).map(|column| &column.sum)).ok()?
    }

    /// What flat columns off the borders of the plane tell of the noise.
    pub(crate) fn residuals(&self, near: &Near, errors: &Errors, residuals: &mut Residuals) {
        let counts = self.near(near, errors.floor);
        for column in self.counted(&counts) {
            residuals.push(errors, &column.seen, &column.sum, near.normal.into());
        }
    }

    /// Those in a block about a place.
    pub(crate) fn block(&self, place: [i32; 2], reach: u32) -> Vec<bool> {
        let within = |column: &Column| (0..2).all(|i| column.place[i].abs_diff(place[i]) <= reach);
        self.all.iter().map(|column| column.of == Of::Plane && within(column)).collect()
    }

    /// The place of a voxel.
    pub(crate) fn place(&self, key: VoxelKey) -> [i32; 2] {
        [key[(self.axis + 1) % 3], key[(self.axis + 2) % 3]]
    }

    /// The variance of the means of columns along an axis, each counting by its points.
    pub(crate) fn spread_along(&self, counts: &[bool], axis: [f64; 3]) -> f64 {
        let axis = DVec3::from(axis);
        let places = || {
            self.counted(counts)
                .filter_map(|c| Some((c.sum.count() as f64, axis.dot(DVec3::from(c.sum.mean()?)))))
        };
        let points: f64 = places().map(|(points, _)| points).sum();
        let mean = places().map(|(points, at)| points * at).sum::<f64>() / points;
        places().map(|(points, at)| points * (at - mean).powi(2)).sum::<f64>() / points
    }
}

impl Column {
    /// The mean covariance of the error of a point.
    pub(crate) fn noise_of_points(&self) -> SymmetricMatrix3 {
        mean_noise(&self.sum) + self.shared.of_points
    }
}

/// A place and the eight beside it.
pub(crate) fn around([a, b]: [i32; 2]) -> impl Iterator<Item = [i32; 2]> {
    (-1..=1).flat_map(move |x: i32| (-1..=1).map(move |y: i32| [a.saturating_add(x), b.saturating_add(y)]))
}

/// The axis that the normal is nearest to.
fn main_axis(normal: DVec3) -> usize {
    normal.abs().max_position()
}

fn mean_noise(cell: &Stats) -> SymmetricMatrix3 {
    cell.moments().noise() * (1.0 / cell.count().max(1) as f64)
}

pub(crate) fn variance_along(cell: &Stats, direction: DVec3) -> f64 {
    mean_noise(cell).quadratic_form(direction.to_array())
}

/// Voxels that errors may carry a point of this variance to.
fn reach(variance: f64, size: f64) -> i32 {
    let voxels = (FAR * variance.max(0.0).sqrt() / size).ceil();
    // Also where it is NaN.
    (1..REACH).find(|reach| voxels <= f64::from(*reach)).unwrap_or(REACH)
}
