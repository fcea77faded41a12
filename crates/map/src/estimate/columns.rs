//! The cells of a plane in columns along its normal.

use glam::DVec3;
use terrace_grid::VoxelKey;
use terrace_normals::{CovariantPlane, PlaneFit};
use terrace_stats::{Stats, SymmetricMatrix3};
use terrace_types::PlaneId;

use super::level::{NoiseLevel, Residuals, scatter_along};
use super::shared::SharedErrors;
use super::sightings::{Sighting, merged};
use super::{Errors, ExtractedPlane, Owned};

/// Cells further off than this many standard errors of their points are not of the plane.
const FAR: f64 = 4.0;
/// Columns whose mean or scatter is off by more of its standard errors hold something else.
const DEVIATIONS: f64 = 4.0;
/// Where columns usually deviate by more than this, in units of their variance, a plane is looked for that fits most.
const ROUGH: f64 = 2.0;
/// Columns that deviate by no more of their usual deviation are most likely of it.
const CORE: f64 = 2.0;
/// Voxels above and below that are looked at, at most: errors larger than cells say little of a plane.
const REACH: i32 = 4;
/// Columns whose weights differ by less count alike.
const ALIKE: f64 = 1e-3;
/// The level of noise around a column is taken from so many columns at least.
const FEWEST_AROUND: usize = 4;
/// And is at most this, in units of the variance of the level of the map.
const MOST_NOISE: f64 = 4.0;
/// The median of χ² of one degree of freedom.
const MEDIAN: f64 = 0.4549;

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
    place: [i32; 2],
    /// Of its cells near the plane, with the errors that are known or were found out.
    pub(crate) sum: Stats,
    /// What its cells are of.
    of: Of,
    /// From where it was seen; empty where that does not matter.
    pub(crate) seen: Vec<Sighting>,
    shared: SharedErrors,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Of {
    /// The plane, and of no other.
    Plane,
    /// Another plane as well.
    Others,
    /// No cell is of the plane: it goes on there with fewer points, or ends beside it.
    Rim,
}

