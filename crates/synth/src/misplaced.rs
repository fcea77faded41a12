//! Scans whose pose is told with an error.

use crate::draws::{Draws, Purpose};
use crate::factor::{apply, factor};
use crate::vector::{Vec3, add_scaled, cross, length};
use terrace_noise::PoseNoise;
use terrace_types::{Frame, Pose, PoseError, Scan};

/// The error of a told pose, along the axes of the world, in the convention of [`PoseNoise`]: what is told as
/// `R q + t` is really `exp(δω) R q + t + δt`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PoseOffset {
    /// `δt`, in metres.
    pub translation: [f64; 3],
    /// `δω`, in radians: about the sensor, by the length of the vector, right-handed.
    pub rotation: [f64; 3],
}

/// Why a scan was not misplaced.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum MisplacedError {
    /// The points are in the world already, so that there is no pose to tell.
    #[error("the scan is in the world frame and has no pose that could be told wrongly")]
    InWorld {
        /// Where the sensor stood, when known.
        sensor: Option<[f64; 3]>,
    },
    /// The told pose is out of the range of numbers.
    #[error("the misplaced pose is no pose: {0}")]
    Pose(#[from] PoseError),
}

/// The scan with the pose that is told for it when the pose has an error of this covariance: the true pose, which the
/// scan comes with, without one error drawn from it ([`PoseOffset::drawn`], [`PoseOffset::told`]). Points and their
/// errors stay as they are, to the last bit.
///
/// ```
/// use terrace_noise::PoseNoise;
/// use terrace_synth::{Params, Scene, misplaced};
///
/// let room = Scene::room().generate(&Params { points: Some(14), ..Params::default() })?;
/// let scan = &room.scans[0].scan;
/// let told = misplaced(scan, &PoseNoise::from_degrees(0.01, 0.2)?, 7, 0)?;
/// assert_eq!(told.points(), scan.points());
/// assert_ne!(told.sensor_position(), scan.sensor_position());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`MisplacedError`] when the scan is in the world frame, and when the told pose leaves the range of numbers.
pub fn misplaced(scan: &Scan, noise: &PoseNoise, seed: u64, stream: u64) -> Result<Scan, MisplacedError> {
    match scan.frame() {
        Frame::World { sensor } => Err(MisplacedError::InWorld { sensor }),
        Frame::Sensor { pose } => {
            let told = PoseOffset::drawn(noise, seed, stream).told(&pose)?;
            Ok(scan.clone().with_pose(told))
        }
    }
}

impl PoseOffset {
    /// One error drawn from a covariance of any rank; entries without variance are zero. The same seed and stream give
    /// the same bits.
    pub fn drawn(noise: &PoseNoise, seed: u64, stream: u64) -> Self {
        let deviates = Draws::new(Purpose::Poses, seed, stream).next();
        let [x, y, z, a, b, c] = apply(&factor(&noise.covariance()), deviates);
        Self { translation: [x, y, z], rotation: [a, b, c] }
    }

    /// The pose that is told where this is the error and `truth` the true pose: `exp(−δω) R`, `t − δt`. Without an error
    /// it is the true pose, to the last bit.
    ///
    /// # Errors
    /// [`PoseError`] when it leaves the range of numbers.
    pub fn told(&self, truth: &Pose) -> Result<Pose, PoseError> {
        let back = Self { translation: self.translation.map(|x| -x), rotation: self.rotation.map(|x| -x) };
        back.truth(truth)
    }

    /// The true pose where this is the error and `told` the told pose: `exp(δω) R`, `t + δt`.
    ///
    /// # Errors
    /// [`PoseError`] when it leaves the range of numbers.
    pub fn truth(&self, told: &Pose) -> Result<Pose, PoseError> {
        if *self == Self::default() {
            return Ok(*told);
        }
        let r = told.rotation();
        let columns = [0, 1, 2].map(|j| turned(self.rotation, [r[0][j], r[1][j], r[2][j]]));
        let rows = [0, 1, 2].map(|i| [columns[0][i], columns[1][i], columns[2][i]]);
        Pose::new(rows, add_scaled(told.translation(), 1.0, self.translation))
    }
}

/// `exp(ω) v`, after Rodrigues: `v + (sin θ/θ) ω × v + ((1 − cos θ)/θ²) ω × (ω × v)`.
fn turned(omega: Vec3, v: Vec3) -> Vec3 {
    let half = length(omega) / 2.0;
    // (1 − cos θ)/θ² = ½ (sin(θ/2)/(θ/2))² loses no digits at small angles.
    let [whole, halved] = [2.0 * half, half].map(|x| if x > 0.0 { x.sin() / x } else { 1.0 });
    let once = cross(omega, v);
    add_scaled(add_scaled(v, whole, once), 0.5 * halved * halved, cross(omega, once))
}
