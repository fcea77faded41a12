//! The cells of a plane in columns along its normal.

use glam::DVec3;
use terrace_grid::VoxelKey;
use terrace_normals::{CovariantPlane, PlaneFit};
use terrace_stats::{Stats, SymmetricMatrix3};
use terrace_types::PlaneId;

use super::level::{NoiseLevel, Residuals};
use super::shared::SharedErrors;
use super::sightings::{Sighting, merged};
use super::{ExtractedPlane, Owned};

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
    range: Option<f64>,
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
    pub(crate) columns: Vec<Column>,
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
            let variance = match level {
                Some(level) => level.sigma(self.errors.range(&stats, cell.id().index())).powi(2),
                None => variance_along(&stats, near.normal),
            };
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
        let mut columns = Columns { axis, columns };
        let rim: Vec<Column> = keys
            .chunk_by(|a, b| place(a) == place(b))
            .flat_map(|keys| self.rim(plane, axis, keys, &columns))
            .collect();
        columns.columns.extend(rim);
        columns.columns.sort_by_key(|column| column.place);
        columns.columns.dedup_by_key(|column| column.place);
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
            if let Some(sightings) = &self.errors.sightings {
                seen.extend(sightings.of_cell(index));
            }
        }
        let sum = sum?;
        let seen = merged(seen);
        let range = self.errors.range_of(&sum, &seen);
        let sum = match level {
            Some(level) => {
                let variance = level.sigma(range).powi(2) * sum.count() as f64;
                sum.with_noise(SymmetricMatrix3::diagonal([variance; 3]))
            }
            None => sum,
        };
        let mut column = Column { place, sum, of, seen, range, shared: SharedErrors::NONE };
        column.shared = SharedErrors::of(&column, self.errors.views);
        Some(column)
    }
}

impl Columns {
    fn find(&self, place: [i32; 2]) -> Option<usize> {
        self.columns.binary_search_by_key(&place, |column| column.place).ok()
    }

    fn counted<'c>(&'c self, counts: &'c [bool]) -> impl Iterator<Item = &'c Column> + Clone {
        self.columns.iter().zip(counts).filter(|(_, counts)| **counts).map(|(column, _)| column)
    }

    /// The plane of least variance through the columns that count.
    pub(crate) fn fit(&self, counts: &[bool]) -> Option<CovariantPlane> {
        CovariantPlane::of_cells(self.counted(counts).map(|column| &column.sum)).ok()?
    }

