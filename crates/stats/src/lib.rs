//! Additive statistics of uncertain 3-vectors.
//!
//! An *uncertain vector* is a value with a standard error along each axis: a measured point, or an estimated normal. An
//! error may also have any covariance ([`Stats::push_covariant`]).
//! What a set of them has to say (how many, where their mean is, how they scatter, how sure the mean is) follows from
//! a handful of sums. Sums add: the statistics of a union are the sum of the statistics, so that scans can be
//! inserted one at a time, cells merged into any region, and maps built in parts on several machines, without keeping
//! a single point.
//!
//! Source: Definition 1 and Lemma 3.1 of "An Optimization Approach for 3D Environment Mapping using Normal Vector
//! Uncertainty". Beyond the paper we keep the full second moment (six values instead of three), because the
//! least-squares plane of any union then follows from sums alone, and optional weights.
//!
//! * [`UncertainVector`]: a value and its standard errors.
//! * [`Moments`]: the sums, about the origin of whatever coordinates they were given in. 136 bytes.
//! * [`Stats`]: moments together with the *anchor* they are relative to. This is the type to use; `Moments` is for
//!   those who know the anchor already, such as a grid whose cells are their own anchors.
//! * [`SymmetricMatrix3`]: a covariance or second moment.
//!
//! # Why an anchor
//! `Σp²/n − (Σp/n)²` subtracts two nearly equal numbers when the points are far from the origin, and what is left is
//! rounding. Relative to an anchor near the points nothing is lost. Moments merge across anchors exactly, up to
//! rounding of the offsets between the anchors.
//!
//! ```
//! use terrace_stats::{Stats, UncertainVector};
//!
//! // Two points 2 cm apart, at UTM-like coordinates, each known to 1 cm.
//! let at = [500_000.0, 5_000_000.0, 100.0];
//! let mut cell = Stats::new(at);
//! for dx in [-0.01, 0.01] {
//!     cell.push(&UncertainVector::isotropic([at[0] + dx, at[1], at[2]], 0.01));
//! }
//! let variance_x = cell.covariance().unwrap().get(0, 0);
//! assert!((variance_x - 1e-4).abs() < 1e-10);
//!
//! // Another cell with another anchor: the union is the sum.
//! let mut other = Stats::new([at[0] + 1.0, at[1], at[2]]);
//! other.push(&UncertainVector::isotropic([at[0] + 1.0, at[1], at[2]], 0.02));
//! cell.merge(&other);
//! assert_eq!(cell.count(), 3);
//! ```
//!
//! # Weights
//! [`Stats::push`] gives every vector the weight 1, as the paper does. [`Stats::push_weighted`] takes any positive
//! weight; with `w = 1/σ²` the mean is the one of least variance and `1/Σw` is that variance.
//!
//! # Absence, errors, limits
//! A set without weight has no mean and no covariance: those are `None`. Nothing here panics, except that
//! [`SymmetricMatrix3::get`] needs a row and column that exist. Values are not checked: a NaN that is pushed makes
//! every later answer about its axis NaN, and a NaN weight leaves the set without weight; check at the border
//! ([`UncertainVector::is_finite`]). Counts saturate at 2⁶⁴ − 1.

mod matrix;
mod moments;
mod stats;
mod vector;

pub use matrix::SymmetricMatrix3;
pub use moments::Moments;
pub use stats::Stats;
pub use vector::UncertainVector;

/// The examples of the README are tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
