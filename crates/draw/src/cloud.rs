//! A picture of a point cloud, to which points are added one by one.

use crate::canvas::{Anchor, Canvas};
use crate::error::{DrawError, check_size};
use crate::image::Image;
use crate::raster::Raster;
use crate::view::{Bounds, Projection, View};
use crate::{shade, splat};

/// What is seen through each pixel: how far away, in metres from an arbitrary zero, and in which colour.
/// A depth of +∞ is background. Single precision
/// is enough: depths count from the centre of the bounds.
#[derive(Debug, Clone)]
pub(crate) struct DepthImage {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) depth: Vec<f32>,
    pub(crate) colour: Vec<[u8; 3]>,
}

/// A picture of a point cloud. Memory is that of the picture, however many points are added.
///
/// Only the nearest point of each pixel is kept. When the picture is asked for, every kept point grows to a disc that
/// closes the gaps of its neighbourhood, so that surfaces look closed and hide what is behind them; then the shape is
/// brought out by light from the upper left and by dark edges where the depth jumps.
///
/// Points that are not finite, outside the picture or cut away are passed over.
///
/// ```
/// use terrace_draw::{Bounds, CloudPicture, View};
///
/// let bounds = Bounds::new([0.0; 3], [1.0; 3])?;
/// let mut picture = CloudPicture::new(320, 240, View::from_degrees(30.0, 20.0)?, bounds)?.with_title("a cube's corner");
/// for k in 0..1000 {
///     picture.add([f64::from(k % 10) / 10.0, f64::from(k / 10 % 10) / 10.0, f64::from(k / 100) / 10.0], [30, 90, 160]);
/// }
/// assert_eq!(&picture.png()?[1..4], b"PNG");
/// # Ok::<(), terrace_draw::DrawError>(())
/// ```
#[derive(Debug, Clone)]
pub struct CloudPicture {
    seen: DepthImage,
    projection: Projection,
    view: View,
    bounds: Bounds,
    cut: f64,
    title: String,
}

/// Pixels are made this many times finer than asked for and then averaged, which smooths borders.
const FINER: usize = 2;

/// Height of the title's letters and of the strip kept free for it, in pixels.
const TITLE: [usize; 2] = [16, 36];

impl CloudPicture {
    /// An empty picture of `width` × `height` pixels, in which the bounds just fit.
    ///
    /// # Errors
    /// [`DrawError::Size`] when a side is 0 or above [`MAX_SIDE`](crate::MAX_SIDE).
    pub fn new(width: usize, height: usize, view: View, bounds: Bounds) -> Result<Self, DrawError> {
        check_size(width, height)?;
        let seen = DepthImage::new(width * FINER, height * FINER);
        let projection = Projection::new(&view, &bounds, seen.width, seen.height, 0);
        Ok(Self { seen, projection, view, bounds, cut: f64::INFINITY, title: String::new() })
    }

    /// With a title above the cloud. To be set before points are added.
    #[must_use]
    pub fn with_title(mut self, title: &str) -> Self {
        title.clone_into(&mut self.title);
        self.fit();
        self
    }

    /// Leaves out all points that lie higher than this along the direction up, in metres, to look into a room from
    /// above. To be set before points are added.
    #[must_use]
    pub fn with_cut_above(mut self, height: f64) -> Self {
        self.cut = height;
        self.fit();
        self
    }

    fn fit(&mut self) {
        let top = if self.title.is_empty() { 0 } else { TITLE[1] * FINER };
        let bounds = self.bounds.below(self.view.up(), self.cut);
        self.projection = Projection::new(&self.view, &bounds, self.seen.width, self.seen.height, top);
    }

    /// Adds a point.
    pub fn add(&mut self, point: [f64; 3], colour: [u8; 3]) {
        let up = self.view.up();
        let height = point[0] * up[0] + point[1] * up[1] + point[2] * up[2];
        if height > self.cut {
            return;
        }
        let Some([x, y, depth]) = self.projection.project(point) else { return };
        let Some(at) = self.seen.index(x, y) else { return };
        #[expect(clippy::cast_possible_truncation, reason = "depths are compared to a fraction of a pixel")]
        let depth = depth as f32;
        if let (Some(nearest), Some(pixel)) = (self.seen.depth.get_mut(at), self.seen.colour.get_mut(at))
            && depth < *nearest
        {
            *nearest = depth;
            *pixel = colour;
        }
    }

    /// The picture of the points so far.
    pub fn image(&self) -> Image {
        let pixel = self.projection.pixel();
        let closed = splat::close(&self.seen, shade::JUMP * pixel);
        let mut image = shade::shade(&closed, pixel).coarser(FINER);
        if !self.title.is_empty() {
            let middle = [image.width() as f64 / 2.0, (TITLE[1] / 2) as f64];
            let mut raster = Raster::on(image);
            raster.text(middle, &self.title, TITLE[0] as f64, Anchor::Middle, [40, 40, 40]);
            image = raster.into_image();
        }
        image
    }

    /// The picture of the points so far as the bytes of a PNG file.
    ///
    /// # Errors
    /// [`DrawError::Png`] when the encoder fails.
    pub fn png(&self) -> Result<Vec<u8>, DrawError> {
        self.image().png()
    }
}

impl DepthImage {
    fn new(width: usize, height: usize) -> Self {
        Self {
            width,
            height,
            depth: vec![f32::INFINITY; width * height],
            colour: vec![[0; 3]; width * height],
        }
    }

    /// The pixel at these coordinates, with the centre of the first at (½, ½).
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "checked to be within the picture"
    )]
    fn index(&self, x: f64, y: f64) -> Option<usize> {
        let inside = x >= 0.0 && y >= 0.0 && x < self.width as f64 && y < self.height as f64;
        inside.then(|| y as usize * self.width + x as usize)
    }

    /// Depth of a pixel; `None` outside.
    pub(crate) fn depth_at(&self, x: usize, y: usize) -> Option<f32> {
        if x < self.width { self.depth.get(y * self.width + x).copied() } else { None }
    }
}
