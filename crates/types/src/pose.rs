//! A rigid motion from the sensor's frame to the world.

use crate::vector::{cross, direction, dot};

/// How far `R Rᵀ` may be from the identity, in any entry, for a matrix still to count as a rotation.
///
/// Wide enough for poses written with four digits; within it the matrix is made orthonormal on entry.
pub const MAX_ROTATION_DEVIATION: f64 = 1e-3;

/// The pose of a sensor: a rotation and a translation in metres, with `world = R · sensor + t`.
///
/// ```
/// use terrace_types::Pose;
///
/// // A quarter turn about z, then one metre along x.
/// let half = std::f64::consts::FRAC_1_SQRT_2;
/// let pose = Pose::from_quaternion([1.0, 0.0, 0.0], [0.0, 0.0, half, half])?;
/// let p = pose.transform([1.0, 0.0, 0.0]);
/// assert!((p[0] - 1.0).abs() < 1e-15 && (p[1] - 1.0).abs() < 1e-15);
/// # Ok::<(), terrace_types::PoseError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    rotation: [[f64; 3]; 3],
    translation: [f64; 3],
}

/// Why a pose was refused.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum PoseError {
    /// An entry is NaN or infinite.
    #[error("the pose holds {value}, which is not finite")]
    NotFinite {
        /// The entry found.
        value: f64,
    },
    /// The upper left 3×3 is not a rotation: its rows are not unit and perpendicular.
    #[error(
        "the 3x3 part of the pose is not a rotation: it is {deviation} away from one (at most {MAX_ROTATION_DEVIATION})"
    )]
    NotARotation {
        /// Largest entry of `R Rᵀ − I`, in absolute value.
        deviation: f64,
    },
    /// The 3×3 part mirrors space (determinant −1). Often two axes were exchanged without turning a third.
    #[error("the 3x3 part of the pose mirrors space instead of rotating it")]
    Mirrored,
    /// The quaternion is zero (or subnormal in every entry) and so has no direction.
    #[error("the quaternion ({}, {}, {}, {}) is zero", quaternion[0], quaternion[1], quaternion[2], quaternion[3])]
    ZeroQuaternion {
        /// The quaternion as given, `x y z w`.
        quaternion: [f64; 4],
    },
    /// The last row of a 4×4 matrix does not start with `0 0 0`, so that it is no rigid motion.
    #[error("the last row of the pose starts with {} {} {} instead of 0 0 0", row[0], row[1], row[2])]
    NotRigid {
        /// The last row.
        row: [f64; 4],
    },
}

