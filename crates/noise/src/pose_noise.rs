//! The error that a wrong pose gives to all points of a scan.

use crate::Covariance;
use crate::parameter::{ParameterError, deviation};
use crate::semidefinite::checked;
use crate::vector::{cross, difference, dot};

/// How far the entries of `R Rᵀ` may be from those of the identity.
const MAX_ROTATION_DEVIATION: f64 = 1e-3;

/// The covariance of a sensor's pose: three entries of translation, then three of rotation.
///
/// **Convention.** With the sensor at `s`, a point measured at `p` is really at `p + δt + δω × (p − s)`, to first
/// order: the translation `δt` in metres and the rotation vector `δω` in radians are along the axes of the *world*,
/// and the rotation is about the *sensor*. This is a perturbation of `world = R q + t` to `exp(δω) R q + t + δt`. A
/// covariance for a perturbation along the axes of the sensor, `R exp(δω′) q + t + R δt′`, is turned by
/// [`from_sensor_frame`](Self::from_sensor_frame).
///
/// *Source*: first-order propagation; the cross product is exact to 1 − cos|δω|, half a per mille at 0.03 rad.
/// *Validity*: rotations of up to about 0.1 rad.
///
/// All points of a scan share one wrong pose, so these errors do not average out: propagate them once per scan, with
/// [`jacobian`], and do not add them to the independent errors of each point.
///
/// ```
/// use terrace_noise::PoseNoise;
///
/// let pose = PoseNoise::from_radians(0.01, 0.001)?;
/// let covariance = pose.at([0.0; 3], [20.0, 0.0, 0.0]).unwrap();
/// // Along the ray the translation alone counts, across it the rotation too: 20 m times 1 mrad.
/// assert!((covariance.deviations()[0] - 0.01).abs() < 1e-15);
/// assert!((covariance.deviations()[1] - 0.01_f64.hypot(0.02)).abs() < 1e-15);
/// # Ok::<(), terrace_noise::ParameterError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseNoise {
    covariance: [[f64; 6]; 6],
}

/// Why a covariance of a pose was refused.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum PoseNoiseError {
    /// An entry is NaN or infinite.
    #[error("the entry in row {row}, column {column} of the pose covariance is {value}, which is not finite")]
    NotFinite {
        /// Row, from 0.
        row: usize,
        /// Column, from 0.
        column: usize,
        /// The entry.
        value: f64,
    },
    /// An entry of the diagonal is negative.
    #[error("the variance {index} of the pose covariance is {value}, which is negative")]
    NegativeVariance {
        /// Its place on the diagonal, from 0.
        index: usize,
        /// The variance.
        value: f64,
    },
    /// Two entries that mirror each other differ.
    #[error(
        "the pose covariance is not symmetric: {lower} in row {row}, column {column}, and {upper} opposite"
    )]
    NotSymmetric {
        /// Row of the entry below the diagonal, from 0.
        row: usize,
        /// Its column, from 0.
        column: usize,
        /// The entry below the diagonal.
        lower: f64,
        /// The entry above.
        upper: f64,
    },
    /// Some combination of errors would have a negative variance.
    #[error("the pose covariance is not positive semidefinite: it misses that by {defect} of its variances")]
    NotSemidefinite {
        /// By how much, as a share of the variances.
        defect: f64,
    },
    /// A matrix is no rotation: its rows are not unit and perpendicular, or it mirrors.
    #[error(
        "the 3x3 matrix is not a rotation: R R^T is {deviation} away from the identity, its determinant is {determinant}"
    )]
    NotARotation {
        /// Largest entry of `R Rᵀ − I`.
        deviation: f64,
        /// Its determinant.
        determinant: f64,
    },
}

/// How a point moves with the pose of its sensor: metres per metre, then metres per radian.
///
/// Row by row `[I | −[p − s]×]`, in the order and convention of [`PoseNoise`]. For a quantity with the gradient `g`
/// over the points of a scan, `Σ Jᵀ g` is its gradient over the pose. `None` when a place or their difference is not
/// finite.
pub fn jacobian(sensor: [f64; 3], point: [f64; 3]) -> Option<[[f64; 6]; 3]> {
    let [x, y, z] = difference(point, sensor);
    [x, y, z].iter().all(|entry| entry.is_finite()).then_some([
        [1.0, 0.0, 0.0, 0.0, z, -y],
        [0.0, 1.0, 0.0, -z, 0.0, x],
        [0.0, 0.0, 1.0, y, -x, 0.0],
    ])
}

