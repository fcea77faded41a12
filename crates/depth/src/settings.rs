//! What may be set.

use crate::DepthError;

/// What makes a region a plane, and a pixel one of its points. All have defaults that follow from the image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// The largest standard error of a plane's orientation, in radians.
    pub tilt: f64,
    /// The largest distance of a point from its plane, in standard errors.
    pub reach: f64,
    /// The normal of a plane turns over its surface by less than this, rms, in radians. What turns further, significantly, is curved.
    pub turn: f64,
    /// The fewest pixels of a plane. `None`: four in a thousand of those with a depth, at least 20, and 250 are always enough.
    pub min_points: Option<u64>,
    /// The least area of a plane, in m². `None`: a quarter of a per cent of the area of all planes.
    pub min_area: Option<f64>,
}

impl Default for Settings {
    fn default() -> Self {
        Self { tilt: 0.01, reach: 3.1, turn: 0.1, min_points: None, min_area: None }
    }
}

impl Settings {
    /// # Errors
    /// [`DepthError::Setting`] for the first setting out of its range.
    pub fn validate(&self) -> Result<(), DepthError> {
        for (name, value) in [("tilt", self.tilt), ("reach", self.reach), ("turn", self.turn)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(DepthError::Setting { name, value, expected: "above zero and finite" });
            }
        }
        match self.min_area {
            Some(value) if !(value >= 0.0 && value.is_finite()) => {
                Err(DepthError::Setting { name: "min_area", value, expected: "at least zero and finite" })
            }
            _ => Ok(()),
        }
    }
}