/// In rising order of their places.
pub(crate) struct Columns {
    axis: usize,
    pub(crate) all: Vec<Column>,
    /// For each column those after it along its two directions.
    after: Vec<[Option<u32>; 2]>,
    /// And those before it.
    before: Vec<[Option<u32>; 2]>,
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
    fn find(&self, place: [i32; 2]) -> Option<usize> {
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

    /// Which columns lie on the plane as far as their points can tell one by one, and have none beside them that does not.
    pub(crate) fn near(&self, near: &Near, floor: f64) -> Vec<bool> {
        let lies_on = |deviation: &Deviation| deviation.off <= FAR * FAR && deviation.scatter <= FAR * FAR;
        self.apart(self.deviations(near, floor).iter().map(|d| d.as_ref().is_some_and(lies_on)))
    }

    /// Which columns lie on the plane and have none beside them that does not: the mean by its own error, the scatter by that
    /// of a scatter.
    pub(crate) fn support(&self, near: &Near, floor: f64) -> Vec<bool> {
        let deviations = self.deviations(near, floor);
        let usual = Usual::of(&deviations);
        self.apart(self.all.iter().zip(&deviations).map(|(column, deviation)| {
            deviation.as_ref().is_some_and(|d| usual.holds(d, column.sum.count(), DEVIATIONS))
        }))
    }

    /// Which columns lie on the plane better than most do, where most do not lie as well as errors say: the plane may be off,
    /// because a part of its cells are those of something else. `None` where they do.
    pub(crate) fn core(&self, near: &Near, floor: f64) -> Option<Vec<bool>> {
        let deviations = self.deviations(near, floor);
        let usual = Usual::of(&deviations);
        (usual.mean > ROUGH).then(|| {
            let core = |(column, deviation): (&Column, &Option<Deviation>)| {
                deviation.as_ref().is_some_and(|d| usual.holds(d, column.sum.count(), CORE))
            };
            self.all.iter().zip(&deviations).map(core).collect()
        })
    }

    /// `None` for columns that are not of the plane alone.
    fn deviations(&self, near: &Near, floor: f64) -> Vec<Option<Deviation>> {
        self.all.iter().map(|c| c.deviation(near, floor).filter(|_| c.of == Of::Plane)).collect()
    }

    /// Those for which it holds, and for all beside them.
    fn apart(&self, holds: impl Iterator<Item = bool>) -> Vec<bool> {
        let mut counts = vec![true; self.all.len()];
        // From the few for which it does not: the others need no look around.
        for ((at, column), _) in self.all.iter().enumerate().zip(holds).filter(|(_, holds)| !holds) {
            counts[at] = false;
            if column.of == Of::Rim {
                continue;
            }
            for near in around(column.place).filter_map(|place| self.find(place)) {
                counts[near] = false;
            }
        }
        counts
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

    /// Mean squared residuals in units of their variance, with their degrees of freedom: of points from the plane, and
    /// of the means of columns, which also tell of errors that neighbouring points share.
    pub(crate) fn chi_squared(&self, counts: &[bool], plane: &CovariantPlane, floor: f64) -> [(f64, f64); 2] {
        let near = Near::of(plane);
        let (mut of_points, mut of_means) = ((0.0, -3.0), (0.0, -3.0));
        for (at, column) in self.all.iter().enumerate().filter(|(at, _)| counts[*at]) {
            let Some(deviation) = column.deviation(&near, floor) else { continue };
            let count = column.sum.count() as f64;
            of_points = (of_points.0 + count * (deviation.scatter + deviation.off), of_points.1 + count);
            // Errors carry points from column to column and with them the mean, which is made up for by the columns on the
            // other side; not so at a border.
            let sides = self.after[at].into_iter().chain(self.before[at]);
            let within = sides.into_iter().all(|side| side.is_some_and(|side| counts[side as usize]));
            if within {
                of_means = (of_means.0 + deviation.mean, of_means.1 + 1.0);
            }
        }
        [of_points, of_means].map(|(sum, freedom): (f64, f64)| {
            // Three residuals tell nothing: a plane goes through three points.
            if freedom < 1.0 { (0.0, 1.0) } else { (sum / freedom, freedom) }
        })
    }

    /// Moves the plane back by what the errors carry over the faces between columns: those with an error to one side in,
    /// those to the other out. Where both columns count alike, one gains what the other loses.
    pub(crate) fn take_back_cuts(&self, counts: &[bool], plane: &mut CovariantPlane, size: f64) {
        let PlaneFit { centroid, normal, axes, .. } = plane.fit;
        let (centroid, normal, [e1, e2]) =
            (DVec3::from(centroid), DVec3::from(normal), axes.map(DVec3::from));
        let weights: Vec<f64> = self
            .all
            .iter()
            .zip(counts)
            .map(|(column, counts)| if *counts { plane.weight(&column.sum) } else { 0.0 })
            .collect();
        let mut pull = DVec3::ZERO;
        for (at, (column, weight)) in self.all.iter().zip(&weights).enumerate() {
            for (side, beside) in [1, 2].into_iter().zip(self.after[at]) {
                let Some(beside) = beside.map(|place| place as usize) else { continue };
                let step = weight - weights[beside];
                if step.abs() <= ALIKE * weight {
                    continue;
                }
                let other = &self.all[beside];
                // The one that counts, and the direction from it to the other.
                let (inner, outer, sign) =
                    if counts[at] { (column, other, 1.0) } else { (other, column, -1.0) };
                let Some(mean) = inner.sum.mean().map(DVec3::from) else { continue };
                let e = (self.axis + side) % 3;
                let noise = inner.noise_of_points() * inner.sum.count() as f64;
                let carried = if counts[at] && counts[beside] {
                    (noise + outer.noise_of_points() * outer.sum.count() as f64) * 0.5
                } else if outer.of == Of::Rim {
                    // Where it goes on with fewer points, they thin out towards the border.
                    noise * (0.5 + 0.5 * (outer.sum.count() as f64 / inner.sum.count() as f64).min(1.0))
                } else {
                    noise
                };
                let sum = -step / size * DVec3::from(carried.rows()[e]).dot(normal);
                let mut face = mean - centroid;
                // To the middle of the face, on the plane.
                let half = 0.5 * sign * size;
                face[e] += half;
                face[self.axis] -= half * normal[e] / normal[self.axis];
                pull += sum * DVec3::new(face.dot(e1), face.dot(e2), -1.0);
            }
        }
        let [tilt1, tilt2, offset] = (pull * DVec3::from(plane.gain)).to_array();
        let turned = (normal + tilt1 * e1 + tilt2 * e2).normalize();
        plane.fit.normal = turned.to_array();
        // In the plane again: the first less what stands on it, the second across both.
        let first = (e1 - e1.dot(turned) * turned).normalize();
        let second = turned.cross(first);
        let second = if second.dot(e2) < 0.0 { -second } else { second };
        plane.fit.axes = [first.to_array(), second.to_array()];
        plane.fit.centroid = (centroid + offset * normal).to_array();
    }
}

/// How far a column is from a plane, squared, in units of variances.
struct Deviation {
    /// Of its mean, in units of that of a point.
    off: f64,
    /// Of its mean, in units of that of the mean.
    mean: f64,
    /// Of its points from their mean.
    scatter: f64,
}

/// How far columns usually are from the plane, at least as far as their errors say: where surfaces are not as flat as that,
/// all deviate, and others stand out from them.
struct Usual {
    mean: f64,
    scatter: f64,
}

impl Usual {
    fn of(deviations: &[Option<Deviation>]) -> Self {
        let usual = |of: fn(&Deviation) -> f64| median(deviations.iter().flatten().map(of)).max(1.0);
        Self { mean: usual(|d| d.mean / MEDIAN), scatter: usual(|d| d.scatter) }
    }

    /// Whether a column of so many points is off by no more than so many standard errors.
    fn holds(&self, deviation: &Deviation, points: u64, errors: f64) -> bool {
        deviation.mean <= errors * errors * self.mean
            && deviation.scatter
                <= self.scatter * (1.0 + errors.max(DEVIATIONS) * (2.0 / points as f64).sqrt())
    }
}

impl Column {
    /// The mean covariance of the error of a point.
    fn noise_of_points(&self) -> SymmetricMatrix3 {
        mean_noise(&self.sum) + self.shared.of_points
    }

    fn deviation(&self, near: &Near, floor: f64) -> Option<Deviation> {
        let normal = near.normal.to_array();
        let off = near.normal.dot(DVec3::from(self.sum.mean()?) - near.centroid).powi(2);
        let scatter = self.sum.covariance()?.quadratic_form(normal).max(0.0);
        let own = variance_along(&self.sum, near.normal);
        let floor = floor * floor;
        let of_point = own + self.shared.of_points.quadratic_form(normal) + floor;
        let of_mean = own / self.sum.count() as f64 + self.shared.of_mean.quadratic_form(normal) + floor;
        (of_mean > 0.0).then(|| Deviation {
            off: off / of_point,
            mean: off / of_mean,
            scatter: scatter / of_point,
        })
    }
}

/// A place and the eight beside it.
fn around([a, b]: [i32; 2]) -> impl Iterator<Item = [i32; 2]> {
    (-1..=1).flat_map(move |x: i32| (-1..=1).map(move |y: i32| [a.saturating_add(x), b.saturating_add(y)]))
}

/// The axis that the normal is nearest to.
fn main_axis(normal: DVec3) -> usize {
    normal.abs().max_position()
}

fn mean_noise(cell: &Stats) -> SymmetricMatrix3 {
    cell.moments().noise() * (1.0 / cell.count().max(1) as f64)
}

fn variance_along(cell: &Stats, direction: DVec3) -> f64 {
    mean_noise(cell).quadratic_form(direction.to_array())
}

/// Voxels that errors may carry a point of this variance to.
fn reach(variance: f64, size: f64) -> i32 {
    let voxels = (FAR * variance.max(0.0).sqrt() / size).ceil();
    // Also where it is NaN.
    (1..REACH).find(|reach| voxels <= f64::from(*reach)).unwrap_or(REACH)
}

/// 0 of nothing.
fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}
