//! The plane of least variance and its covariance, from the known errors of the points.

use terrace_grid::{VoxelGrid, VoxelKey};
use terrace_normals::{CovariantPlane, PlaneFit};
use terrace_stats::Stats;
use terrace_types::{Plane, PlaneId};

use crate::nodes::Nodes;

/// Cells further off than this many standard errors of their points are not of the plane.
const FAR: f64 = 4.0;
/// Columns whose mean or scatter is off by more of its standard errors hold something else.
const DEVIATIONS: f64 = 5.0;
/// Voxels above and below that are looked at, at most: errors larger than cells say little of a plane.
const REACH: i32 = 4;

/// The plane of least variance, and how sure it is, from the standard errors of the points.
///
/// # Accuracy
/// First order, for errors that are independent and as large along every axis as told. On made scenes with such errors the
/// squared error of tilt and offset in units of this covariance, by the degrees of freedom, has a mean near 1 as long
/// as the errors are well below the size of a cell (`tests/map/covariance.rs`); it grows where they are more than a tenth of it.
/// Errors along rays, of poses, and those of a sensor that do not average out are not covered.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaneEstimate {
    /// The plane; its normal points to the same side as that of the [extracted plane](crate::ExtractedPlane).
    pub plane: Plane,
    /// The place on it that `tilt_offset` is about, in metres.
    pub centroid: [f64; 3],
    /// Unit vectors in the plane, along which the tilts are.
    pub axes: [[f64; 3]; 2],
    /// Covariance of (tilt₁, tilt₂, offset): radians and metres. The true normal is `n + tilt₁ e₁ + tilt₂ e₂`, the true plane
    /// `offset` further along the normal at the centroid, to first order. The same for the normal turned round.
    pub tilt_offset: [[f64; 3]; 3],
    /// Covariance of the coefficients (a, b, c, d), of rank 3.
    pub coefficients: [[f64; 4]; 4],
    /// Mean squared distance of the points from the plane in units of their errors: about 1 where the errors are right and
    /// the surface is flat.
    pub reduced_chi_squared: f64,
}

impl PlaneEstimate {
    /// With the normal on the side of `normal`.
    pub(crate) fn of(found: &CovariantPlane, normal: [f64; 3]) -> Option<Self> {
        let plane = Plane::through(found.fit.centroid, found.fit.normal).ok()?;
        Some(Self {
            plane: if dot(plane.normal(), normal) < 0.0 { plane.flipped() } else { plane },
            centroid: found.fit.centroid,
            axes: found.fit.axes,
            tilt_offset: found.tilt_offset.rows(),
            coefficients: found.covariance_of_coefficients(),
            reduced_chi_squared: found.reduced_chi_squared,
        })
    }
}

/// The cells of a grid, and which plane each is of.
pub(crate) struct Owned<'g> {
    pub(crate) grid: &'g VoxelGrid,
    pub(crate) nodes: &'g Nodes,
    /// By cell.
    pub(crate) plane_of_cell: &'g [Option<PlaneId>],
}

