//! What the terrace crates hand to each other: [`Scan`]s of points with their standard errors ([`Sigma`]),
//! sensor [`Pose`]s, [`Plane`]s and labels ([`PlaneId`]). Plain data with a validated border and no algorithm,
//! as `geo-types` is to `geo`.
//!
//! **Units.** Metres throughout; standard errors in metres; rotations are matrices, so no angle unit arises.
//!
//! **Frames.** A scan says in which frame its points are ([`Frame`]). A pose takes sensor coordinates to world
//! coordinates: `world = R · sensor + t`.
//!
//! **Absent measurements.** An organised scan (a depth image) keeps a place for every pixel. A place without a
//! measurement holds NaN coordinates; [`Scan::world_points`] yields `None` there, so that labels can be given for
//! every input point in order.
//!
//! **Errors and panics.** What cannot be meant is refused where it enters, with the offending value in the error; what
//! is let in needs no second check. Nothing panics.
//!
//! ```
//! use terrace_types::{Frame, Pose, Scan, Sigma};
//!
//! let pose = Pose::from_quaternion([0.0, 0.0, 1.5], [0.0, 0.0, 0.0, 1.0])?;
//! let scan = Scan::new(vec![[1.0, 0.0, 0.0], [f64::NAN; 3]], Sigma::Uniform(0.01), Frame::Sensor { pose })?;
//! let world: Vec<_> = scan.world_points().map(|p| p.map(|p| p.position)).collect();
//! assert_eq!(world, [Some([1.0, 0.0, 1.5]), None]);
//! assert_eq!(scan.sensor_position(), Some([0.0, 0.0, 1.5]));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod label;
mod plane;
mod pose;
mod scan;
mod sigma;
mod vector;

pub use label::PlaneId;
pub use plane::{Plane, PlaneError};
pub use pose::{MAX_ROTATION_DEVIATION, Pose, PoseError};
pub use scan::{Frame, Scan, ScanError, WorldPoint};
pub use sigma::{Sigma, SigmaError};

/// The examples of the README are tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
