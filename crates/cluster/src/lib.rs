//! Region growing over any graph of uncertain normals.
//!
//! Nodes carry a unit normal with a standard error per axis; edges say which nodes are neighbours. Neighbours whose
//! normals are alike end up in one cluster: a surface of one orientation. The nodes may be voxels, faces of a mesh,
//! supervoxels or pixels: no type of a grid appears here.
//!
//! Source: Definition 4 and section IV-A of "An Optimization Approach for 3D Environment Mapping using Normal Vector
//! Uncertainty". *Uncertain* clustering means that the likeness of normals is an **expected** distance, in which the
//! errors of both sides count ([`orientation_distance`]).
//!
//! ```
//! use terrace_cluster::{Params, segment};
//! use terrace_stats::UncertainVector;
//!
//! // A strip of six nodes that turns a corner: three face up, three face sideways.
//! let normal = |value| Some(UncertainVector::isotropic(value, 0.02));
//! let normals = [[0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 0.0, 0.0]]
//!     .map(normal);
//! let edges: [&[u32]; 6] = [&[1], &[0, 2], &[1, 3], &[2, 4], &[3, 5], &[4]];
//!
//! let result = segment(&normals, |node| edges[node], &Params { phi: 0.3, ..Params::default() })?;
//! assert_eq!(result.len(), 2);
//! assert_eq!(result.cluster(0).unwrap().nodes(), [0, 1, 2]);
//!
//! // The same decisions are taken for every φ of this interval, and so the same clusters found.
//! assert!(result.interval().contains(0.9) && !result.interval().contains(1.1));
//! # Ok::<(), terrace_cluster::ClusterError>(())
//! ```
//!
//! # The interval
//! A run is a list of decisions `D ≤ φ`. With `lo` the largest D accepted and `hi` the smallest rejected, every φ in
//! `[lo, hi)` decides the same way at every turn, so that its result is known without a run ([`Interval`]). The cost of
//! a segmentation as a function of φ is therefore a staircase, and one run gives the width of the step it stands on.
//!
//! [`Staircase`] goes from step to step: it repairs the clusters that change, which are mostly few, and gives up early
//! where a search has seen something better.
//!
//! # Errors and limits
//! Thresholds and normals that are not finite, and normals that are not of unit length, are refused ([`ClusterError`]); a
//! neighbour lookup that names a node beyond the slice has that neighbour ignored. Nothing panics. At most 2³² − 1 nodes.

mod candidates;
mod distance;
mod error;
mod grower;
mod growth;
mod interval;
mod marks;
mod repair;
mod segmentation;
mod staircase;
mod subgraph;
mod sums;

pub use candidates::SeedOrder;
pub use distance::orientation_distance;
pub use error::ClusterError;
pub use grower::{Grower, Params, segment};
pub use interval::Interval;
pub use segmentation::{Cluster, Segmentation};
pub use staircase::{Outcome, Stair, Staircase};
pub use subgraph::Subgraph;

/// The examples of the README are tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
