//! Pictures without a window: coloured point clouds as PNG, charts of staircase costs and Q-Q plots as SVG or PNG.
//!
//! Results of a plane finder have to be looked at, also where there is no display: in a test, on a server, in a README.
//!
//! * [`CloudPicture`]: points with colours, seen from a [`View`]; surfaces look closed, hide each other and are lit.
//! * [`Staircase`]: a cost that is constant on steps, with the samples of a search on it and the best point.
//! * [`QqPlot`]: how large errors are against how large they should be, for several kinds of them.
//! * [`colour`]: a colour for each plane, always the same.
//!
//! # Why this interface
//!
//! Points are added one by one, so that a picture of a billion points needs the memory of the picture, and a colour comes
//! with each point, so that the caller decides what it means. Charts draw on a [`Canvas`], which has two back-ends:
//! [`Svg`] for browsers and papers, [`Raster`] for PNG.
//!
//! ```
//! use terrace_draw::{Bounds, CloudPicture, Image, View, label_colour};
//! use terrace_types::PlaneId;
//!
//! let points = (0..10_000).map(|k| [f64::from(k % 100) / 50.0, f64::from(k / 100) / 50.0, 0.0]);
//! let bounds = Bounds::of(points.clone()).ok_or("no points")?;
//! let mut pictures = Vec::new();
//! for azimuth in [-60.0, 120.0] {
//!     let view = View::from_degrees(azimuth, 35.0)?.with_perspective_degrees(40.0)?;
//!     let mut picture = CloudPicture::new(400, 300, view, bounds)?;
//!     for point in points.clone() {
//!         picture.add(point, label_colour(PlaneId::new(1)));
//!     }
//!     pictures.push(picture.image());
//! }
//! let both = Image::beside(&pictures[0], &pictures[1])?;
//! assert_eq!((both.width(), both.height()), (800, 300));
//! let png: Vec<u8> = both.png()?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Accuracy
//!
//! A cloud is sampled at half a pixel; a point grows by up to a few pixels where points are sparse, so that borders of
//! sparse surfaces look wider by as much. Light is estimated from depth and smooths noise: it shows shape, it measures
//! nothing. Chart coordinates are written to a hundredth of a pixel. The same input gives the same bytes on one platform.
//!
//! # Errors and limits
//!
//! [`DrawError`] for pictures without extent or above [`MAX_SIDE`], views and bounds that are not numbers, and empty
//! chart ranges. Points and values that are not finite are passed over. Nothing panics. A cloud picture takes about 30
//! bytes for each pixel, and about 100 more while it is finished. The font of PNG texts has ASCII and a few signs; other
//! letters are drawn as a box. SVG texts name common fonts and leave the choice to the viewer.

mod axis;
mod canvas;
mod cloud;
mod error;
mod font;
mod image;
mod palette;
mod pen;
mod qq;
mod raster;
mod shade;
mod splat;
mod staircase;
mod svg;
mod view;

pub use canvas::{Anchor, Canvas};
pub use cloud::CloudPicture;
pub use error::{DrawError, MAX_SIDE};
pub use image::Image;
pub use palette::{UNLABELLED, colour, label_colour};
pub use qq::{QqPlot, QqSeries};
pub use raster::Raster;
pub use staircase::{Sample, Staircase, Step};
pub use svg::Svg;
pub use view::{Bounds, View};
