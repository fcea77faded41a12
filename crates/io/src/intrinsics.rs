//! The pinhole camera: focal lengths and principal point.

use std::path::Path;
use std::str::FromStr;

use serde_json::Value;

use crate::FileError;

/// Focal lengths and principal point of a pinhole camera, in pixels.
///
/// Pixel `(u, v)` is column `u` and row `v`, both from 0, whole numbers at pixel centres. The camera looks along z,
/// x goes right and y down. A negative `fy` is allowed: the data set ICL-NUIM has one, its y axis points up.
///
/// ```
/// use terrace_io::Intrinsics;
///
/// let camera: Intrinsics = "525, 525, 319.5, 239.5".parse()?;
/// let point = camera.unproject([319.5 + 52.5, 239.5], 2.0);
/// assert_eq!(point, [0.2, 0.0, 2.0]);
/// assert_eq!(camera.project(point), [372.0, 239.5]);
/// # Ok::<(), terrace_io::IntrinsicsError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Intrinsics {
    fx: f64,
    fy: f64,
    cx: f64,
    cy: f64,
}

/// Why no camera could be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum IntrinsicsError {
    /// A focal length is zero, NaN or infinite.
    #[error("the focal length {name} is {value}; it must be finite and not zero")]
    FocalLength {
        /// `fx` or `fy`.
        name: &'static str,
        /// The value found.
        value: f64,
    },
    /// A coordinate of the principal point is NaN or infinite.
    #[error("the principal point has {name} = {value}, which is not finite")]
    PrincipalPoint {
        /// `cx` or `cy`.
        name: &'static str,
        /// The value found.
        value: f64,
    },
    /// The text is not four numbers. Write `fx,fy,cx,cy`.
    #[error("expected the four numbers fx,fy,cx,cy and found '{text}'")]
    NotFourNumbers {
        /// The text, shortened.
        text: String,
    },
    /// The text of a 3×3 matrix does not hold nine numbers.
    #[error("expected a 3x3 camera matrix and found {found} numbers")]
    NotNineNumbers {
        /// How many numbers there are before the end or the first thing that is none.
        found: usize,
    },
    /// The 3×3 matrix is not `fx 0 cx; 0 fy cy; 0 0 1`: it is transposed, or has skew, which is not supported.
    #[error("the entry in row {row}, column {column} of the camera matrix is {value} instead of {expected}")]
    NotAPinhole {
        /// Row, from 0.
        row: usize,
        /// Column, from 0.
        column: usize,
        /// The value found.
        value: f64,
        /// The value such a matrix has there.
        expected: f64,
    },
    /// The JSON cannot be parsed.
    #[error("not JSON: {message}")]
    Json {
        /// What the parser says, with line and column.
        message: String,
    },
    /// The JSON has neither the keys `fx`, `fy`, `cx`, `cy` nor an `intrinsic_matrix` of nine numbers.
    #[error("the JSON has no number '{key}' (expected fx, fy, cx, cy or Open3D's intrinsic_matrix)")]
    MissingKey {
        /// The first key missing.
        key: &'static str,
    },
    /// The file is neither JSON nor text.
    #[error("the file is not text")]
    NotText,
}

impl Intrinsics {
    /// A camera from focal lengths and principal point in pixels.
    ///
    /// # Errors
    /// [`IntrinsicsError`] when a number is not finite or a focal length is zero.
    pub fn new(fx: f64, fy: f64, cx: f64, cy: f64) -> Result<Self, IntrinsicsError> {
        for (name, value) in [("fx", fx), ("fy", fy)] {
            if !value.is_finite() || value == 0.0 {
                return Err(IntrinsicsError::FocalLength { name, value });
            }
        }
        for (name, value) in [("cx", cx), ("cy", cy)] {
            if !value.is_finite() {
                return Err(IntrinsicsError::PrincipalPoint { name, value });
            }
        }
        Ok(Self { fx, fy, cx, cy })
    }

    /// `[fx, fy, cx, cy]`, in pixels.
    pub fn entries(&self) -> [f64; 4] {
        [self.fx, self.fy, self.cx, self.cy]
    }

