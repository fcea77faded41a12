//! The side a plane was seen from.

use terrace_types::PlaneId;

use crate::ExtractedPlane;
use crate::mapper::View;

/// Turns every plane to the side from which most of its points were seen. A plane seen from nowhere, or from both sides
/// alike, stays as it is; so does one that all its sensors lie in.
pub(crate) fn face_sensors(planes: &mut [ExtractedPlane], labels: &[Option<PlaneId>], views: &[View]) {
    let mut in_front = vec![0_i64; planes.len()];
    let mut rest = labels;
    for view in views {
        let Some((of_view, after)) = rest.split_at_checked(view.points) else { return };
        rest = after;
        let Some(sensor) = view.sensor else { continue };
        let side_of = |plane: &ExtractedPlane| {
            let side = plane.plane.signed_distance(sensor);
            // Not `signum`, which gives zero a side.
            i64::from(side > 0.0) - i64::from(side < 0.0)
        };
        let sides: Vec<i64> = planes.iter().map(side_of).collect();
        for id in of_view.iter().flatten() {
            in_front[id.index()] += sides[id.index()];
        }
    }
    for (plane, votes) in planes.iter_mut().zip(in_front) {
        if votes < 0 {
            plane.plane = plane.plane.flipped();
            if let Some(estimate) = &mut plane.estimate {
                estimate.plane = plane.plane;
            }
        }
    }
}
