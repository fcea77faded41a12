//! Are the covariances of planes right? Monte-Carlo on known planes, and scan against scan on real ones.
//!
//! A covariance claims how large errors are. This crate makes the errors, counts them in units of what was claimed, and
//! hands them to `terrace_calibration`, which says whether they are as large as they should be.
//!
//! * [`Trials::run`]: many noisy copies of a [`KnownPlace`], the planes of each compared with the known ones.
//! * [`Reference`]: posed scans without truth. The planes of each scan alone are compared with those of all others.
//!
//! # Why this interface
//!
//! A trial runs what users run: points with errors into a [`Mapper`](terrace::Mapper), planes out. Nothing of the truth
//! helps it, so that the errors of finding the plane are in the result as well as those of fitting it. What the mapper is
//! told may differ from what is true ([`Trials::told`], [`Trials::pose_told`]): so it can be seen what a wrong claim costs.
//! Scans against each other are read one at a time ([`Reference::look`]), since real sequences do not fit memory.
//!
//! ```
//! use std::num::NonZeroU32;
//! use terrace_synth::Scene;
//! use terrace_trials::{KnownPlace, Trials};
//!
//! let place = KnownPlace::Built { scene: Box::new(Scene::strip()), points: Some(4_000) };
//! let trials = Trials { copies: NonZeroU32::MIN.saturating_add(4), cells: false, ..Trials::default() };
//! let outcome = trials.run(&place, || {})?;
//! assert_eq!(outcome.planes.count() + outcome.mixed.count() + outcome.without, 5);
//! # Ok::<(), terrace_trials::TrialError>(())
//! ```
//!
//! # Definitions
//!
//! **Error of a plane** ([`Deviation`]): its two tilts in radians and its offset in metres against the true plane, in the
//! parameters and at the place of its covariance; squared, `eᵀ C⁻¹ e`, a χ² variable with 3 degrees of freedom where `C` is
//! right.
//!
//! **Known planes.** A plane that was found is taken for the known plane that at least [`MAJORITY`] of its points are of.
//! Those with at least [`PURE`] of their points on it are [`Outcome::planes`], and [`Outcome::by_plane`] each by itself. The
//! others are [`Outcome::mixed`]: a part of their error is that points of something else were taken in, which no covariance
//! of points can tell. They are counted apart so that one can see both, and not left out. Planes of no known one
//! ([`Outcome::unmatched`]) and without a covariance ([`Outcome::without`]) are numbers only.
//!
//! **Cells** ([`Outcome::cells`]): the planes of cells around which there is one known plane only, so far apart that no two
//! rest on the same point.
//!
//! **Min-max** ([`Outcome::plane_bounds`]): the share of components of normals that are off by more than the bound stated.
//!
//! **Scan against scan.** All scans together give a map; a plane of a single scan is taken for the plane of that map which
//! at least [`MAJORITY`] of its labelled points are of, for each the one with most points. Its parameters are
//! `θ = (e₁ᵀn, e₂ᵀn, −nᵀ(x₀ − c))`, for a plane with normal `n` through `c`: tilts along two axes of the map's plane and the
//! height over its centroid `x₀`, with `J C Jᵀ`. A scan that sees another part of the plane is sure of its height there only
//! as far as its tilts are, and so is the covariance. Squared distances do not depend on the choice of axes and centroid. The
//! residual of a scan is against the mean of the others weighted by `C⁻¹`, with the sum of both covariances
//! ([`Residual`]); [`Scatter`] is the sum of squared distances from the mean of all. [`Ratio`] is the root of squared errors
//! over their expectation: how many times as large as predicted errors are.
//!
//! # What a result does not say
//!
//! * Residuals of one plane share the mean of the others and are **not independent**: for them bands of NEES are too narrow.
//!   That of [`Scatter`] is right.
//! * Scan against scan does not see what all scans have in common, such as a scale that is wrong, and counts as an error of
//!   planes what is one of poses, unless poses come with theirs. With errors of poses, planes of one scan share them.
//! * Which planes are compared depends a little on their errors: a plane so wrong that it shares no points with the true one
//!   is [unmatched](Outcome::unmatched).
//! * To first order: tilts of more than some 10° are not small.
//!
//! # Accuracy
//!
//! With `n` errors of 3 parameters, NEES is known to `√(2/3n)`: to 5 % from 270 errors on. The same seed gives the same
//! result to the last bit, on any number of threads.
//!
//! # Errors and limits
//!
//! [`TrialError`] says which part refused what. Copies are made as many at a time as there are threads, each in memory as a
//! whole. A [`Reference`] holds a label for each point of all scans. Nothing panics.

mod against;
mod deviation;
mod error;
mod interior;
mod known;
mod monte_carlo;

pub use against::{
    Agreement, Look, PlaneAgreement, Ratio, Reference, Residual, Scatter, Sighting, TURNED,
    scans_against_each_other,
};
pub use deviation::Deviation;
pub use error::TrialError;
pub use known::{KnownPlace, KnownPlane, PointNoise};
pub use monte_carlo::{MAJORITY, Outcome, PURE, Trials};

/// The examples of the README are tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