    /// From the bytes of a file: JSON with `fx`, `fy`, `cx`, `cy`, JSON of `Open3D` with `intrinsic_matrix` (nine
    /// numbers, column by column), or the nine numbers of a 3×3 matrix as text, row by row.
    ///
    /// # Errors
    /// [`IntrinsicsError`] when it is none of these or not a pinhole camera.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, IntrinsicsError> {
        let text = std::str::from_utf8(bytes).map_err(|_| IntrinsicsError::NotText)?;
        if text.trim_start().starts_with('{') { Self::from_json(text) } else { Self::from_matrix_text(text) }
    }

    /// Reads a file as [`Intrinsics::from_bytes`] does.
    ///
    /// # Errors
    /// [`FileError`] naming the file.
    pub fn open(path: &Path) -> Result<Self, FileError<IntrinsicsError>> {
        crate::file::open_with(path, Self::from_bytes)
    }

    fn from_json(text: &str) -> Result<Self, IntrinsicsError> {
        let json: Value =
            serde_json::from_str(text).map_err(|e| IntrinsicsError::Json { message: e.to_string() })?;
        if let Some(matrix) = json.get("intrinsic_matrix") {
            let missing = IntrinsicsError::MissingKey { key: "intrinsic_matrix" };
            let Some(columns) = matrix.as_array().filter(|m| m.len() == 9) else { return Err(missing) };
            let mut rows = [[0.0; 3]; 3];
            for (index, value) in columns.iter().enumerate() {
                rows[index % 3][index / 3] = value.as_f64().ok_or_else(|| missing.clone())?;
            }
            return Self::from_matrix(rows);
        }
        let number = |key| json.get(key).and_then(Value::as_f64).ok_or(IntrinsicsError::MissingKey { key });
        Self::new(number("fx")?, number("fy")?, number("cx")?, number("cy")?)
    }

    fn from_matrix_text(text: &str) -> Result<Self, IntrinsicsError> {
        let mut rows = [[0.0; 3]; 3];
        let mut found = 0;
        for token in text.split(|c: char| c.is_whitespace() || c == ',').filter(|t| !t.is_empty()) {
            let Ok(value) = token.parse() else { return Err(IntrinsicsError::NotNineNumbers { found }) };
            if found < 9 {
                rows[found / 3][found % 3] = value;
            }
            found += 1;
        }
        if found == 9 { Self::from_matrix(rows) } else { Err(IntrinsicsError::NotNineNumbers { found }) }
    }

    fn from_matrix(m: [[f64; 3]; 3]) -> Result<Self, IntrinsicsError> {
        for (row, column, expected) in [(0, 1, 0.0), (1, 0, 0.0), (2, 0, 0.0), (2, 1, 0.0), (2, 2, 1.0)] {
            let value = m[row][column];
            #[expect(clippy::float_cmp, reason = "these entries are exact by definition")]
            if value != expected {
                return Err(IntrinsicsError::NotAPinhole { row, column, value, expected });
            }
        }
        Self::new(m[0][0], m[1][1], m[0][2], m[1][2])
    }

    /// `[fx, fy, cx, cy]` in pixels.
    pub fn parameters(&self) -> [f64; 4] {
        [self.fx, self.fy, self.cx, self.cy]
    }

    /// The point in the camera's frame at depth `z` (metres along the optical axis) behind pixel `[u, v]`:
    /// `((u − cx) z / fx, (v − cy) z / fy, z)`.
    pub fn unproject(&self, [u, v]: [f64; 2], z: f64) -> [f64; 3] {
        [(u - self.cx) * z / self.fx, (v - self.cy) * z / self.fy, z]
    }

    /// The pixel `[u, v]` on which a point of the camera's frame falls; not finite for points with z = 0.
    pub fn project(&self, [x, y, z]: [f64; 3]) -> [f64; 2] {
        [x / z * self.fx + self.cx, y / z * self.fy + self.cy]
    }
}

impl FromStr for Intrinsics {
    type Err = IntrinsicsError;

    /// From `fx,fy,cx,cy`; spaces around the commas are allowed.
    fn from_str(text: &str) -> Result<Self, IntrinsicsError> {
        let numbers: Result<Vec<f64>, _> = text.split(',').take(5).map(|t| t.trim().parse()).collect();
        match numbers.as_deref() {
            Ok(&[fx, fy, cx, cy]) => Self::new(fx, fy, cx, cy),
            _ => Err(IntrinsicsError::NotFourNumbers { text: text.chars().take(60).collect() }),
        }
    }
}
