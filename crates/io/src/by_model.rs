//! Errors of points by the noise model of their sensor.

use terrace_noise::{ScanNoise, SensorNoise};
use terrace_types::{Frame, Pose, Sigma};

use crate::ReadErrorKind;

/// The greatest variance in m² that is kept. Beyond it products of three overflow, and no covariance can be checked.
const GREATEST_VARIANCE: f64 = 1e100;

/// Points that are no farther from the sensor in metres are at it. Products of much smaller variances would underflow.
const AT_SENSOR: f64 = 1e-9;

/// The errors of points in the frame of their scan by `noise`, with how many points became absent (NaN) because the
/// model says that they cannot have been measured. `axis` is the optical axis of a camera in that frame.
pub(crate) fn errors(
    noise: SensorNoise,
    points: &mut [[f64; 3]],
    frame: Frame,
    axis: Option<[f64; 3]>,
) -> Result<(Sigma, usize), ReadErrorKind> {
    Ok(match noise {
        SensorNoise::Uniform(model) => (Sigma::Uniform(model.sigma()), 0),
        SensorNoise::PerAxis(model) => (along_world_axes(model.sigma(), points.len(), frame), 0),
        _ => Measured::of(noise, frame, axis)?.covariances(points),
    })
}

/// As [`errors`], without the errors: only makes the points absent that the model says cannot have been measured.
pub(crate) fn leave_out(
    noise: SensorNoise,
    points: &mut [[f64; 3]],
    frame: Frame,
    axis: Option<[f64; 3]>,
) -> Result<usize, ReadErrorKind> {
    if matches!(noise, SensorNoise::Uniform(_) | SensorNoise::PerAxis(_)) {
        return Ok(0);
    }
    let measured = Measured::of(noise, frame, axis)?;
    let mut not_measured = 0;
    for point in points {
        measured.take(point, &mut not_measured);
    }
    Ok(not_measured)
}

/// One σ for each axis of the world, in the frame of the points.
fn along_world_axes(sigma: [f64; 3], count: usize, frame: Frame) -> Sigma {
    match frame {
        Frame::Sensor { pose } if pose.rotation() != Pose::IDENTITY.rotation() => {
            let rotation = pose.rotation();
            // Rᵀ Σ R, for the axes of the world are the columns of Rᵀ.
            let entry = |i: usize, j: usize| {
                (0..3).map(|k| rotation[k][i] * sigma[k] * sigma[k] * rotation[k][j]).sum::<f64>()
            };
            let entries = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].map(|(i, j)| entry(i, j));
            Sigma::Covariance(vec![entries; count])
        }
        _ => Sigma::PerAxis(vec![sigma; count]),
    }
}

/// A model that tells an error for each point by where it was measured from.
struct Measured {
    scan: ScanNoise,
    sensor: [f64; 3],
}

impl Measured {
    fn of(noise: SensorNoise, frame: Frame, axis: Option<[f64; 3]>) -> Result<Self, ReadErrorKind> {
        let sensor = match frame {
            // Before the pose is applied the sensor is the origin.
            Frame::Sensor { .. } => Some([0.0; 3]),
            Frame::World { sensor } => sensor,
        };
        let sensor = sensor.ok_or(ReadErrorKind::NoSensorPosition { noise })?;
        let scan = ScanNoise::new(noise, Some(sensor))?;
        Ok(Self { scan: axis.map_or(Ok(scan), |axis| scan.with_axis(axis))?, sensor })
    }

    /// The covariance of a point; one that cannot have been measured becomes absent, and is counted if it was there.
    #[inline]
    fn take(&self, point: &mut [f64; 3], not_measured: &mut usize) -> Option<[f64; 6]> {
        let away = (0..3).any(|i| (point[i] - self.sensor[i]).abs() > AT_SENSOR);
        let covariance = if away { self.scan.covariance(*point) } else { None };
        let entries = covariance.map(|covariance| covariance.entries());
        let entries = entries.filter(|e| e[0].max(e[3]).max(e[5]) <= GREATEST_VARIANCE);
        if entries.is_none() {
            *not_measured += usize::from(point.iter().all(|x| x.is_finite()));
            *point = [f64::NAN; 3];
        }
        entries
    }

    fn covariances(&self, points: &mut [[f64; 3]]) -> (Sigma, usize) {
        let mut not_measured = 0;
        let of_point = |point: &mut [f64; 3]| self.take(point, &mut not_measured).unwrap_or([f64::NAN; 6]);
        let covariances = points.iter_mut().map(of_point).collect();
        (Sigma::Covariance(covariances), not_measured)
    }
}
