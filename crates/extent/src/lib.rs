//! How far planes reach: boundary polygons with holes, their areas, and one coloured mesh of all as PLY, OBJ or GLB.
//!
//! A plane finder answers infinite planes. What people measure, print and show has borders: a wall with its door opening,
//! a table top of 1.6 m². This crate takes the points of a plane, one after the other, and says where it is.
//!
//! ```
//! use terrace_extent::{Footprint, Mesh, OutlineOptions, PlaneExtent, PlaneFrame, suggested_resolution};
//! use terrace_types::Plane;
//!
//! // A wall of 4 × 2.5 m with an opening of 1 × 1 m, points 2 cm apart.
//! let (wall, spacing) = (Plane::through([0.0, 3.0, 0.0], [0.0, -1.0, 0.0])?, 0.02);
//! let frame = PlaneFrame::new(&wall, [0.0, 3.0, 0.0])?;
//! let mut footprint = Footprint::new(frame, suggested_resolution(spacing))?;
//! for i in 0..200 {
//!     for j in 0..125 {
//!         if !((100..150).contains(&i) && (50..100).contains(&j)) {
//!             footprint.add([f64::from(i) * spacing, 3.001, f64::from(j) * spacing])?;
//!         }
//!     }
//! }
//!
//! let extent = PlaneExtent::of(&footprint, &OutlineOptions::for_spacing(spacing))?;
//! assert_eq!((extent.polygons().len(), extent.polygons()[0].holes().len()), (1, 1));
//! assert!((extent.area() - 9.0).abs() < 0.2);
//! println!("{}", serde_json::to_string(&extent)?);
//!
//! let mut mesh = Mesh::new();
//! mesh.add(&extent, [200, 80, 40])?;
//! let mut file = Vec::new();
//! mesh.write_glb(&mut file)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # How
//! 1. [`PlaneFrame`] puts two axes on the plane, always the same.
//! 2. [`Footprint`] counts points on square pixels of the plane and forgets the points. Pixels without points cost
//!    nothing; when there are too many, they become twice as large.
//! 3. [`Footprint::outline`] closes gaps (a morphological closing with a disc), takes border pixels away that are less
//!    than half full, joins what is left to polygons, and makes their borders straight: points of a border are kept where
//!    it turns by more than a pixel, and moved to where the lines through the points between them meet, so that corners
//!    are sharp and borders lie neither in nor out. What crosses itself then is resolved on whole numbers.
//! 4. [`Mesh`] cuts polygons of many planes into triangles. Their area is checked against that of the polygon.
//!
//! Unions are those of `i_overlay`, triangles those of `earcut`.
//!
//! # Definitions
//! * **Extent**: where there are points of the plane, with gaps up to a stated width closed. Behind furniture there are
//!   none: a wall ends at the cupboard before it, and a hole may be an opening or something that hides the wall.
//! * **Area** ([`Polygon::area`]): by the shoelace formula, without holes, in square metres.
//! * **Spacing**: the square root of the area for each point.
//!
//! # Accuracy
//! Rectangles, L-shapes, discs and plates with round holes, points on a grid or at random, eight turns: with pixels of
//! one and a half spacings borders lie 0.15 to 0.25 pixels outside, with two spacings up to 0.2, with smaller pixels up to
//! half a spacing inside. A rectangle of 4 × 2.5 m has its area to 0.5 % with points every centimetre, to 3.5 % with
//! points every 5 cm. The example `accuracy` prints the table. Corners that turn inwards are rounded by half the gap, and
//! what is narrower than a pixel is not seen. Points that scatter along the border blur it; where they are dense it comes
//! out half-way.
//!
//! Coordinates are taken from the origin of the frame, and those of GLB from the middle of the mesh: at 5 000 km they lose
//! nothing. The same points give the same bytes, in any order.
//!
//! # Errors and limits
//! [`ExtentError`] holds the value that was refused. A footprint holds up to [`MOST_PIXELS`], gaps are up to 128 pixels
//! wide, points at most 2²⁸ pixels from the origin of the frame. Nothing panics. Time and memory go with the number of
//! pixels and, for triangles, with the square of the number of holes: thousands of holes in one polygon are noise that a
//! wider gap or [`OutlineOptions::min_hole_area`] takes away.

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