impl PoseNoise {
    /// From one standard deviation of the translation along each axis, in metres, and one of the rotation about each
    /// axis, in radians; uncorrelated.
    ///
    /// # Errors
    /// [`ParameterError`] when one is negative or not finite.
    pub fn from_radians(translation: f64, rotation: f64) -> Result<Self, ParameterError> {
        Ok(Self::of_deviations(deviation("translation", translation)?, deviation("rotation", rotation)?))
    }

    /// As [`from_radians`](Self::from_radians), of what was checked.
    pub(crate) fn of_deviations(t: f64, r: f64) -> Self {
        let variances = [t, t, t, r, r, r].map(|sigma| sigma * sigma);
        let mut covariance = [[0.0; 6]; 6];
        for (i, variance) in variances.into_iter().enumerate() {
            covariance[i][i] = variance;
        }
        Self { covariance }
    }

    /// As [`from_radians`](Self::from_radians), with the rotation in degrees.
    ///
    /// # Errors
    /// [`ParameterError`] when one is negative or not finite.
    pub fn from_degrees(translation: f64, rotation: f64) -> Result<Self, ParameterError> {
        // Checked first, so that an error names the degrees.
        Self::from_radians(translation, deviation("rotation", rotation)?.to_radians())
    }

    /// From a covariance in the order and convention of the [type](Self): m² above left, rad² below right.
    ///
    /// # Errors
    /// [`PoseNoiseError`] when it is not finite, not symmetric or not positive semidefinite; 10⁻⁶ of the variances
    /// concerned is let pass.
    pub fn from_covariance(covariance: [[f64; 6]; 6]) -> Result<Self, PoseNoiseError> {
        Ok(Self { covariance: checked(&covariance)? })
    }

    /// From a covariance along the axes of the sensor, and the rotation of its pose (rows; sensor to world).
    ///
    /// # Errors
    /// [`PoseNoiseError`] as for [`from_covariance`](Self::from_covariance), and when the matrix does not rotate.
    pub fn from_sensor_frame(
        covariance: [[f64; 6]; 6],
        rotation: [[f64; 3]; 3],
    ) -> Result<Self, PoseNoiseError> {
        let covariance = checked(&covariance)?;
        check_rotation(rotation)?;
        let mut world = [[0.0; 6]; 6];
        // Each 3×3 block B becomes R B Rᵀ.
        for (row, column) in [(0, 0), (0, 3), (3, 0), (3, 3)] {
            for i in 0..3 {
                for j in 0..3 {
                    let turned =
                        (0..3).map(|k| covariance[row + k]).zip(rotation[i]).map(|(entries, weight)| {
                            weight
                                * dot(
                                    [entries[column], entries[column + 1], entries[column + 2]],
                                    rotation[j],
                                )
                        });
                    world[row + i][column + j] = turned.sum();
                }
            }
        }
        Ok(Self { covariance: checked(&world)? })
    }

    /// The 6×6 covariance, in the order and convention of the [type](Self).
    pub fn covariance(&self) -> [[f64; 6]; 6] {
        self.covariance
    }

    /// The covariance `J Σ Jᵀ` that the pose gives to a point of the world; `None` when a place or a variance is not
    /// finite.
    pub fn at(&self, sensor: [f64; 3], point: [f64; 3]) -> Option<Covariance> {
        let jacobian = jacobian(sensor, point)?;
        let product = |i: usize, j: usize| -> f64 {
            let (left, right) = (jacobian[i], jacobian[j]);
            self.covariance.iter().zip(left).map(|(row, a)| a * product6(row, &right)).sum()
        };
        let entries = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].map(|(i, j)| product(i, j));
        Covariance::of_entries(entries).finite()
    }
}

fn product6(a: &[f64; 6], b: &[f64; 6]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

fn check_rotation(rotation: [[f64; 3]; 3]) -> Result<(), PoseNoiseError> {
    let [x, y, z] = rotation;
    let deviation = [(x, x, 1.0), (y, y, 1.0), (z, z, 1.0), (x, y, 0.0), (y, z, 0.0), (z, x, 0.0)]
        .map(|(a, b, identity)| (dot(a, b) - identity).abs())
        .into_iter()
        .fold(0.0, |largest: f64, d| if d.is_nan() { f64::INFINITY } else { largest.max(d) });
    let determinant = dot(cross(x, y), z);
    if deviation <= MAX_ROTATION_DEVIATION && determinant > 0.0 {
        Ok(())
    } else {
        Err(PoseNoiseError::NotARotation { deviation, determinant })
    }
}
