//! Planes that are the same within their errors, though they do not touch.

use glam::{DMat3, DVec3};
use terrace_types::PlaneId;

use crate::{ExtractedPlane, PlaneEstimate};

/// χ² of three freedoms that one in a thousand pairs of parts of the same plane exceeds.
const UNLIKELY: f64 = 16.266;
/// The cosine of the angle between normals from which on they are compared at all.
const ALIKE: f64 = 0.9;

/// Makes one of planes that are the same within their covariances, and tells which plane each has become; `None` when there are no
/// such planes. The larger lends its number, plane and place among the others; points are counted together.
pub(crate) fn joined(planes: &mut Vec<ExtractedPlane>) -> Option<Vec<Option<PlaneId>>> {
    // Planes come in the order of their points: the first of those that are one is the largest.
    let mut first: Vec<usize> = (0..planes.len()).collect();
    for at in 0..planes.len() {
        let same = |before: &usize| first[*before] == *before && are_one(&planes[*before], &planes[at]);
        if let Some(before) = (0..at).find(same) {
            first[at] = before;
        }
    }
    if first.iter().enumerate().all(|(at, first)| at == *first) {
        return None;
    }
    for at in (0..planes.len()).filter(|at| first[*at] != *at) {
        let ExtractedPlane { points, centroid, rms, .. } = planes[at];
        add_points(&mut planes[first[at]], points, centroid, rms);
    }
    let mut order: Vec<usize> = (0..planes.len()).filter(|at| first[*at] == *at).collect();
    order.sort_by_key(|at| std::cmp::Reverse(planes[*at].points));
    let mut anew: Vec<Option<PlaneId>> = vec![None; planes.len()];
    for (index, at) in order.iter().enumerate() {
        anew[*at] = PlaneId::from_index(index);
    }
    let anew: Vec<Option<PlaneId>> = first.iter().map(|kept| anew[*kept]).collect();
    let of = |at: &usize| Some(ExtractedPlane { id: anew[*at]?, ..planes[*at].clone() });
    *planes = order.iter().filter_map(of).collect();
    Some(anew)
}

/// Counts points with this mean and root mean square distance to a plane.
pub(crate) fn add_points(plane: &mut ExtractedPlane, points: u64, centroid: [f64; 3], rms: f64) {
    let (a, b) = (plane.points as f64, points as f64);
    plane.centroid = [0, 1, 2].map(|i| (a * plane.centroid[i] + b * centroid[i]) / (a + b));
    plane.rms = ((a * plane.rms * plane.rms + b * rms * rms) / (a + b)).sqrt();
    plane.points += points;
}

/// Whether two planes are the same within their covariances. Not when one has none.
fn are_one(a: &ExtractedPlane, b: &ExtractedPlane) -> bool {
    let (Some(one), Some(other)) = (&a.estimate, &b.estimate) else { return false };
    let share = a.points as f64 / (a.points + b.points) as f64;
    let between = DVec3::from(a.centroid) * share + DVec3::from(b.centroid) * (1.0 - share);
    let normal = DVec3::from(one.plane.normal());
    // To first order tilts are those of a common frame; nearly all pairs end here.
    if DVec3::from(other.plane.normal()).dot(normal).abs() < ALIKE {
        return false;
    }
    let axes = one.axes.map(DVec3::from);
    let ((here, of_here), (there, of_there)) =
        (at(one, between, normal, axes), at(other, between, normal, axes));
    let apart = here - there;
    let chi_squared = apart.dot((of_here + of_there).inverse() * apart);
    (0.0..=UNLIKELY).contains(&chi_squared)
}

/// (tilt₁, tilt₂, height) of a plane against a frame at a place, and their covariance.
fn at(of: &PlaneEstimate, place: DVec3, normal: DVec3, axes: [DVec3; 2]) -> (DVec3, DMat3) {
    let own = DVec3::from(of.plane.normal());
    let side = if own.dot(normal) < 0.0 { -1.0 } else { 1.0 };
    let height = -side * of.plane.signed_distance(place.to_array());
    let value = DVec3::new(side * own.dot(axes[0]), side * own.dot(axes[1]), height);
    // The normal moves by t₁ e₁ + t₂ e₂, the plane at the place by offset − t₁ u − t₂ v along it.
    let own_axes = of.axes.map(DVec3::from);
    let from = place - DVec3::from(of.centroid);
    let row = |axis: DVec3| DVec3::new(side * own_axes[0].dot(axis), side * own_axes[1].dot(axis), 0.0);
    let last = DVec3::new(-own_axes[0].dot(from), -own_axes[1].dot(from), 1.0) * side;
    let turn = DMat3::from_cols(row(axes[0]), row(axes[1]), last).transpose();
    let covariance = DMat3::from_cols_array_2d(&of.tilt_offset);
    (value, turn * covariance * turn.transpose())
}
