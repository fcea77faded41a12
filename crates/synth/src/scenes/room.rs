//! A furnished room seen by a depth camera.

use crate::build::Builder;
use crate::kind::SceneKind;
use crate::scene::Scene;
use crate::sensor::{Sensor, look_at};
use crate::shape::Rectangle;
use crate::vector::Vec3;

pub(super) const LENGTH: f64 = 5.0;
pub(super) const WIDTH: f64 = 4.0;
pub(super) const HEIGHT: f64 = 2.6;

const X: Vec3 = [1.0, 0.0, 0.0];
const Y: Vec3 = [0.0, 1.0, 0.0];
const Z: Vec3 = [0.0, 0.0, 1.0];

/// Where the camera stood and where it looked.
const VIEWS: [(Vec3, Vec3); 14] = [
    ([0.6, 0.6, 1.5], [3.6, 2.9, 0.8]),
    ([4.3, 0.6, 1.4], [1.4, 2.6, 0.7]),
    ([4.4, 3.6, 1.5], [1.6, 0.9, 0.8]),
    ([0.5, 2.3, 1.7], [4.6, 1.6, 0.8]),
    ([2.6, 2.4, 1.5], [3.9, 0.0, 1.1]),
    ([2.3, 2.4, 1.5], [5.0, 1.4, 1.0]),
    ([2.5, 1.2, 1.5], [1.9, 4.0, 1.1]),
    ([3.1, 2.3, 1.4], [0.0, 2.4, 1.0]),
    ([2.5, 2.2, 0.9], [4.2, 3.6, 2.6]),
    ([2.5, 2.3, 0.9], [0.9, 0.8, 2.6]),
    ([2.4, 3.0, 1.6], [0.5, 3.2, 0.3]),
    ([2.4, 2.8, 1.6], [1.5, 1.0, 0.2]),
    ([3.7, 1.9, 1.6], [3.2, 3.5, 0.4]),
    ([1.3, 3.1, 1.5], [4.4, 0.4, 1.0]),
];

pub(crate) fn room() -> Scene {
    let mut b = Builder::new(SceneKind::Room);
    furnish(&mut b);
    b.finish()
}

/// Everything in the room, and where it is seen from.
pub(super) fn furnish(b: &mut Builder) {
    let scaled = |edge: Vec3, s: f64| edge.map(|e| e * s);
    b.plane("floor", [Rectangle::new([0.0; 3], scaled(X, LENGTH), scaled(Y, WIDTH))]);
    b.plane("ceiling", [Rectangle::new([0.0, 0.0, HEIGHT], scaled(Y, WIDTH), scaled(X, LENGTH))]);
    b.plane("wall_x0", [Rectangle::new([0.0; 3], scaled(Y, WIDTH), scaled(Z, HEIGHT))]);
    b.plane("wall_x5", [Rectangle::new([LENGTH, 0.0, 0.0], scaled(Z, HEIGHT), scaled(Y, WIDTH))]);
    let wall_y0 = Rectangle::new([0.0; 3], scaled(Z, HEIGHT), scaled(X, LENGTH));
    b.plane("wall_y0", [wall_y0.with_hole([-1.0, 2.0], [3.3, 4.2])]);
    b.plane("wall_y4", [Rectangle::new([0.0, WIDTH, 0.0], scaled(X, LENGTH), scaled(Z, HEIGHT))]);
    door(b);

    for (name, min, size) in
        [("table_1", [1.2, 1.4, 0.74], [1.2, 0.8]), ("table_2", [2.9, 2.8, 0.68], [1.5, 0.75])]
    {
        b.plane(name, [Rectangle::new(min, scaled(X, size[0]), scaled(Y, size[1]))]);
        for (x, y) in
            [(0.05, 0.05), (size[0] - 0.05, 0.05), (0.05, size[1] - 0.05), (size[0] - 0.05, size[1] - 0.05)]
        {
            let foot = [min[0] + x, min[1] + y, 0.0];
            b.cylinder(foot, [foot[0], foot[1], min[2]], 0.03);
        }
    }

    // A sideboard in the corner; its other faces are at the walls and on the floor.
    let [front, _, _, side, _, top] = Rectangle::faces_of_box([4.5, 0.0, 0.0], [LENGTH, 1.3, 0.95]);
    b.plane("sideboard_front", [front]);
    b.plane("sideboard_side", [side]);
    b.plane("sideboard_top", [top]);

    // A board that leans at the wall x = 0.
    b.plane("board", [Rectangle::new([0.75, 2.5, 0.0], Y, [-0.7, 0.0, 0.75])]);

    b.sphere([2.2, 3.4, 0.32], 0.32);
    b.cylinder([3.0, 0.8, 0.0], [3.0, 0.8, HEIGHT], 0.17);

    for (position, target) in VIEWS {
        b.view(Sensor::Camera, look_at(position, target), position);
    }
}

/// A door 6 cm behind the wall y = 0, with its reveals and sill.
fn door(b: &mut Builder) {
    let (left, width, height, depth) = (3.3, 0.9, 2.0, 0.06);
    let corner = [left, -depth, 0.0];
    b.plane("door", [Rectangle::new(corner, [0.0, 0.0, height], [width, 0.0, 0.0])]);
    let inward = [0.0, depth, 0.0];
    b.trim(Rectangle::new(corner, inward, [0.0, 0.0, height]));
    b.trim(Rectangle::new([left + width, -depth, 0.0], inward, [0.0, 0.0, height]));
    b.trim(Rectangle::new([left, -depth, height], inward, [width, 0.0, 0.0]));
    b.trim(Rectangle::new(corner, inward, [width, 0.0, 0.0]));
}
