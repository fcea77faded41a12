//! Why no picture was made.

/// The largest width and height of a picture, in pixels.
pub const MAX_SIDE: usize = 8_192;

/// Why no picture was made.
#[derive(Debug, thiserror::Error)]
pub enum DrawError {
    /// A side of the picture is zero or above [`MAX_SIDE`].
    #[error("a picture of {width} x {height} pixels was asked for; each side may be 1 to {MAX_SIDE}")]
    Size {
        /// Width asked for.
        width: usize,
        /// Height asked for.
        height: usize,
    },
    /// A bound is not finite, or a lower bound is above the upper one.
    #[error("the bounds {min:?} to {max:?} enclose nothing")]
    Bounds {
        /// Lower corner as given.
        min: [f64; 3],
        /// Upper corner as given.
        max: [f64; 3],
    },
    /// An angle is not finite, or a field of view is not within 0 to 180 degrees.
    #[error("{radians} rad is no angle to look from or with")]
    Angle {
        /// The angle in radians.
        radians: f64,
    },
    /// The direction that is to be up in the picture has no length.
    #[error("{up:?} is no direction")]
    Up {
        /// The direction as given.
        up: [f64; 3],
    },
    /// The range of a chart's axis is not finite or empty.
    #[error("the chart's range {low} to {high} is empty")]
    Range {
        /// Lower end.
        low: f64,
        /// Upper end.
        high: f64,
    },
    /// The PNG could not be written.
    #[error("the picture could not be encoded: {0}")]
    Png(#[from] png::EncodingError),
}

pub(crate) fn check_size(width: usize, height: usize) -> Result<(), DrawError> {
    if (1..=MAX_SIDE).contains(&width) && (1..=MAX_SIDE).contains(&height) {
        Ok(())
    } else {
        Err(DrawError::Size { width, height })
    }
}
