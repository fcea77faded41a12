//! Planar regions grown over cells of sums, at several resolutions, with the errors of points taken into account.
//!
//! In: cells of a cubic lattice with the additive statistics of their points, and the points. Out: planes, and for each point
//! the plane it is of. Every threshold is in standard errors, or follows from the points; nothing has to be tuned.
//!
//! ```text
//! cells -> planes around them at three resolutions -> seeds, the surest first
//!       -> regions grown with refit -> neighbours that are one plane joined
//!       -> labels of points by probability -> parts, areas, bends -> planes
//! ```

mod bend;
mod cell;
mod ends;
mod error;
mod field;
mod flat;
mod grow;
mod join;
mod labels;
mod level;
mod parts;
#[cfg(test)]
mod scene;
mod segment;
mod settings;
mod surface;

pub use bend::Bend;
pub use cell::Cell;
pub use error::RegionsError;
pub use field::sums_around;
pub use labels::Points;
pub use segment::{Region, Segmentation, Share, segment};
pub use settings::Settings;

/// The examples of the README are tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
