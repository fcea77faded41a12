//! Planar regions grown over cells of sums, at several resolutions, with the errors of points taken into account.
//!
//! In: cells of a cubic lattice with the additive statistics of their points, and the points. Out: planes, and for each point
//! the plane it is of. Every threshold is in standard errors, or follows from the points; nothing has to be tuned.
//!
//! ```text
//! cells -> planes around them at four resolutions -> seeds, the surest first
//!       -> regions grown with refit, over what errors and bends allow
//!       -> labels of points by probability -> parts, areas, bends -> planes
//! ```
//!
//! ```
//! use terrace_regions::{Cell, Points, Settings, segment};
//! use terrace_stats::{Stats, UncertainVector};
//!
//! // A floor of 1 × 1 m: ten by ten cells, each with 25 points that are known to 2 cm.
//! let (edge, sigma) = (0.1, 0.02);
//! let (mut cells, mut cell_of, mut places) = (Vec::new(), Vec::new(), Vec::new());
//! for cell in 0..100 {
//!     let key = [cell % 10, cell / 10, 0];
//!     let anchor = key.map(|k| (f64::from(k) + 0.5) * edge);
//!     let mut stats = Stats::new(anchor);
//!     for point in 0..25_u8 {
//!         let place = [f32::from(point % 5) * 0.02 - 0.04, f32::from(point / 5) * 0.02 - 0.04, 0.01];
//!         let measured = [0, 1, 2].map(|i| anchor[i] + f64::from(place[i]));
//!         stats.push(&UncertainVector::isotropic(measured, sigma));
//!         cell_of.push(u32::try_from(cell).ok());
//!         places.push(place);
//!     }
//!     cells.push(Cell { key, is_wide: false, stats });
//! }
//!
//! let found = segment(&cells, edge, Points { cells: &cell_of, places: &places }, &Settings::default())?;
//! assert_eq!(found.regions.len(), 1);
//! assert!(found.labels.iter().all(|label| *label == Some(0)));
//! let floor = &found.regions[0];
//! assert!((floor.normal[2].abs() - 1.0).abs() < 1e-9 && (floor.area - 1.0).abs() < 1e-6);
//! # Ok::<(), terrace_regions::RegionsError>(())
//! ```
//!
//! # Units and frames
//! Metres, square metres and radians, in any Cartesian frame. Keys are places in a lattice of cubes, of which groups of
//! 2 × 2 × 2 and 4 × 4 × 4 are made by halving keys: a lattice moved by four cells gives the same labels, one moved by less
//! may begin elsewhere. Sums are relative to an anchor in or near their cell, and places of points to the anchor of their
//! cell, so that single precision is enough for them at any distance from the origin. Normals have unit length, and their
//! sign means nothing.
//!
//! # Errors of points
//! Errors of points come with the sums, as covariances. They are taken for no smaller than a tenth of an edge. While planes
//! are as flat as that says, it is trusted; when most scatter by more, regions are grown again with larger ones, and
//! [`Segmentation::noise_scale`] says with how much larger. Standard errors of planes are those of independent errors of
//! points.
//!
//! # The same bits
//! The same cells and points in the same order give the same bits on any number of threads. In another order sums are
//! rounded otherwise: normals then differ in their last digits, and a point half-way between two planes could change sides.
//!
//! # Why this interface
//! * Sums and not points decide where planes are. A map that keeps sums of its cells anyway does nothing twice, and a cell
//!   of a thousand points costs what a cell of ten costs.
//! * Points are borrowed as two slices, the cell and the place of each: as a map of cells has them. Points of no cell are
//!   `None`, and so are labels of points of no plane, so that both have the length of the points.
//! * [`Segmentation::shares`] say how many points of each cell are of which plane, for those who go on with cells.
//! * [`Settings`] need nothing of the sensor: that is in the errors of the points.
//!
//! # Absence, errors and panics
//! No cells, points in one place, on a line, or all over: no regions, and no error. [`RegionsError`] names the first cell,
//! point or setting that contradicts the others. Nothing panics. At most 2³² − 1 cells and points.

mod again;
mod anchored;
mod around;
mod bend;
mod cell;
mod cube;
mod curve;
mod ends;
mod error;
mod exact;
mod field;
mod flat;
mod grow;
mod labeller;
mod labels;
mod level;
mod mixture;
mod near;
mod of_cells;
mod parts;
mod places;
mod recount;
mod samples;
#[cfg(test)]
mod scene;
mod seeds;
mod segment;
mod settings;
mod shared;
mod shares;
mod slice;
mod sum;
mod surface;
mod turned;
mod weighed;

pub use bend::{Bend, Column};
pub use cell::{Cell, Cells};
pub use curve::Order;
pub use error::{RegionsError, SampleError};
pub use field::Field;
pub use labeller::{Labeller, Measure, Tally};
pub use labels::Points;
pub use samples::{PartOf, Sample, SampledPoint, Samples, Together};
pub use segment::{Found, Grown, Region, Segmentation, find, segment};
pub use settings::{Settings, Step};
pub use shared::SharedNoise;
pub use shares::Share;

/// The examples of the README are tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
