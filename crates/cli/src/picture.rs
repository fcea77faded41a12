//! Planes from two sides, as a picture.

use std::path::Path;

use terrace::PlaneId;
use terrace_draw::{Bounds, CloudPicture, DrawError, Image, View, label_colour};
use terrace_io::{WriteError, write_atomically};

/// Edges of each of the two views, in pixels.
const SIZE: (usize, usize) = (900, 700);

/// A cloud seen from two sides at once, point by point.
pub struct TwoSides {
    views: [CloudPicture; 2],
}

impl TwoSides {
    /// Views of what is within `bounds`, from the front left and the back right.
    pub fn new(bounds: Bounds, up: [f64; 3], title: &str) -> Result<Self, DrawError> {
        let view = |azimuth, elevation, title: &str| -> Result<CloudPicture, DrawError> {
            let view = View::from_degrees(azimuth, elevation)?.with_up(up)?;
            Ok(CloudPicture::new(SIZE.0, SIZE.1, view, bounds)?.with_title(title))
        };
        Ok(Self { views: [view(-125.0, 35.0, title)?, view(40.0, 25.0, "from the other side")?] })
    }

    /// Adds a point in the colour of its plane.
    pub fn add(&mut self, point: [f64; 3], plane: Option<PlaneId>) {
        for view in &mut self.views {
            view.add(point, label_colour(plane));
        }
    }

    /// Both views side by side.
    pub fn image(&self) -> Result<Image, DrawError> {
        Image::beside(&self.views[0].image(), &self.views[1].image())
    }
}

/// Writes a PNG made before.
pub fn write_png(path: &Path, png: &[u8]) -> Result<(), WriteError> {
    write_atomically(path, |out| Ok(out.write_all(png)?))
}
