//! The side a plane was seen from.

use terrace_types::PlaneId;

use crate::ExtractedPlane;
use crate::mapper::View;

/// Turns every plane to the side from which most of its points were seen, told by how many points of each plane each view saw. A plane
/// seen from nowhere, or from both sides alike, stays as it is; so does one that all its sensors lie in.
pub(crate) fn face_sensors(planes: &mut [ExtractedPlane], seen: &[Vec<u64>], views: &[View]) {
    for (at, plane) in planes.iter_mut().enumerate() {
        let (mut in_front, mut behind) = (0, 0);
        for (view, seen) in views.iter().zip(seen) {
            let (Some(sensor), Some(points)) = (view.sensor, seen.get(at)) else { continue };
            let side = plane.plane.signed_distance(sensor);
            in_front += if side > 0.0 { *points } else { 0 };
            behind += if side < 0.0 { *points } else { 0 };
        }
        if behind > in_front {
            plane.plane = plane.plane.flipped();
            if let Some(estimate) = &mut plane.estimate {
                estimate.plane = plane.plane;
            }
        }
    }
}

/// How many points of each of so many planes each view saw.
pub(crate) fn seen_by(views: &[View], labels: &[Option<PlaneId>], planes: usize) -> Vec<Vec<u64>> {
    let mut rest = labels;
    let seen = |view: &View| {
        let (of_view, after) = rest.split_at_checked(view.points).unwrap_or((rest, &[]));
        rest = after;
        let mut seen = vec![0; planes];
        for id in of_view.iter().flatten() {
            if let Some(seen) = seen.get_mut(id.index()) {
                *seen += 1;
            }
        }
        seen
    };
    views.iter().map(seen).collect()
}
