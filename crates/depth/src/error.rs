//! What can be wrong.

/// Why no planes were looked for.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DepthError {
    /// The image has no pixel, or too many columns or rows.
    #[error("an image of {width} x {height} pixels; from 1 x 1 to 16384 x 16384 can be used")]
    Size {
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// The focal lengths or the principal point cannot be used.
    #[error("focal lengths {focal:?} and principal point {centre:?} in pixels: no pinhole camera")]
    Pinhole {
        /// fx, fy.
        focal: [f64; 2],
        /// cx, cy.
        centre: [f64; 2],
    },
    /// The scale is not a positive, finite number of raw units per metre.
    #[error("the depth scale {units_per_metre} is not a positive number of raw units per metre")]
    Scale {
        /// As given.
        units_per_metre: f64,
    },
    /// There are not as many depths as pixels.
    #[error("{found} depths for {expected} pixels")]
    Length {
        /// How many were given.
        found: usize,
        /// Pixels of the camera.
        expected: usize,
    },
    /// A setting is out of its range.
    #[error("the setting {name} is {value}; it has to be {expected}")]
    Setting {
        /// Its name.
        name: &'static str,
        /// As given.
        value: f64,
        /// What it may be.
        expected: &'static str,
    },
    /// The noise model cannot be used.
    #[error(transparent)]
    Noise(#[from] terrace_noise::ScanNoiseError),
}
