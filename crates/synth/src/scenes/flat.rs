//! Single rectangles in front of the origin, for what a plane is known by: its length, and which of its points are good.

use crate::build::Builder;
use crate::kind::SceneKind;
use crate::scene::Scene;
use crate::sensor::yaw_pitch_roll;
use crate::shape::Rectangle;

/// The middle before the turn, 1.5 m from the origin and off the normal, so that it is seen at a slant; after it the
/// middle is within 15° of +z.
const MIDDLE: [f64; 3] = [-0.4, 0.2, 1.43];

pub(crate) fn strip() -> Scene {
    let mut b = Builder::new(SceneKind::Strip);
    b.plane("strip", [rectangle(0.9, 0.3)]);
    b.finish_rotated(yaw_pitch_roll(0.6, 0.3, 0.4))
}

pub(crate) fn patch() -> Scene {
    let mut b = Builder::new(SceneKind::Patch);
    b.white_noise([0.001, 0.012]);
    b.plane("patch", [rectangle(0.6, 0.6)]);
    b.finish_rotated(yaw_pitch_roll(0.6, 0.3, 0.4))
}

/// Its normal faces the origin.
fn rectangle(first: f64, second: f64) -> Rectangle {
    let [x, y, z] = MIDDLE;
    Rectangle::new([x - second / 2.0, y - first / 2.0, z], [0.0, first, 0.0], [second, 0.0, 0.0])
}
