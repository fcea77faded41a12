//! Least-squares planes of uncertain points, with the uncertainty of their normals.
//!
//! * [`fit_plane`] and [`fit_centres`]: the plane of least squares through summed statistics, or through the centres of
//!   cells.
//! * [`estimate`]: the normal of a neighbourhood of cells *and* how far it may turn (Definition 3 of "An Optimization
//!   Approach for 3D Environment Mapping using Normal Vector Uncertainty"): the min-max uncertainty.
//! * [`CovariantPlane`]: the plane of cells whose points have known errors, with the first-order covariance of its tilt and
//!   offset, and of its coefficients.
//! * [`symmetric_eigen`] and [`symmetric_eigen_batch`]: eigenvalues and eigenvectors of symmetric 3×3 matrices by
//!   Jacobi rotations, the solver under all of it.
//! * [`EigenvalueBounds`]: certified bounds of the eigenvalues of a covariance, for a fraction of the solver's time.
//! * [`towards`] turns a normal to the sensor, [`canonical`] to a fixed side.
//!
//! ```
//! use terrace_normals::{Degenerate, FitTo, estimate};
//! use terrace_stats::{Stats, UncertainVector};
//!
//! // Nine cells of a table top at z = 0.7 m, one point each, known to 1 cm.
//! let cells: Vec<Stats> = (0..9)
//!     .map(|i| {
//!         let centre = [0.1 * f64::from(i % 3), 0.1 * f64::from(i / 3), 0.7];
//!         let mut cell = Stats::new(centre);
//!         cell.push(&UncertainVector::isotropic(centre, 0.01));
//!         cell
//!     })
//!     .collect();
//! let normal = estimate(&cells, FitTo::Centres)?;
//! assert!((normal.fit.normal[2].abs() - 1.0).abs() < 1e-12);
//! // Errors of 1 cm on both edges, 20 cm apart, can turn it by about 0.1.
//! assert!((0.05..0.2).contains(&normal.uncertainty[0]));
//!
//! // Cells in a row have no normal, and the reason is given.
//! assert!(matches!(estimate(&cells[..3], FitTo::Centres), Err(Degenerate::Collinear { .. })));
//! # Ok::<(), terrace_normals::Degenerate>(())
//! ```
//!
//! # Why this interface
//! * [`estimate`] takes any iterator over statistics that can be walked again, so that a neighbourhood is named by
//!   references into a map and nothing is copied or allocated. Where all cells of a map are asked for, a [`Summary`] of each, made once, is
//!   faster, for each is of many neighbourhoods.
//! * The uncertainty is per component of the normal, as the paper has it. The perturbations are chosen for each component
//!   and not along the eigenvectors of the plane: where a patch is as long as wide those are a matter of rounding, and
//!   with them the uncertainty would be, by a third.
//!
//! # Accuracy
//! Fits are relative to a local anchor, so their accuracy does not depend on the distance from the origin, but for the
//! rounding of the coordinates themselves. The eigen-solver is accurate to a few units in the last place of the largest
//! eigenvalue, its vectors to a few roundings of 1. The uncertainty is exact to first order in the errors.
//!
//! # Absence and panics
//! A neighbourhood that determines no plane gives [`Degenerate`] with the reason, never an invented normal. Nothing
//! panics; input that is not finite is [`Degenerate::NotFinite`].

mod arrow;
mod bounds;
mod covariant;
mod degenerate;
mod eigen;
mod fit;
mod minmax;
mod orient;
mod summary;

pub use bounds::EigenvalueBounds;
pub use covariant::CovariantPlane;
pub use degenerate::Degenerate;
pub use eigen::{Eigen3, symmetric_eigen, symmetric_eigen_batch};
pub use fit::{PlaneFit, fit_centres, fit_plane, fit_planes};
pub use minmax::{FitTo, UncertainNormal, estimate};
pub use orient::{canonical, towards};
pub use summary::{Summarised, Summary};

/// The examples of the README are tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
