//! Scans whose errors are what a model of the sensor says.

use crate::factor::rows;
use crate::vector::dot;
use terrace_noise::{ScanNoise, ScanNoiseError, SensorNoise};
use terrace_types::{Frame, Pose, Scan, Sigma, SigmaError};

/// Why errors were not stated.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StatedError {
    /// The model does not fit the scan.
    #[error(transparent)]
    Noise(#[from] ScanNoiseError),
    /// The model has no covariance for a present point: it is at the sensor, or behind the camera.
    #[error(
        "the noise model {noise} has no covariance for point {point} at ({}, {}, {})",
        position[0], position[1], position[2]
    )]
    NoCovariance {
        /// The model.
        noise: SensorNoise,
        /// Index of the point.
        point: usize,
        /// The point as given, in the frame of the scan.
        position: [f64; 3],
    },
    /// A covariance is not positive semidefinite beyond rounding.
    #[error(transparent)]
    Sigma(#[from] SigmaError),
}

/// The same scan with the errors that a model of its sensor has at its points, as covariances along the axes of the scan's
/// frame ([`Sigma::Covariance`]). Absent points get one of zeros.
///
/// In the frame of a sensor the sensor is at the origin; in the world it is where the frame says. `axis` is the optical
/// axis of a camera in the frame of the scan, of any length, from the camera into the scene; `None` for a lidar
/// ([`Scene::optical_axis`](crate::Scene::optical_axis)). Surfaces count as seen straight on, which is what an estimator
/// knows before it has found them. [`SensorNoise::PerAxis`] is along the axes of the world and is turned.
///
/// ```
/// use terrace_synth::{Params, Scene, perturbed, stated};
///
/// let (room, kinect) = (Scene::room(), "kinect".parse()?);
/// let exact = room.generate(&Params { points: Some(14_000), sigma: Some(0.0), ..Params::default() })?;
/// let axis = room.optical_axis();
/// for (stream, view) in (0..).zip(&exact.scans) {
///     // Noise of the model at the true points, and what the model then says of the measured ones.
///     let noisy = perturbed(&stated(&view.scan, &kinect, axis)?, 7, stream);
///     let told = stated(&noisy, &kinect, axis)?;
///     assert_eq!(told.points(), noisy.points());
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`StatedError`] when the model needs the place of the sensor and it is not known, the axis has no direction, or the
/// model has no covariance for a present point.
pub fn stated(scan: &Scan, noise: &SensorNoise, axis: Option<[f64; 3]>) -> Result<Scan, StatedError> {
    let (sensor, pose) = match scan.frame() {
        Frame::World { sensor } => (sensor, None),
        Frame::Sensor { pose } => (Some([0.0; 3]), Some(pose)),
    };
    let mut model = ScanNoise::new(*noise, sensor)?;
    if let Some(axis) = axis {
        model = model.with_axis(axis)?;
    }
    let of_point = |(point, position): (usize, &[f64; 3])| {
        if !position.iter().all(|x| x.is_finite()) {
            return Ok([0.0; 6]);
        }
        let entries = model.covariance(*position).map(|covariance| covariance.entries());
        let entries =
            entries.ok_or(StatedError::NoCovariance { noise: *noise, point, position: *position })?;
        Ok(match (noise, pose) {
            (SensorNoise::PerAxis(_), Some(pose)) => into_sensor(&pose, entries),
            _ => entries,
        })
    };
    let covariances: Result<Vec<_>, StatedError> = scan.points().iter().enumerate().map(of_point).collect();
    Ok(scan.clone().with_sigma(Sigma::Covariance(covariances?))?)
}

/// A covariance along the axes of the world turned into that along the axes of the sensor, `Rᵀ C R`.
fn into_sensor(pose: &Pose, covariance: [f64; 6]) -> [f64; 6] {
    let (r, covariance) = (pose.rotation(), rows(covariance));
    let axes = [0, 1, 2].map(|j| [r[0][j], r[1][j], r[2][j]]);
    let half = axes.map(|axis| covariance.map(|row| dot(row, axis)));
    [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].map(|(i, j)| dot(axes[i], half[j]))
}
