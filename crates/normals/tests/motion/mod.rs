//! Rigid motions for tests.

// Each test file uses the part it needs.
#![allow(dead_code)]

use proptest::prelude::*;

/// A rotation about the origin, then a translation.
#[derive(Debug, Clone, Copy)]
pub struct Motion {
    rows: [[f64; 3]; 3],
    offset: [f64; 3],
}

impl Motion {
    /// By a quaternion of any length but zero.
    pub fn new(quaternion: [f64; 4], offset: [f64; 3]) -> Self {
        let length = quaternion.iter().map(|q| q * q).sum::<f64>().sqrt();
        let [w, x, y, z] = quaternion.map(|q| q / length);
        let rows = [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
            [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
            [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
        ];
        Self { rows, offset }
    }

    pub fn vector(&self, v: [f64; 3]) -> [f64; 3] {
        self.rows.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
    }

    pub fn point(&self, p: [f64; 3]) -> [f64; 3] {
        let turned = self.vector(p);
        [0, 1, 2].map(|k| turned[k] + self.offset[k])
    }

    pub fn back(&self, p: [f64; 3]) -> [f64; 3] {
        let p = [0, 1, 2].map(|k| p[k] - self.offset[k]);
        [0, 1, 2].map(|k| self.rows[0][k] * p[0] + self.rows[1][k] * p[1] + self.rows[2][k] * p[2])
    }
}

/// Any rotation, and offsets up to `far` on each axis.
pub fn motion(far: f64) -> impl Strategy<Value = Motion> {
    let quaternion = prop::array::uniform4(-1.0..1.0f64);
    let usable = quaternion.prop_filter("too short", |q| q.iter().map(|x| x * x).sum::<f64>() > 0.01);
    (usable, prop::array::uniform3(-far..=far)).prop_map(|(q, offset)| Motion::new(q, offset))
}
