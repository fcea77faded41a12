//! The pixels of a plane on which points were seen.

use foldhash::fast::FixedState;
use hashbrown::HashMap;

use crate::{ExtentError, PlaneFrame};

/// The pixels a footprint holds by default before it takes larger ones: about 30 MB.
pub const DEFAULT_MAX_PIXELS: usize = 1 << 20;

/// The most pixels a footprint can be told to hold.
pub const MOST_PIXELS: usize = 1 << 22;

/// The fewest: four pixels meet at the origin, and no pixel is ever so large that it holds them all.
const LEAST_PIXELS: usize = 4;

/// Farthest pixel from the origin.
const FARTHEST: u32 = 1 << 28;

/// Pixels by column and row, with the number of points on each.
pub(crate) type Pixels = HashMap<[i32; 2], u32, FixedState>;

/// Where points of a plane were seen: square pixels of the plane with the number of points on each.
///
/// Points are taken one by one and not kept, so that memory is that of the occupied pixels, whatever the number of
/// points and however far apart they are. Beyond a limit on pixels, pixels of twice the side are taken, as often as
/// needed; [`Footprint::resolution`] tells. The order of the points makes no difference.
///
/// ```
/// use terrace_extent::{Footprint, OutlineOptions, PlaneFrame};
/// use terrace_types::Plane;
///
/// let floor = Plane::through([0.0; 3], [0.0, 0.0, 1.0])?;
/// let mut footprint = Footprint::new(PlaneFrame::new(&floor, [0.0; 3])?, 0.1)?;
/// for k in 0..1200 {
///     footprint.add([f64::from(k % 40) * 0.1 + 0.05, f64::from(k / 40) * 0.1 + 0.05, 0.0])?;
/// }
/// let polygons = footprint.outline(&OutlineOptions::closing(0.3))?;
/// assert!((polygons[0].area() - 4.0 * 3.0).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Footprint {
    frame: PlaneFrame,
    /// Side of a pixel as asked for.
    finest: f64,
    /// How often pixels were merged by two.
    halvings: u32,
    max_pixels: usize,
    pixels: Pixels,
}

/// The pixel size, in metres, for points with this mean spacing, in metres: one and a half spacings, so that most pixels
/// have a point and borders come out straight.
///
/// Where pixels are smaller than the spacing, the border lies inside by up to half of the difference, for it runs along
/// the outermost points. Larger ones lose detail.
pub fn suggested_resolution(spacing: f64) -> f64 {
    1.5 * spacing
}

/// The gap to close, in metres, for points with this mean spacing, in metres: three spacings, where points that fall at
/// random leave few holes.
pub fn suggested_gap(spacing: f64) -> f64 {
    3.0 * spacing
}

impl Footprint {
    /// An empty footprint with pixels of side `resolution`, in metres (see [`suggested_resolution`]), of which it holds
    /// up to [`DEFAULT_MAX_PIXELS`].
    ///
    /// # Errors
    /// [`ExtentError::Resolution`] when the resolution is not positive and finite.
    pub fn new(frame: PlaneFrame, resolution: f64) -> Result<Self, ExtentError> {
        Self::with_max_pixels(frame, resolution, DEFAULT_MAX_PIXELS)
    }

    /// An empty footprint that holds up to `max_pixels`, at some 30 bytes each.
    ///
    /// # Errors
    /// [`ExtentError::Resolution`] as for [`Footprint::new`], [`ExtentError::PixelLimit`] when the limit is not from 4 to
    /// [`MOST_PIXELS`].
    pub fn with_max_pixels(
        frame: PlaneFrame,
        resolution: f64,
        max_pixels: usize,
    ) -> Result<Self, ExtentError> {
        // The largest and smallest numbers would overflow on the way from pixels to square metres.
        if !(1e-100..1e100).contains(&resolution) {
            return Err(ExtentError::Resolution { resolution });
        }
        if !(LEAST_PIXELS..=MOST_PIXELS).contains(&max_pixels) {
            let (limit, least, most) = (max_pixels, LEAST_PIXELS, MOST_PIXELS);
            return Err(ExtentError::PixelLimit { limit, least, most });
        }
        let pixels = Pixels::with_hasher(FixedState::default());
        Ok(Self { frame, finest: resolution, halvings: 0, max_pixels, pixels })
    }

    /// Adds a point of the world, in metres. Its distance from the plane does not matter.
    ///
    /// # Errors
    /// [`ExtentError::PointNotFinite`], and [`ExtentError::TooFar`] when the point is more than 2²⁸ pixels, as they were
    /// at first, from the origin of the frame. The footprint stays as it was.
    pub fn add(&mut self, point: [f64; 3]) -> Result<(), ExtentError> {
        self.add_cell(point, 1)
    }

    /// Adds `count` points at once, such as those of a cell of a grid with their mean. Cells should be no larger than a
    /// pixel: their points all count at the mean.
    ///
    /// # Errors
    /// As for [`Footprint::add`].
    pub fn add_cell(&mut self, mean: [f64; 3], count: u32) -> Result<(), ExtentError> {
        if count == 0 {
            return Ok(());
        }
        let [u, v] = self.frame.to_plane(mean);
        if !(u.is_finite() && v.is_finite()) {
            return Err(ExtentError::PointNotFinite { point: mean });
        }
        let pixel = [self.index(u)?, self.index(v)?];
        let points = self.pixels.entry(pixel).or_insert(0);
        *points = points.saturating_add(count);
        while self.pixels.len() > self.max_pixels {
            self.coarsen();
        }
        Ok(())
    }

    /// The frame of the plane.
    pub fn frame(&self) -> &PlaneFrame {
        &self.frame
    }

    /// Side of a pixel in metres: that asked for, or twice, four times … as much since there were too many pixels.
    pub fn resolution(&self) -> f64 {
        self.finest * f64::from(1_u32 << self.halvings)
    }

    /// Number of pixels with points.
    pub fn occupied(&self) -> usize {
        self.pixels.len()
    }

    pub(crate) fn pixels(&self) -> &Pixels {
        &self.pixels
    }

    /// Column or row of a coordinate. Shifting the finest index, rather than dividing by the present side, makes it
    /// independent of when pixels were merged.
    fn index(&self, coordinate: f64) -> Result<i32, ExtentError> {
        let index = (coordinate / self.finest).floor();
        if index.abs() >= f64::from(FARTHEST) {
            let (resolution, most) = (self.finest, FARTHEST);
            return Err(ExtentError::TooFar { distance: coordinate.abs(), resolution, most });
        }
        #[expect(clippy::cast_possible_truncation, reason = "just checked")]
        let index = index as i32;
        Ok(index >> self.halvings)
    }

    fn coarsen(&mut self) {
        let mut merged = Pixels::with_hasher(FixedState::default());
        for ([column, row], count) in self.pixels.drain() {
            let points = merged.entry([column >> 1, row >> 1]).or_insert(0);
            *points = points.saturating_add(count);
        }
        self.pixels = merged;
        self.halvings += 1;
    }
}
