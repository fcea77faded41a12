//! Three planes in the shape of a table, after section VI-A of the paper.

use crate::build::Builder;
use crate::kind::SceneKind;
use crate::scene::Scene;
use crate::sensor::yaw_pitch_roll;
use crate::shape::Rectangle;

pub(crate) fn table() -> Scene {
    let (width, depth, height) = (1.2, 1.0, 0.75);
    let mut b = Builder::new(SceneKind::Table);
    b.plane("top", [Rectangle::new([0.0, 0.0, height], [width, 0.0, 0.0], [0.0, depth, 0.0])]);
    b.plane("side_x", [Rectangle::new([0.0; 3], [0.0, 0.0, height], [0.0, depth, 0.0])]);
    b.plane("side_y", [Rectangle::new([0.0; 3], [width, 0.0, 0.0], [0.0, 0.0, height])]);
    // Turned by an arbitrary rotation under which every normal is far from every axis.
    b.finish_rotated(yaw_pitch_roll(0.6, 0.3, 0.4))
}