impl Owned<'_> {
    /// The plane of least variance through the cells of `plane`, near that of a centroid and a normal; `None` when no error
    /// is known, or what is left of the cells determines none.
    ///
    /// # Algorithm
    /// 1. A plane that lies near the face of a voxel has points on both sides of it, and few on one: too few for a dense
    ///    cell. Without them it would lie off, by far more than its error. So cells are taken in columns along the main axis
    ///    of the normal, whether dense or not.
    /// 2. Columns that hold cells of other planes, or whose points lie off or scatter by more than their errors do, are left
    ///    out, and those beside them.
    /// 3. Where the plane goes on beyond the last column, errors carry points over the border: those with an error to one
    ///    side in, those to the other out. What that adds to the sums is known, `∓ d/ξ nᵀ C e` for a face across the axis e of a
    ///    column of d points, and is taken back.
    pub(crate) fn estimate(
        &self,
        plane: PlaneId,
        of: &[u32],
        near: ([f64; 3], [f64; 3]),
    ) -> Option<CovariantPlane> {
        let columns = self.columns(plane, of, near.1);
        let mut near = near;
        let mut estimate = None;
        for round in 0..3 {
            let counts = columns.support(near, round > 0);
            let counted = columns.columns.iter().zip(&counts).filter(|(_, counts)| **counts);
            let mut found = CovariantPlane::of_cells(counted.map(|(column, _)| &column.sum)).ok()??;
            columns.take_back_cuts(&counts, &mut found, self.grid.cell_size());
            near = (found.fit.centroid, found.fit.normal);
            estimate = Some(found);
        }
        estimate
    }

    /// The columns with cells of the plane, in a fixed order.
    fn columns(&self, plane: PlaneId, of: &[u32], normal: [f64; 3]) -> Columns {
        let axis = main_axis(normal);
        let mut keys: Vec<VoxelKey> = Vec::with_capacity(3 * of.len());
        for node in of {
            let Some(cell) = self.nodes.dense.cells().get(*node as usize).and_then(|id| self.grid.get(*id))
            else {
                continue;
            };
            let reach = reach(&cell.stats(), normal, self.grid.cell_size());
            for step in -reach..=reach {
                let mut key = cell.key();
                key[axis] = key[axis].saturating_add(step);
                keys.push(key);
            }
        }
        let place = |key: &VoxelKey| [key[(axis + 1) % 3], key[(axis + 2) % 3]];
        keys.sort_unstable_by_key(|key| (place(key), key[axis]));
        keys.dedup();
        let mut columns = Vec::new();
        for keys in keys.chunk_by(|a, b| place(a) == place(b)) {
            let mut alone = true;
            let mut sum: Option<Stats> = None;
            for cell in keys.iter().filter_map(|key| self.grid.find(*key)) {
                alone &= self
                    .plane_of_cell
                    .get(cell.id().index())
                    .is_none_or(|of| of.is_none_or(|of| of == plane));
                sum.get_or_insert(Stats::new(cell.centre())).merge(&cell.stats());
            }
            let (Some(sum), Some(place)) = (sum, keys.first().map(place)) else { continue };
            columns.push(Column { place, sum, alone });
        }
        Columns { axis, columns }
    }
}

/// A column of voxels along the main axis.
#[derive(Debug, Clone, Copy)]
struct Column {
    /// Its other two indices.
    place: [i32; 2],
    /// Of its cells near the plane.
    sum: Stats,
    /// Whether none of them is of another plane.
    alone: bool,
}

/// In rising order of their places.
struct Columns {
    axis: usize,
    columns: Vec<Column>,
}

impl Columns {
    fn find(&self, place: [i32; 2]) -> Option<usize> {
        self.columns.binary_search_by_key(&place, |column| column.place).ok()
    }

    /// Whether each column, and those beside it, hold nothing but the plane.
    fn support(&self, near: ([f64; 3], [f64; 3]), strict: bool) -> Vec<bool> {
        let mut counts = vec![true; self.columns.len()];
        // From the few that do not: the others need no look around.
        for column in self.columns.iter().filter(|c| !(c.alone && lies_on(&c.sum, near, strict))) {
            for beside in around(column.place).filter_map(|place| self.find(place)) {
                counts[beside] = false;
            }
        }
        counts
    }

