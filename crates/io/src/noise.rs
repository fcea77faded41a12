//! Noise models: the standard error of a point from its distance.

use terrace_types::Sigma;

/// How the standard error of a point follows from its distance to the sensor.
///
/// [`Kinect`](Self::Kinect) is the axial noise of the first Kinect: `σ(z) = 0.0012 + 0.0019 (z − 0.4)²` metres, `z` in
/// metres.
///
/// *Based on*: Nguyen, Izadi, Lovell, "Modeling Kinect Sensor Noise for Improved 3D Reconstruction and Tracking", 3DIMPVT
/// 2012, fitted for surfaces seen at 10° to 60° from the front. *Validity*: about 0.4 to 5 m; the formula is used
/// beyond as it stands. It is the error along the ray; it is taken for all three axes, as the paper on which terrace
/// rests takes the largest of three.
///
/// ```
/// use terrace_io::NoiseModel;
///
/// assert_eq!(NoiseModel::Kinect.sigma(0.4), 0.0012);
/// assert!((NoiseModel::Kinect.sigma(2.4) - 0.0088).abs() < 1e-15);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NoiseModel {
    /// The same standard error everywhere, in metres.
    Uniform(f64),
    /// The first Kinect and cameras like it.
    Kinect,
}

impl NoiseModel {
    /// The standard error in metres at distance `z` in metres.
    pub fn sigma(self, z: f64) -> f64 {
        match self {
            Self::Uniform(sigma) => sigma,
            Self::Kinect => 0.0012 + 0.0019 * (z - 0.4) * (z - 0.4),
        }
    }

    /// Whether the error depends on the distance, so that the place of the sensor must be known.
    pub fn needs_distance(self) -> bool {
        self == Self::Kinect
    }

    /// The errors of points in a depth camera's frame, whose distance is their z.
    pub fn of_depth(self, points: &[[f64; 3]]) -> Sigma {
        self.of(points, |p| p[2])
    }

    /// The errors of points measured from `sensor` (in the frame of the points), whose distance is the straight one.
    pub fn of_ranges(self, points: &[[f64; 3]], sensor: [f64; 3]) -> Sigma {
        self.of(points, |p| (0..3).map(|i| (p[i] - sensor[i]).powi(2)).sum::<f64>().sqrt())
    }

    fn of(self, points: &[[f64; 3]], distance: impl Fn([f64; 3]) -> f64) -> Sigma {
        match self {
            Self::Uniform(sigma) => Sigma::Uniform(sigma),
            Self::Kinect => Sigma::PerPoint(points.iter().map(|p| self.sigma(distance(*p))).collect()),
        }
    }
}
