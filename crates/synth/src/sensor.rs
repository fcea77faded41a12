//! Where a sensor stands, which rays it sends, and how well it measures.

use crate::vector::{Vec3, cross, sub, unit};
use rand::{Rng, RngExt};
use terrace_types::{PlaneId, Pose};

/// Half the field of view of a 640×480 depth camera of focal length 525, as tangents along x and y.
const CAMERA_TANGENTS: [f64; 2] = [319.5 / 525.0, 239.5 / 525.0];

/// Rings of the lidar, and its highest elevation in radians; the lowest is as far below the horizon.
const LIDAR_RINGS: usize = 64;
const LIDAR_ELEVATION: f64 = std::f64::consts::FRAC_PI_4;

/// What sends the rays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Sensor {
    /// A depth camera: x right, y down, z forward.
    Camera,
    /// A spinning lidar: x forward, y left, z up.
    Lidar,
}

/// A sensor at a place of a room, of which a building has one or many.
#[derive(Debug, Clone)]
pub(crate) struct View {
    pub(crate) sensor: Sensor,
    /// From the sensor to its room, where rays are cast.
    pub(crate) in_room: Pose,
    /// Where the room is in the building.
    pub(crate) room: Vec3,
    /// How many planes of the building come before those of the room.
    pub(crate) planes_before: usize,
    /// From the sensor to the world, the building having been moved.
    pub(crate) in_world: Pose,
}

impl View {
    /// The identity in the building of a plane of the room.
    pub(crate) fn plane_in_building(&self, of_room: PlaneId) -> Option<PlaneId> {
        PlaneId::from_index(self.planes_before + of_room.index())
    }
}

impl Sensor {
    /// Standard error along a ray, in metres, for a surface `range` away along `direction`.
    ///
    /// The camera's is the Kinect model of Nguyen, Izadi and Lovell (3DIMPVT 2012), 0.0012 + 0.0019 (z − 0.4)² with
    /// z the depth along the optical axis; the lidar's is 2 cm everywhere.
    pub(crate) fn sigma(self, direction: Vec3, range: f64) -> f64 {
        match self {
            Self::Camera => 0.0012 + 0.0019 * (range * direction[2] - 0.4).powi(2),
            Self::Lidar => 0.02,
        }
    }

    /// The direction of ray `k` of `n` in the sensor's frame, in the order in which the real sensor delivers them:
    /// the camera row by row, the lidar column by column. The field of view is cut into `n` parts of equal solid
    /// angle or image area, to rounding, and the ray is drawn at random within its part.
    pub(crate) fn direction<R: Rng>(self, k: usize, n: usize, rng: &mut R) -> Vec3 {
        match self {
            Self::Camera => {
                let [u, v] = camera_part(k, n, [rng.random(), rng.random()]);
                unit([(2.0 * u - 1.0) * CAMERA_TANGENTS[0], (2.0 * v - 1.0) * CAMERA_TANGENTS[1], 1.0])
            }
            Self::Lidar => {
                // Few rays take fewer rings, so that the scan stays denser along the rings than across.
                let rings = (n / 8).isqrt().clamp(1, LIDAR_RINGS);
                let columns = n.div_ceil(rings);
                let azimuth =
                    ((k / rings) as f64 + rng.random::<f64>()) / columns as f64 * std::f64::consts::TAU;
                let ring = ((k % rings) as f64 + 0.5) / rings as f64;
                let (sin, cos) = ((2.0 * ring - 1.0) * LIDAR_ELEVATION).sin_cos();
                [cos * azimuth.cos(), cos * azimuth.sin(), sin]
            }
        }
    }
}

/// The place in the image, as shares of width and height, of ray `k` of `n` at `jitter` within its part.
///
/// The image has about ¾ as many rows as columns, and row r holds the rays from ⌈r n / rows⌉ on.
fn camera_part(k: usize, n: usize, jitter: [f64; 2]) -> [f64; 2] {
    let (k, n) = (k as u64, n as u64);
    let rows = (n * 3 / 4).isqrt().max(1);
    let row = k * rows / n;
    let start = (row * n).div_ceil(rows);
    let end = ((row + 1) * n).div_ceil(rows);
    [((k - start) as f64 + jitter[0]) / (end - start) as f64, (row as f64 + jitter[1]) / rows as f64]
}

/// The rows of the rotation from a camera that looks along `forward` with the world's z up in its image.
pub(crate) fn look_along(forward: Vec3) -> [Vec3; 3] {
    let z = unit(forward);
    let x = unit(cross(z, [0.0, 0.0, 1.0]));
    let y = cross(z, x);
    [0, 1, 2].map(|i| [x[i], y[i], z[i]])
}

/// The rotation of a camera at `position` that looks at `target`.
pub(crate) fn look_at(position: Vec3, target: Vec3) -> [Vec3; 3] {
    look_along(sub(target, position))
}

/// The rows of the rotation by `roll` about x, then `pitch` about y, then `yaw` about z, in radians.
pub(crate) fn yaw_pitch_roll(yaw: f64, pitch: f64, roll: f64) -> [Vec3; 3] {
    let ((sy, cy), (sp, cp), (sr, cr)) = (yaw.sin_cos(), pitch.sin_cos(), roll.sin_cos());
    [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_parts_of_the_image_follow_each_other_and_fill_it() {
        for n in [1, 2, 3, 7, 100, 1_001] {
            let mut area = 0.0;
            let mut last_v = 0.0;
            for k in 0..n {
                let [low, high] = [camera_part(k, n, [0.0; 2]), camera_part(k, n, [1.0; 2])];
                assert!(low[0] >= 0.0 && high[0] <= 1.0 && low[1] >= last_v && high[1] <= 1.0, "{k} of {n}");
                last_v = low[1];
                area += (high[0] - low[0]) * (high[1] - low[1]);
            }
            assert!((area - 1.0).abs() < 1e-9, "{n} parts cover {area}");
        }
    }

    #[test]
    fn the_kinect_model_has_its_known_values() {
        let ahead = [0.0, 0.0, 1.0];
        assert!((Sensor::Camera.sigma(ahead, 0.4) - 0.0012).abs() < 1e-15);
        assert!((Sensor::Camera.sigma(ahead, 3.4) - 0.0183).abs() < 1e-15);
    }
}
