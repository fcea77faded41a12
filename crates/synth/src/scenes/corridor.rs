//! A corridor with a bend, scanned by a lidar that moves along it.

use crate::build::Builder;
use crate::kind::SceneKind;
use crate::scene::Scene;
use crate::sensor::{Sensor, yaw_pitch_roll};
use crate::shape::Rectangle;
use crate::vector::{Vec3, add_scaled, cross};
use std::f64::consts::FRAC_PI_2;

/// The first leg runs along x, the second along y from the far end of the first.
const FIRST: f64 = 16.0;
const SECOND: f64 = 12.5;
const WIDTH: f64 = 2.5;
const HEIGHT: f64 = 2.8;
const INNER: f64 = FIRST - WIDTH;

const DOOR: [f64; 2] = [0.95, 2.05];

/// An upright wall from one corner to another, with doors.
struct Wall {
    name: &'static str,
    /// Its lower corners; seen from inside the corridor, from right to left.
    from: Vec3,
    to: Vec3,
    /// Name, distance of the nearer edge from the first corner, and depth of the niche.
    doors: &'static [(&'static str, f64, f64)],
}

const WALLS: [Wall; 6] = [
    Wall { name: "wall_x0", from: [0.0, WIDTH, 0.0], to: [0.0, 0.0, 0.0], doors: &[] },
    Wall {
        name: "wall_y0",
        from: [0.0, 0.0, 0.0],
        to: [FIRST, 0.0, 0.0],
        doors: &[("door_1", 2.0, 0.08), ("door_2", 6.2, 0.12), ("door_3", 10.4, 0.2)],
    },
    Wall {
        name: "wall_x16",
        from: [FIRST, 0.0, 0.0],
        to: [FIRST, SECOND, 0.0],
        doors: &[("door_4", 4.5, 0.1), ("door_5", 8.5, 0.16)],
    },
    Wall { name: "wall_y12", from: [FIRST, SECOND, 0.0], to: [INNER, SECOND, 0.0], doors: &[] },
    Wall {
        name: "wall_x13",
        from: [INNER, SECOND, 0.0],
        to: [INNER, WIDTH, 0.0],
        doors: &[("door_6", 3.5, 0.14)],
    },
    Wall {
        name: "wall_y2",
        from: [INNER, WIDTH, 0.0],
        to: [0.0, WIDTH, 0.0],
        doors: &[("door_7", 3.6, 0.1), ("door_8", 8.8, 0.18)],
    },
];

pub(crate) fn corridor() -> Scene {
    let mut b = Builder::new(SceneKind::Corridor);
    // Both legs of the L in one plane.
    let legs = [([0.0, 0.0], [FIRST, WIDTH]), ([INNER, WIDTH], [WIDTH, SECOND - WIDTH])];
    let level = |z: f64| legs.map(|([x, y], [dx, dy])| ([x, y, z], [dx, 0.0, 0.0], [0.0, dy, 0.0]));
    b.plane("floor", level(0.0).map(|(corner, x, y)| Rectangle::new(corner, x, y)));
    b.plane("ceiling", level(HEIGHT).map(|(corner, x, y)| Rectangle::new(corner, y, x)));
    for wall in &WALLS {
        build_wall(&mut b, wall);
    }
    // Pipes under the ceiling, from wall to wall.
    b.cylinder([0.0, 0.25, 2.55], [FIRST, 0.25, 2.55], 0.09);
    b.cylinder([15.7, 0.0, 2.3], [15.7, SECOND, 2.3], 0.07);
    b.cylinder([15.75, 0.8, 0.0], [15.75, 0.8, 1.1], 0.16);

    for (k, (position, heading)) in stations().enumerate() {
        // A vehicle sways; the angles are arbitrary but fixed.
        let sway = |rate: f64| 0.04 * (rate * k as f64).sin();
        b.view(Sensor::Lidar, yaw_pitch_roll(heading + sway(1.3), sway(2.1), sway(0.7)), position);
    }
    b.finish()
}

/// Places along the middle, 1.5 m apart, with the heading there.
fn stations() -> impl Iterator<Item = (Vec3, f64)> {
    let middle = WIDTH / 2.0;
    let first =
        (0..10).map(move |k| ([0.8 + 1.5 * f64::from(k), middle + 0.05 * f64::from(k % 3), 1.2], 0.0));
    let second = (0..7)
        .map(move |k| ([FIRST - middle - 0.05 * f64::from(k % 2), 2.5 + 1.5 * f64::from(k), 1.2], FRAC_PI_2));
    first.chain(second)
}

fn build_wall(b: &mut Builder, wall: &Wall) {
    let edge = [0, 1, 2].map(|i| wall.to[i] - wall.from[i]);
    let length = (edge[0] * edge[0] + edge[1] * edge[1]).sqrt();
    let along = edge.map(|e| e / length);
    let up = [0.0, 0.0, 1.0];
    let out_of_corridor = cross(along, up);
    let [width, height] = DOOR;

    let mut face = Rectangle::new(wall.from, [0.0, 0.0, HEIGHT], edge);
    for (_, start, _) in wall.doors {
        face = face.with_hole([-1.0, height], [*start, start + width]);
    }
    b.plane(wall.name, [face]);
    for (name, start, depth) in wall.doors {
        let near = add_scaled(wall.from, *start, along);
        let back = add_scaled(near, *depth, out_of_corridor);
        let (tall, wide) = ([0.0, 0.0, height], along.map(|a| a * width));
        b.plane(name, [Rectangle::new(back, tall, wide)]);
        let deep = out_of_corridor.map(|x| x * depth);
        b.trim(Rectangle::new(near, deep, tall));
        b.trim(Rectangle::new(add_scaled(near, width, along), deep, tall));
        b.trim(Rectangle::new(add_scaled(near, height, up), deep, wide));
        b.trim(Rectangle::new(near, deep, wide));
    }
}
