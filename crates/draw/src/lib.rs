//! Pictures without a window: labelled point clouds as PNG, staircase costs as SVG

mod axis;
mod canvas;
mod cloud;
mod error;
mod font;
mod image;
mod palette;
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
pub use raster::Raster;
pub use staircase::{Sample, Staircase, Step};
pub use svg::Svg;
pub use view::{Bounds, View};
