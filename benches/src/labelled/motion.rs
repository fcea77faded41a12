//! A scene elsewhere, and turned.

use rand::SeedableRng;
use rand::prelude::*;
use rand::rngs::ChaCha8Rng;
use terrace::{Frame, Plane, Pose, Scan, Sigma};

use crate::labelled::Labelled;
use crate::scenes::SceneError;

/// How far along each axis, in metres: as far as coordinates of maps are.
const FAR: f64 = 5e6;

/// A rigid motion of the world.
#[derive(Debug, Clone, Copy)]
pub struct Motion(Pose);

impl Motion {
    /// A random rotation, then 5000 km along each axis.
    ///
    /// # Errors
    /// When the quaternion drawn is zero, which no seed was seen to give.
    pub fn seeded(seed: u64) -> Result<Self, SceneError> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        // Within the unit ball every direction is as likely as any other.
        let quaternion = loop {
            let drawn = [(); 4].map(|()| random.random_range(-1.0..1.0_f64));
            if drawn.iter().map(|x| x * x).sum::<f64>() <= 1.0 {
                break drawn;
            }
        };
        Ok(Self(Pose::from_quaternion([FAR; 3], quaternion)?))
    }

    /// The scene after the motion. What sensors measured in their own frames stays as it is.
    ///
    /// # Errors
    /// When the motion leaves the range of numbers.
    pub fn of(&self, scene: &Labelled) -> Result<Labelled, SceneError> {
        let scans = scene.scans.iter().map(|s| self.scan(s)).collect::<Result<_, _>>()?;
        let mut planes = scene.planes.clone();
        for known in planes.values_mut() {
            known.plane = self.plane(&known.plane)?;
        }
        Ok(Labelled { scans, truth: scene.truth.clone(), planes })
    }

    fn scan(&self, scan: &Scan) -> Result<Scan, SceneError> {
        let Self(motion) = self;
        let sensor = match scan.frame() {
            Frame::Sensor { pose } => return Ok(scan.clone().with_pose(self.after(&pose)?)),
            Frame::World { sensor } => sensor.map(|s| motion.transform(s)),
        };
        let sigma = match scan.sigma() {
            Sigma::PerAxis(all) => Sigma::PerAxis(all.iter().map(|s| motion.rotate_sigma(*s)).collect()),
            Sigma::Covariance(all) => {
                Sigma::Covariance(all.iter().map(|c| motion.rotate_covariance(*c)).collect())
            }
            same => same.clone(),
        };
        let points = scan.points().iter().map(|p| motion.transform(*p)).collect();
        Ok(Scan::new(points, sigma, Frame::World { sensor })?)
    }

    /// First the pose, then the motion.
    fn after(&self, pose: &Pose) -> Result<Pose, SceneError> {
        let r = pose.rotation();
        let columns = [0, 1, 2].map(|j| self.0.rotate([r[0][j], r[1][j], r[2][j]]));
        let rows = [0, 1, 2].map(|i| [columns[0][i], columns[1][i], columns[2][i]]);
        Ok(Pose::new(rows, self.0.transform(pose.translation()))?)
    }

    fn plane(&self, plane: &Plane) -> Result<Plane, SceneError> {
        let normal = plane.normal();
        let foot = normal.map(|x| -plane.d() * x);
        Ok(Plane::through(self.0.transform(foot), self.0.rotate(normal))?)
    }
}
