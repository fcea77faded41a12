//! How well one labeling of points agrees with another: the planes that were found against the true ones.
//!
//! A label is `Option<PlaneId>`: the plane a point belongs to, or none. Everything follows from how many points each
//! pair of a true and a found plane shares, which a [`Contingency`] counts once.
//!
//! ```
//! use terrace_eval::Contingency;
//! use terrace_types::PlaneId;
//!
//! let labels = |numbers: &[u32]| numbers.iter().map(|n| PlaneId::new(*n)).collect::<Vec<_>>();
//! // Two true planes; of the first, one of four points was missed.
//! let truth = labels(&[1, 1, 1, 1, 2, 2, 0]);
//! let found = labels(&[7, 7, 7, 0, 3, 3, 0]);
//!
//! let both = Contingency::new(&truth, &found)?;
//! assert_eq!(both.iou(truth[0].unwrap(), found[0].unwrap()), Some(0.75));
//! assert_eq!(both.weighted_cover(), Some((4.0 * 0.75 + 2.0 * 1.0) / 6.0));
//! let matches = both.matches(0.8)?;
//! assert_eq!((matches.precision(), matches.recall(), matches.f1()), (Some(0.5), Some(0.5), Some(0.5)));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Definitions
//! With `p` and `t` the sets of points of a found and of a true plane:
//!
//! * **IoU**, intersection over union: `|p ∩ t| / |p ∪ t|`. Points of no true plane that `p` claims are in the union.
//! * **Weighted cover**: `Σ |t| max IoU(p, t) / Σ |t|` over the true planes, the maximum over the found ones; 0 for a true
//!   plane that no found one touches.
//! * **Match at T**: a pair with IoU *above* T. From T = ½ on it is one to one without further choice.
//! * **Precision, recall, F1**: the matches over the found planes, over the true ones, and the harmonic mean of the two.
//! * **Cover**: the mean of the best IoU of each true plane, without weights.
//! * **Dice**: `2 |p ∩ t| / (|p| + |t|)`.
//! * **Mean IoU, mean Dice**: over the pairs that match at ½; mean IoU over all true planes counts 0 for one without match.
//! * **SegComp** (Hoover and others, 1996) at a share S, customarily 0.8. A pair is *correct* when each holds S of the other's
//!   points. Of the rest, a true plane is *over*-segmented by two or more found planes that lie in it by S of their points
//!   each and together hold S of its points; a found plane *under*-segments two or more true planes likewise. True planes
//!   that are none of these are *missed*, found ones *noise*.
//! * **Point accuracy**: the share of the points of true planes that lie in the found plane which matches theirs at ½.
//! * **Non-planar claimed**: the share of the points of no true plane that lie in a found one.
//! * **Angle, offset** of matched planes: between the normals without regard to sign, in radians; and from the centre of
//!   the found plane's points, taken onto the found plane, to the true plane, in metres.
//!
//! [`Evaluation`] holds all of them; [`PlaneDeviation`] the last.
//!
//! Numbers of planes are names only: renumbering either side changes nothing.
//!
//! # Points to leave out
//! Points whose truth is not known are left out by leaving them out of both labelings; [`Contingency::of_numbers`] does so
//! for labels from files, where they have a true label below 0.
//!
//! # Errors and absence
//! Labelings of different length and a threshold at which matches are not one to one are an [`EvalError`] with the
//! numbers. What has no value is `None`: a cover without true planes, a precision without found ones, a mean over no
//! pairs. Nothing panics.

mod contingency;
mod error;
mod evaluation;
mod geometry;
mod matches;
mod measure;
mod segcomp;

pub use contingency::Contingency;
pub use error::EvalError;
pub use evaluation::{Evaluation, TruePlaneScore};
pub use geometry::{PlaneAt, PlaneDeviation, Spread};
pub use matches::Matches;
pub use measure::Measure;
pub use segcomp::SegComp;

/// The examples of the README are tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
