//! One scan: points, their errors, and the frame they are in.

use crate::{Pose, Sigma, SigmaError};

/// The frame in which the points of a scan are given, and what is known of the sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Frame {
    /// The points are in the world already; where the sensor stood may be known or not.
    World {
        /// Position of the sensor in the world, in metres.
        sensor: Option<[f64; 3]>,
    },
    /// The points are in the sensor's frame, and its pose takes them to the world.
    Sensor {
        /// From sensor to world.
        pose: Pose,
    },
}

/// Points that were measured from one place, in file order.
///
/// Points with NaN coordinates hold the place of absent measurements. See the [crate page](crate) for an example.
#[derive(Debug, Clone, PartialEq)]
pub struct Scan {
    points: Vec<[f64; 3]>,
    sigma: Sigma,
    frame: Frame,
}

/// A present point of a scan, in world coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WorldPoint {
    /// Position in the world, in metres.
    pub position: [f64; 3],
    /// Standard error along each axis of the world, in metres; `None` when unknown.
    pub sigma: Option<[f64; 3]>,
    /// The whole covariance of its error along the axes of the world, `xx, xy, xz, yy, yz, zz` in m², where errors are
    /// given so ([`Sigma::Covariance`]); `None` where the errors along the axes are independent, or unknown.
    pub covariance: Option<[f64; 6]>,
}

/// Why a scan was refused.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ScanError {
    /// The standard errors do not fit the points.
    #[error(transparent)]
    Sigma(#[from] SigmaError),
    /// The position of the sensor is not finite.
    #[error("the sensor position ({}, {}, {}) is not finite", position[0], position[1], position[2])]
    SensorNotFinite {
        /// The position as given.
        position: [f64; 3],
    },
}

impl Scan {
    /// A scan of points in metres. Points that are not finite are kept as absent.
    ///
    /// # Errors
    /// [`ScanError`] when the standard errors are not as many as the points, a standard error of a present point is
    /// negative or not finite, or the sensor position is not finite.
    pub fn new(points: Vec<[f64; 3]>, sigma: Sigma, frame: Frame) -> Result<Self, ScanError> {
        sigma.check(&points)?;
        if let Frame::World { sensor: Some(position) } = frame
            && !position.iter().all(|x| x.is_finite())
        {
            return Err(ScanError::SensorNotFinite { position });
        }
        Ok(Self { points, sigma, frame })
    }

    /// The points as given, in the frame of the scan, absent ones included.
    pub fn points(&self) -> &[[f64; 3]] {
        &self.points
    }

    /// The standard errors as given.
    pub fn sigma(&self) -> &Sigma {
        &self.sigma
    }

    /// The frame of the points.
    pub fn frame(&self) -> Frame {
        self.frame
    }

    /// The points, standard errors and frame, so that their memory can be used again.
    pub fn into_parts(self) -> (Vec<[f64; 3]>, Sigma, Frame) {
        (self.points, self.sigma, self.frame)
    }

    /// Number of points, absent ones included.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Whether there is no point, not even an absent one.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// Number of present points.
    pub fn present(&self) -> usize {
        self.points.iter().map(|p| usize::from(is_present(*p))).sum()
    }

    /// Where the sensor stood in the world, when known.
    pub fn sensor_position(&self) -> Option<[f64; 3]> {
        match self.frame {
            Frame::World { sensor } => sensor,
            Frame::Sensor { pose } => Some(pose.translation()),
        }
    }

    /// The points in world coordinates, in file order; `None` for absent ones.
    pub fn world_points(&self) -> impl ExactSizeIterator<Item = Option<WorldPoint>> + '_ {
        (0..self.points.len()).map(|index| self.world_point(index))
    }

    /// Where the points are in the world, in file order, without their errors; `None` for absent ones.
    pub fn world_positions(&self) -> impl ExactSizeIterator<Item = Option<[f64; 3]>> + '_ {
        (0..self.points.len()).map(|index| self.world_position(index))
    }

    /// Where one point is in the world; `None` for an absent one and beyond the end.
    pub fn world_position(&self, index: usize) -> Option<[f64; 3]> {
        let point = self.points.get(index).copied().filter(|point| is_present(*point))?;
        Some(match self.frame {
            Frame::World { .. } => point,
            Frame::Sensor { pose } => pose.transform(point),
        })
    }

    /// One point in world coordinates; `None` for an absent one and beyond the end.
    pub fn world_point(&self, index: usize) -> Option<WorldPoint> {
        let point = *self.points.get(index)?;
        if !is_present(point) {
            return None;
        }
        let sigma = self.sigma.of(index);
        let covariance = self.sigma.covariance_of(index);
        let Frame::Sensor { pose } = self.frame else {
            return Some(WorldPoint { position: point, sigma, covariance });
        };
        let position = pose.transform(point);
        Some(match (covariance, &self.sigma) {
            (Some(covariance), _) => {
                let turned = pose.rotate_covariance(covariance);
                // Rounding may leave a variance of zero a little below it.
                let sigma = [turned[0], turned[3], turned[5]].map(|variance| variance.max(0.0).sqrt());
                WorldPoint { position, sigma: Some(sigma), covariance: Some(turned) }
            }
            (None, Sigma::PerAxis(_)) => {
                WorldPoint { position, sigma: sigma.map(|s| pose.rotate_sigma(s)), covariance }
            }
            // An error that is the same along every axis is the same in every frame, to the last bit.
            (None, _) => WorldPoint { position, sigma, covariance },
        })
    }

    /// The same points with other standard errors.
    ///
    /// # Errors
    /// [`SigmaError`] when the errors do not fit the points.
    pub fn with_sigma(self, sigma: Sigma) -> Result<Self, SigmaError> {
        sigma.check(&self.points)?;
        Ok(Self { sigma, ..self })
    }

    /// The same points, now taken as sensor coordinates under `pose`.
    #[must_use]
    pub fn with_pose(self, pose: Pose) -> Self {
        Self { frame: Frame::Sensor { pose }, ..self }
    }
}

/// Without a branch: most are.
#[inline]
#[allow(clippy::needless_bitwise_bool, reason = "without a branch")]
fn is_present([x, y, z]: [f64; 3]) -> bool {
    x.is_finite() & y.is_finite() & z.is_finite()
}