impl Pose {
    /// Sensor and world frame are the same.
    pub const IDENTITY: Self =
        Self { rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], translation: [0.0; 3] };

    /// From the rows of a rotation matrix and a translation in metres. A matrix that is a rotation to within
    /// [`MAX_ROTATION_DEVIATION`] is made orthonormal (Gram-Schmidt on its rows).
    ///
    /// # Errors
    /// [`PoseError`] for entries that are not finite and for matrices that do not rotate.
    pub fn new(rotation: [[f64; 3]; 3], translation: [f64; 3]) -> Result<Self, PoseError> {
        if let Some(value) = rotation.iter().flatten().chain(&translation).find(|x| !x.is_finite()) {
            return Err(PoseError::NotFinite { value: *value });
        }
        let [x, y, z] = rotation;
        let deviation = [(x, x, 1.0), (y, y, 1.0), (z, z, 1.0), (x, y, 0.0), (y, z, 0.0), (z, x, 0.0)]
            .into_iter()
            .map(|(a, b, identity)| (dot(a, b) - identity).abs())
            .fold(0.0, f64::max);
        if deviation > MAX_ROTATION_DEVIATION {
            return Err(PoseError::NotARotation { deviation });
        }
        if dot(cross(x, y), z) < 0.0 {
            return Err(PoseError::Mirrored);
        }
        let x = unit(x);
        let along = dot(x, y);
        let y = unit([y[0] - along * x[0], y[1] - along * x[1], y[2] - along * x[2]]);
        Ok(Self { rotation: [x, y, cross(x, y)], translation })
    }

    /// The same orientation, to the bit, this many metres further along each axis.
    ///
    /// # Errors
    /// [`PoseError::NotFinite`] when that is nowhere.
    pub fn translated(&self, by: [f64; 3]) -> Result<Self, PoseError> {
        let translation = [0, 1, 2].map(|i| self.translation[i] + by[i]);
        match translation.iter().find(|x| !x.is_finite()) {
            Some(value) => Err(PoseError::NotFinite { value: *value }),
            None => Ok(Self { translation, ..*self }),
        }
    }

    /// From a 4×4 matrix, row by row. The last entry of the last row is not looked at: it is 1 by definition, and
    /// some recorders keep a time stamp there.
    ///
    /// # Errors
    /// [`PoseError`] as for [`Pose::new`], and when the last row is not `0 0 0 _`.
    pub fn from_matrix(m: [[f64; 4]; 4]) -> Result<Self, PoseError> {
        let row = m[3];
        if row[..3].iter().any(|x| x.abs() > 1e-9 || x.is_nan()) {
            return Err(PoseError::NotRigid { row });
        }
        Self::new([0, 1, 2].map(|i| [m[i][0], m[i][1], m[i][2]]), [m[0][3], m[1][3], m[2][3]])
    }

    /// From a translation in metres and a quaternion `[x, y, z, w]`, which need not be of unit length.
    ///
    /// # Errors
    /// [`PoseError`] when an entry is not finite or the quaternion is zero.
    pub fn from_quaternion(translation: [f64; 3], quaternion: [f64; 4]) -> Result<Self, PoseError> {
        if let Some(value) = quaternion.iter().find(|x| !x.is_finite()) {
            return Err(PoseError::NotFinite { value: *value });
        }
        let [x, y, z, w] = direction(quaternion).ok_or(PoseError::ZeroQuaternion { quaternion })?;
        let rotation = [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
            [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)],
            [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)],
        ];
        Self::new(rotation, translation)
    }

    /// The rows of the rotation matrix.
    pub fn rotation(&self) -> [[f64; 3]; 3] {
        self.rotation
    }

    /// Where the sensor is in the world, in metres.
    pub fn translation(&self) -> [f64; 3] {
        self.translation
    }

    /// A point from sensor to world coordinates.
    #[inline]
    pub fn transform(&self, point: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|i| dot(self.rotation[i], point) + self.translation[i])
    }

    /// A direction from sensor to world coordinates.
    pub fn rotate(&self, direction: [f64; 3]) -> [f64; 3] {
        self.rotation.map(|row| dot(row, direction))
    }

    /// A point from world to sensor coordinates.
    pub fn inverse_transform(&self, point: [f64; 3]) -> [f64; 3] {
        let p = [0, 1, 2].map(|i| point[i] - self.translation[i]);
        [0, 1, 2].map(|i| (0..3).map(|row| self.rotation[row][i] * p[row]).sum())
    }

    /// Standard errors along the sensor's axes turned into those along the world's axes: the square roots of the
    /// diagonal of `R diag(σ²) Rᵀ`.
    pub fn rotate_sigma(&self, sigma: [f64; 3]) -> [f64; 3] {
        self.rotation.map(|row| (0..3).map(|j| (row[j] * sigma[j]).powi(2)).sum::<f64>().sqrt())
    }

    /// A covariance `xx, xy, xz, yy, yz, zz` along the sensor's axes turned into that along the world's axes, `R C Rᵀ`.
    pub fn rotate_covariance(&self, [xx, xy, xz, yy, yz, zz]: [f64; 6]) -> [f64; 6] {
        let rows = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
        // Row i is C rᵢ.
        let half = self.rotation.map(|axis| rows.map(|row| dot(row, axis)));
        [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].map(|(i, j)| dot(self.rotation[i], half[j]))
    }
}

/// Of a vector whose length is near 1 already.
fn unit(a: [f64; 3]) -> [f64; 3] {
    let length = dot(a, a).sqrt();
    a.map(|x| x / length)
}
