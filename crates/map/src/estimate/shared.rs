//! Errors that all points of a scan share: those of its pose.

use glam::DVec3;
use terrace_grid::CellId;
use terrace_normals::{CovariantPlane, PlaneFit};
use terrace_regions::SharedNoise;
use terrace_stats::{Stats, SymmetricMatrix3};

use super::Errors;
use super::columns::{Column, Columns, Seen};
use super::sightings::Sighting;
use crate::mapper::View;

/// What errors of poses do to points at a place, of which each scan saw some; `points` are all. Scans are wrong independently of each other.
fn of_poses(from: &[Sighting], place: [f64; 3], points: f64, views: &[View]) -> SharedNoise {
    let mut shared = SharedNoise::NONE;
    for sighting in from {
        let Some(view) = views.get(sighting.view as usize) else { continue };
        let Some(covariance) = view.pose.zip(view.sensor).and_then(|(pose, sensor)| pose.at(sensor, place))
        else {
            continue;
        };
        let (covariance, share) =
            (SymmetricMatrix3(covariance.entries()), f64::from(sighting.points) / points);
        shared.of_mean += covariance * (share * share);
        shared.of_points += covariance * share;
    }
    shared
}

impl Seen {
    /// The points of a place, some from each scan.
    pub(crate) fn of(from: Vec<Sighting>, place: &Stats, views: &[View]) -> Self {
        let shared =
            place.mean().map_or(SharedNoise::NONE, |mean| of_poses(&from, mean, place.count() as f64, views));
        Self { from, shared }
    }
}

impl Errors<'_> {
    /// Whether any pose is only known to within an error.
    pub(crate) fn of_poses_are_told(&self) -> bool {
        self.views.iter().any(|view| view.pose.is_some())
    }

    /// What errors of poses do to points at some place in a cell, by how many of the points of the cell each scan saw.
    pub(crate) fn of_poses(&self, place: [f64; 3], cell: CellId) -> SharedNoise {
        let seen = self.seen(cell.index());
        let points = seen.iter().map(|sighting| f64::from(sighting.points)).sum();
        of_poses(seen, place, points, self.views)
    }
}

impl Columns {
    /// The covariance of tilt and offset that comes from the poses of the scans.
    ///
    /// A point p of a scan from s moves along the normal by `n·δt + δω·((p − s) × n)` with the error (δt, δω) of its pose
    /// ([`terrace_noise::jacobian`]), and pulls by `w (−u, −v, 1)` times that. The pulls of a scan add up to a 3×6 matrix g,
    /// from the sums of the columns; the covariance is `Σ A⁻¹ g Σ_pose gᵀ A⁻¹` over the scans.
    ///
    /// The error also carries all points of the scan over the faces at which the support ends, by its part across them. What
    /// that adds has the mean of the errors of points, and is taken back with them; but being the same for all points, it scatters
    /// as much as it is large: by the variance `nᵀCn aᵀCb + nᵀCa nᵀCb` of products of errors along n, a and b.
    pub(crate) fn shared_by_scans(
        &self,
        counts: &[bool],
        plane: &CovariantPlane,
        views: &[View],
        size: f64,
    ) -> SymmetricMatrix3 {
        if !views.iter().any(|view| view.pose.is_some()) {
            return SymmetricMatrix3::ZERO;
        }
        let mut pulls = vec![[[0.0; 6]; 3]; views.len()];
        for (column, _) in self.all.iter().zip(counts).filter(|(_, counts)| **counts) {
            let weight = column.weight(plane);
            for sighting in column.seen.iter().flat_map(|seen| &seen.from) {
                let place = sighting.view as usize;
                let (Some(sensor), Some(pull)) =
                    (views.get(place).and_then(|view| view.sensor), pulls.get_mut(place))
                else {
                    continue;
                };
                let of_column = pull_of(column, self.anchor.into(), &plane.fit, sensor.into());
                let points = weight * f64::from(sighting.points);
                for (row, more) in pull.iter_mut().zip(of_column) {
                    for (entry, more) in row.iter_mut().zip(more) {
                        // As if the points of the scan were spread over the column like all.
                        *entry += points * more;
                    }
                }
            }
        }
        // By scan, for displacements along each axis of the world.
        let mut carried = vec![[DVec3::ZERO; 3]; views.len()];
        for face in self.faces(counts, plane, size) {
            for sighting in face.inner.seen.iter().flat_map(|seen| &seen.from) {
                let part = f64::from(sighting.points) / face.inner.sum.count() as f64;
                if let Some(of_scan) = carried.get_mut(sighting.view as usize) {
                    of_scan[face.across] += face.pull_of(part);
                }
            }
        }
        let mut sum = SymmetricMatrix3::ZERO;
        for ((pull, carried), view) in pulls.iter().zip(&carried).zip(views) {
            let (Some(pose), Some(sensor)) = (view.pose, view.sensor) else { continue };
            let covariance = pose.covariance();
            let times = |a: &[f64; 6]| covariance.map(|row| inner(&row, a));
            let half = pull.map(|row| times(&row));
            sum += of_entries(|i, j| inner(&pull[i], &half[j]));
            let Some(at_centroid) = pose.at(sensor, plane.fit.centroid) else { continue };
            let rows = at_centroid.rows().map(DVec3::from);
            let normal = DVec3::from(plane.fit.normal);
            let with_normal = rows.map(|row| row.dot(normal));
            let along = normal.dot(DVec3::from(with_normal));
            for a in 0..3 {
                for b in 0..3 {
                    let scatter = along * rows[a][b] + with_normal[a] * with_normal[b];
                    sum += of_entries(|i, j| {
                        0.5 * scatter * (carried[a][i] * carried[b][j] + carried[a][j] * carried[b][i])
                    });
                }
            }
        }
        let gain = plane.gain;
        let sum = sum.rows();
        of_entries(|i, j| gain[i] * sum[i][j] * gain[j])
    }
}

fn of_entries(entry: impl Fn(usize, usize) -> f64) -> SymmetricMatrix3 {
    SymmetricMatrix3([(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].map(|(i, j)| entry(i, j)))
}

/// The mean pull of a point of the column by (δt, δω).
fn pull_of(column: &Column, anchor: DVec3, fit: &PlaneFit, sensor: DVec3) -> [[f64; 6]; 3] {
    let mean = anchor + column.mean();
    let scatter = column.sum.covariance().unwrap_or_default().rows().map(DVec3::from);
    let normal = DVec3::from(fit.normal);
    let turn = (mean - sensor).cross(normal);
    let arms = fit.axes.map(|axis| {
        let axis = DVec3::from(axis);
        let at = axis.dot(mean - DVec3::from(fit.centroid));
        // Within the column, points farther along the axis also turn farther.
        let spread = DVec3::from(scatter.map(|row| row.dot(axis)));
        row(normal * -at, turn * -at - spread.cross(normal))
    });
    let [first, second] = arms;
    [first, second, row(normal, turn)]
}

fn row(shift: DVec3, turn: DVec3) -> [f64; 6] {
    [shift.x, shift.y, shift.z, turn.x, turn.y, turn.z]
}

fn inner(a: &[f64; 6], b: &[f64; 6]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
