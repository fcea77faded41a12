//! Planes of 3D scans with the uncertainty of their orientation, from posed scans with point errors.
//!
//! Scans go in one at a time ([`Mapper::insert`]); planes come out whenever they are wanted ([`Mapper::extract`]). By default
//! they are regions:
//!
//! ```text
//! Scan -> grid of statistics -> regions grown over cells of half the edge -> a label per point
//!      -> for each plane the one of least variance, with its covariance
//! ```
//!
//! [`Params::clusters`] is the idea of "An Optimization Approach for 3D Environment Mapping using Normal Vector Uncertainty"
//! instead, and [`Params::paper`] follows that to the letter:
//!
//! ```text
//! Scan -> grid of statistics -> dense cells -> uncertain normals -> clusters at phi
//!      -> for each uncertain cluster, the phi of least cost -> planes, a label per cell
//! ```
//!
//! ```
//! use terrace::{Mapper, Params};
//! use terrace_types::{Frame, Scan, Sigma};
//!
//! // A floor and a wall that meet, sampled every 2 cm.
//! let mut points = Vec::new();
//! for i in 0..100 {
//!     for j in 0..100 {
//!         let (u, v) = (0.02 * f64::from(i) + 0.003, 0.02 * f64::from(j) + 0.003);
//!         points.push([u, v, 0.0]);
//!         points.push([0.0, u, v]);
//!     }
//! }
//! let scan = Scan::new(points, Sigma::Uniform(0.005), Frame::World { sensor: Some([1.0, 1.0, 1.0]) })?;
//!
//! let mut mapper = Mapper::new(Params::default())?;
//! mapper.insert(&scan)?;
//! let map = mapper.extract()?;
//! for plane in &map.planes[..2] {
//!     // Normals point to the sensor, which is one metre from both.
//!     assert!((plane.plane.signed_distance([1.0, 1.0, 1.0]) - 1.0).abs() < 0.05);
//!     // And their orientation is sure to a milliradian.
//!     assert!(plane.estimate.is_some_and(|estimate| estimate.largest_tilt() < 0.001));
//! }
//! assert_eq!(map.labels.len(), scan.len());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Scans larger than memory
//! [`Mapper::streaming`] makes a map that forgets points. Scans go in chunk by chunk ([`Mapper::insert_more`]); planes come out of
//! [`Mapper::extract_streamed`], and then the chunks are given once more for their labels ([`PointLabels`]). [`CellSizeSample`] chooses
//! the cell size from all of a scan in chunks.
//!
//! # Maps in parts
//! [`Mapper::merge`] makes one map of two. [`Mapper::parts`] takes a map apart, and [`MapBuilder`] puts it together again:
//! `terrace-checkpoint` saves maps so.
//!
//! # Units and frames
//! Metres and radians; planes are in the world frame of the poses.
//!
//! # The same bits
//! The same scans, parameters and seed give the same result to the last bit, on any number of threads.
//!
//! # Errors
//! Parameters are checked when the mapper is made ([`ParamsError`]). Points that are not finite are absent and have no
//! label; points too far away for the grid are counted and left out ([`Inserted`]). Nothing panics.

mod cell_sample;
mod cell_size;
mod close_up;
mod cost;
mod error;
mod estimate;
mod extract;
mod facing;
mod first;
mod mapper;
mod nearest;
mod nodes;
mod optimise;
mod packed;
mod params;
mod plane_map;
mod point_labels;
mod regions;
mod seen;
pub mod tune;
mod uncertain;
mod world;

pub use cell_sample::CellSizeSample;
pub use cell_size::{CellSizeChoice, choose_cell_size};
pub use cost::{Beta, BetaStep, CostForm, PhiCost};
pub use error::{ExtractError, InsertError, ParamsError, StreamingError};

pub use estimate::{CellPlane, NoiseKnot, NoiseLevel, PlaneEstimate, Sighting};
pub use extract::Stage;
pub use mapper::{Inserted, MapBuilder, MapCell, MapParts, Mapper, MergeError, PartsError, View};
pub use optimise::Optimised;
pub use params::{Estimate, Join, Optimise, Params, Regions, Search, Weighting};
pub use plane_map::{CellCounts, ExtractedPlane, Grown, LabelledCell, PlaneMap, Summary, Used};
pub use point_labels::PointLabels;
pub use uncertain::{UncertainCluster, UncertainClusters};

pub use terrace_cluster::{Interval, SeedOrder};
pub use terrace_crs::{Minimum, Source, StopReason, Trial};
pub use terrace_grid::{Assignment, CellId, Connectivity, GridError, VoxelKey};
pub use terrace_noise::{PoseNoise, PoseNoiseError};
pub use terrace_normals::FitTo;
pub use terrace_normals::{PlaneFit, UncertainNormal};
pub use terrace_regions::{SampleError, SampledPoint, Step as RegionStep};
pub use terrace_stats::{Moments, SymmetricMatrix3};
pub use terrace_types::{Frame, Plane, PlaneId, Pose, Scan, Sigma};

/// The examples of the README are tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