    /// What flat columns off the borders of the plane tell of the noise.
    pub(crate) fn residuals(&self, near: &Near, floor: f64, residuals: &mut Residuals) {
        let counts = self.near(near, floor);
        for column in self.counted(&counts) {
            residuals.push(column.range, &column.sum, near.normal.into());
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
        self.apart(self.columns.iter().zip(&deviations).map(|(column, deviation)| {
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
            self.columns.iter().zip(&deviations).map(core).collect()
        })
    }

    /// `None` for columns that are not of the plane alone.
    fn deviations(&self, near: &Near, floor: f64) -> Vec<Option<Deviation>> {
        self.columns.iter().map(|c| c.deviation(near, floor).filter(|_| c.of == Of::Plane)).collect()
    }

    /// Those for which it holds, and for all beside them.
    fn apart(&self, holds: impl Iterator<Item = bool>) -> Vec<bool> {
        let mut counts = vec![true; self.columns.len()];
        // From the few for which it does not: the others need no look around.
        for ((at, column), _) in self.columns.iter().enumerate().zip(holds).filter(|(_, holds)| !holds) {
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
        self.columns.iter().map(|column| column.of == Of::Plane && within(column)).collect()
    }

    /// The place of a voxel.
    pub(crate) fn place(&self, key: VoxelKey) -> [i32; 2] {
        [key[(self.axis + 1) % 3], key[(self.axis + 2) % 3]]
    }

    /// Mean squared residuals in units of their variance, with their degrees of freedom: of points from the plane, and
    /// of the means of columns, which also tell of errors that neighbouring points share.
    pub(crate) fn chi_squared(&self, counts: &[bool], plane: &CovariantPlane, floor: f64) -> [(f64, f64); 2] {
        let near = Near::of(plane);
        let (mut of_points, mut of_means) = ((0.0, -3.0), (0.0, -3.0));
        for column in self.counted(counts) {
            let Some(deviation) = column.deviation(&near, floor) else { continue };
            let count = column.sum.count() as f64;
            of_points = (of_points.0 + count * (deviation.scatter + deviation.off), of_points.1 + count);
            // Errors carry points from column to column and with them the mean, which is made up for by the columns on the
            // other side; not so at a border.
            let within = beside(column.place).all(|place| self.find(place).is_some_and(|at| counts[at]));
            if within {
                of_means = (of_means.0 + deviation.mean, of_means.1 + 1.0);
            }
        }
        [of_points, of_means].map(|(sum, freedom): (f64, f64)| {
            // Three residuals tell nothing: a plane goes through three points.
            if freedom < 1.0 { (0.0, 1.0) } else { (sum / freedom, freedom) }
        })
    }

    /// Moves the plane back by what the errors carry over the borders at which the support ends and the plane does not.
    pub(crate) fn take_back_cuts(&self, counts: &[bool], plane: &mut CovariantPlane, size: f64) {
        let PlaneFit { centroid, normal, axes, .. } = plane.fit;
        let (centroid, normal, [e1, e2]) =
            (DVec3::from(centroid), DVec3::from(normal), axes.map(DVec3::from));
        let mut pull = DVec3::ZERO;
        for (beyond, _) in self.columns.iter().zip(counts).filter(|(_, counts)| !**counts) {
            for (side, of_side) in [1, 2].into_iter().zip([[1, 0], [0, 1]]) {
                for sign in [-1, 1] {
                    // From the column that counts to the one beyond is the direction `sign`.
                    let last = [0, 1].map(|i| beyond.place[i].saturating_sub(sign * of_side[i]));
                    let Some(column) = self.find(last).filter(|at| counts[*at]).map(|at| &self.columns[at])
                    else {
                        continue;
                    };
                    let Some(mean) = column.sum.mean().map(DVec3::from) else { continue };
                    let count = column.sum.count() as f64;
                    let noise = column.sum.moments().noise() + column.shared.of_points * count;
                    let e = (self.axis + side) % 3;
                    let with_normal = DVec3::from(noise.rows()[e]).dot(normal);
                    // Where it goes on with fewer points, its points thin out towards the border.
                    let thinner = beyond.sum.count() as f64 / count;
                    let density = if beyond.of == Of::Rim { 0.5 + 0.5 * thinner.min(1.0) } else { 1.0 };
                    let sum = -f64::from(sign) * density / size * with_normal * plane.weight(&column.sum);
                    let mut at = mean - centroid;
                    // To the middle of the face, on the plane.
                    let half = 0.5 * f64::from(sign) * size;
                    at[e] += half;
                    at[self.axis] -= half * normal[e] / normal[self.axis];
                    pull += sum * DVec3::new(at.dot(e1), at.dot(e2), -1.0);
                }
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
    fn deviation(&self, near: &Near, floor: f64) -> Option<Deviation> {
        let normal = near.normal.to_array();
        let off = near.normal.dot(DVec3::from(self.sum.mean()?) - near.centroid).powi(2);
        let scatter = self.sum.covariance()?.quadratic_form(normal);
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

/// The four places at the sides.
fn beside([a, b]: [i32; 2]) -> impl Iterator<Item = [i32; 2]> {
    [[-1, 0], [1, 0], [0, -1], [0, 1]]
        .into_iter()
        .map(move |[x, y]| [a.saturating_add(x), b.saturating_add(y)])
}

/// The axis that the normal is nearest to.
fn main_axis(normal: DVec3) -> usize {
    normal.abs().max_position()
}

fn variance_along(cell: &Stats, direction: DVec3) -> f64 {
    cell.moments().noise().quadratic_form(direction.to_array()) / cell.count().max(1) as f64
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
