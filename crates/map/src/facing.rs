//! The side a plane was seen from.

use std::collections::BTreeMap;

use terrace_types::PlaneId;

use crate::ExtractedPlane;
use crate::mapper::View;

/// How many points of each plane a view saw, of those it saw: in a large place few.
pub(crate) type Seen = BTreeMap<PlaneId, u64>;

/// Turns every plane to the side from which most of its points were seen, told by how many points of each plane each view saw. A plane
/// seen from nowhere, or from both sides alike, stays as it is; so does one that all its sensors lie in.
pub(crate) fn face_sensors(planes: &mut [ExtractedPlane], seen: &[Seen], views: &[View]) {
    let mut sides = vec![(0_u64, 0_u64); planes.len()];
    for (view, seen) in views.iter().zip(seen) {
        let Some(sensor) = view.sensor else { continue };
        for (id, points) in seen {
            let at = id.index();
            let (Some(plane), Some((in_front, behind))) = (planes.get(at), sides.get_mut(at)) else {
                continue;
            };
            let side = plane.plane.signed_distance(sensor);
            *in_front += if side > 0.0 { *points } else { 0 };
            *behind += if side < 0.0 { *points } else { 0 };
        }
    }
    for (plane, (in_front, behind)) in planes.iter_mut().zip(sides) {
        if behind > in_front {
            plane.plane = plane.plane.flipped();
            if let Some(estimate) = &mut plane.estimate {
                estimate.plane = plane.plane;
            }
        }
    }
}

/// How many points of each of so many planes each view saw.
pub(crate) fn seen_by(views: &[View], labels: &[Option<PlaneId>], planes: usize) -> Vec<Seen> {
    let mut rest = labels;
    let mut counter = Counter::new(planes);
    let seen = |view: &View| {
        let (of_view, after) = rest.split_at_checked(view.points).unwrap_or((rest, &[]));
        rest = after;
        let mut seen = Seen::new();
        counter.count(of_view, &mut seen);
        seen
    };
    views.iter().map(seen).collect()
}

/// Counts labels of a few of many planes.
#[derive(Debug, Clone)]
pub(crate) struct Counter {
    /// By plane; nothing between two counts.
    counts: Vec<u64>,
    met: Vec<PlaneId>,
}

impl Counter {
    pub(crate) fn new(planes: usize) -> Self {
        Self { counts: vec![0; planes], met: Vec::new() }
    }

    /// Adds the labels to what was seen.
    pub(crate) fn count(&mut self, labels: &[Option<PlaneId>], seen: &mut Seen) {
        for id in labels.iter().flatten() {
            if let Some(count) = self.counts.get_mut(id.index()) {
                if *count == 0 {
                    self.met.push(*id);
                }
                *count += 1;
            }
        }
        for id in self.met.drain(..) {
            let count = self.counts.get_mut(id.index()).map(std::mem::take);
            *seen.entry(id).or_default() += count.unwrap_or(0);
        }
    }
}