    /// Moves the plane back by what the errors carry over the borders at which the support ends and the plane does not.
    fn take_back_cuts(&self, counts: &[bool], plane: &mut CovariantPlane, size: f64) {
        let PlaneFit { centroid, normal, axes: [e1, e2], .. } = plane.fit;
        let mut pull = [0.0; 3];
        for (beyond, _) in self.columns.iter().zip(counts).filter(|(_, counts)| !**counts) {
            for (side, of_side) in [1, 2].into_iter().zip([[1, 0], [0, 1]]) {
                for sign in [-1, 1] {
                    // From the column that counts to the one beyond is the direction `sign`.
                    let last = [0, 1].map(|i| beyond.place[i].saturating_sub(sign * of_side[i]));
                    let Some(cell) = self.find(last).filter(|at| counts[*at]).map(|at| &self.columns[at].sum)
                    else {
                        continue;
                    };
                    let noise = cell.moments().noise().rows().map(|row| dot(row, normal));
                    let along = dot(noise, normal);
                    let Some(mean) = cell.mean().filter(|_| along > 0.0) else { continue };
                    let e = (self.axis + side) % 3;
                    // In units of the errors' variance along the normal, as the columns weigh.
                    let sum = -f64::from(sign) * cell.count() as f64 / size * noise[e] / along;
                    let mut at = [0, 1, 2].map(|i| mean[i] - centroid[i]);
                    // To the middle of the face, on the plane.
                    let half = 0.5 * f64::from(sign) * size;
                    at[e] += half;
                    at[self.axis] -= half * normal[e] / normal[self.axis];
                    pull = [pull[0] + sum * dot(at, e1), pull[1] + sum * dot(at, e2), pull[2] - sum];
                }
            }
        }
        let [tilt1, tilt2, offset] = plane.tilt_offset.rows().map(|row| dot(row, pull));
        let turned = unit([0, 1, 2].map(|i| normal[i] + tilt1 * e1[i] + tilt2 * e2[i]));
        plane.fit.normal = turned;
        // In the plane again: the first less what stands on it, the second across both.
        let first = unit([0, 1, 2].map(|i| e1[i] - dot(e1, turned) * turned[i]));
        let second = cross(turned, first);
        plane.fit.axes = [first, if dot(second, e2) < 0.0 { second.map(|x| -x) } else { second }];
        plane.fit.centroid = [0, 1, 2].map(|i| centroid[i] + offset * normal[i]);
    }
}

/// A place and the eight beside it.
fn around([a, b]: [i32; 2]) -> impl Iterator<Item = [i32; 2]> {
    (-1..=1).flat_map(move |x: i32| (-1..=1).map(move |y: i32| [a.saturating_add(x), b.saturating_add(y)]))
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = dot(v, v).sqrt();
    v.map(|x| x / length)
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The axis that the normal is nearest to.
fn main_axis(normal: [f64; 3]) -> usize {
    (1..3).fold(0, |best, axis| if normal[axis].abs() > normal[best].abs() { axis } else { best })
}

fn variance_along(cell: &Stats, direction: [f64; 3]) -> f64 {
    cell.moments().noise().quadratic_form(direction) / cell.count().max(1) as f64
}

/// Voxels that errors may carry a point of this cell to.
fn reach(cell: &Stats, normal: [f64; 3], size: f64) -> i32 {
    let voxels = (FAR * variance_along(cell, normal).max(0.0).sqrt() / size).ceil();
    // Also where it is NaN.
    (1..REACH).find(|reach| voxels <= f64::from(*reach)).unwrap_or(REACH)
}

fn lies_on(cell: &Stats, (centroid, normal): ([f64; 3], [f64; 3]), strict: bool) -> bool {
    let (Some(mean), Some(scatter)) = (cell.mean(), cell.covariance()) else { return false };
    let variance = variance_along(cell, normal);
    let off: f64 = (0..3).map(|i| normal[i] * (mean[i] - centroid[i])).sum();
    let count = cell.count() as f64;
    // The mean by its own error and the scatter by that of a scatter; at first, near a plane that is not sure yet, by the
    // errors of single points.
    let (of_mean, of_scatter) = if strict {
        (DEVIATIONS * DEVIATIONS / count, 1.0 + DEVIATIONS * (2.0 / count).sqrt())
    } else {
        (FAR * FAR, FAR * FAR)
    };
    off * off <= of_mean * variance && scatter.quadratic_form(normal) <= of_scatter * variance
}
