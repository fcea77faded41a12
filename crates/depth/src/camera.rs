//! What a pixel of a depth image measures.

use crate::DepthError;

/// The camera of depth images: a pinhole, its pixels, and the unit of depths.
///
/// Pixel `(u, v)` is column `u` and row `v`, both from 0, whole numbers at pixel centres. The camera looks along z, x goes right and y
/// down; a negative `fy` is allowed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) focal: [f64; 2],
    pub(crate) centre: [f64; 2],
    /// Metres of a raw unit.
    pub(crate) unit: f64,
}

/// Most columns or rows.
const MOST: usize = 1 << 14;

impl Camera {
    /// A camera with images of `width` × `height` pixels, focal lengths `[fx, fy]` and principal point `[cx, cy]` in pixels, and so many raw
    /// units of depth in a metre: 1000 for millimetres.
    ///
    /// # Errors
    /// [`DepthError`] for images without a pixel or of more than 16384 columns or rows, focal lengths of zero, and what is not finite.
    pub fn new(
        [width, height]: [usize; 2],
        focal: [f64; 2],
        centre: [f64; 2],
        units_per_metre: f64,
    ) -> Result<Self, DepthError> {
        if !(1..=MOST).contains(&width) || !(1..=MOST).contains(&height) {
            return Err(DepthError::Size { width, height });
        }
        if !focal.iter().all(|f| f.is_normal()) || !centre.iter().all(|c| c.is_finite()) {
            return Err(DepthError::Pinhole { focal, centre });
        }
        let unit = 1.0 / units_per_metre;
        if !(unit.is_normal() && unit > 0.0) {
            return Err(DepthError::Scale { units_per_metre });
        }
        Ok(Self { width, height, focal, centre, unit })
    }

    /// Columns and rows of its images.
    pub fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    /// Where the ray of a pixel meets the plane z = 1.
    pub(crate) fn ray(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        [(u - self.centre[0]) / self.focal[0], (v - self.centre[1]) / self.focal[1]]
    }

    /// The width of a pixel in metres on a surface at the depth of one metre.
    pub(crate) fn pixel(&self) -> f64 {
        (self.focal[0] * self.focal[1]).abs().sqrt().recip()
    }
}

/// Whether a raw number stands for a depth: 0 and 65535 do not.
#[inline]
pub(crate) fn is_measurement(raw: u16) -> bool {
    raw != 0 && raw != u16::MAX
}
