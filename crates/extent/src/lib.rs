//! How far planes reach: boundary polygons with holes, their areas, and meshes of them.

mod coverage;
mod error;
mod footprint;
mod frame;
mod glb;
mod json;
mod mesh;
mod obj;
mod outline;
mod ply;
mod polygon;
mod ring;
mod runs;

pub use error::ExtentError;
pub use footprint::{DEFAULT_MAX_PIXELS, Footprint, MOST_PIXELS, suggested_gap, suggested_resolution};
pub use frame::PlaneFrame;
pub use json::PlaneExtent;
pub use mesh::Mesh;
pub use outline::OutlineOptions;
pub use polygon::Polygon;

/// The examples of the README are tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
