//! Are predicted covariances right? Errors measured in their own standard deviations: NEES, coverage, Q-Q plots.
//!
//! An estimate that comes with a covariance claims how large its errors are. Where the truth is known, the claim can be
//! tested: each error `e` with predicted covariance `C` becomes one number, the squared Mahalanobis distance `eᵀ C⁻¹ e`
//! ([`squared_mahalanobis`]), and a [`Calibration`] tells whether these numbers are as large as they should be.
//!
//! ```
//! use terrace_calibration::{Calibration, squared_mahalanobis, table};
//!
//! // Tilts in radians and an offset in metres: errors of planes with the covariance that was predicted for each.
//! let planes = [
//!     ([1e-4, -2e-4, 0.001], [[1e-8, 0.0, 0.0], [0.0, 4e-8, 0.0], [0.0, 0.0, 1e-6]]),
//!     ([5e-5, 1e-4, -0.002], [[1e-8, 2e-9, 0.0], [2e-9, 4e-8, 0.0], [0.0, 0.0, 1e-6]]),
//! ];
//! let mut found = Calibration::new(3)?;
//! for (error, covariance) in planes {
//!     match squared_mahalanobis(error, covariance) {
//!         Some(nees) => found.push(nees)?,
//!         None => found.refuse(),
//!     }
//! }
//! assert_eq!(found.count(), 2);
//! let (nees, [low, high]) = (found.nees().unwrap(), found.nees_band(0.95).unwrap());
//! assert!(low < nees && nees < high, "nothing speaks against the covariances");
//! print!("{}", table(&[("planes", &found)]));
//! # Ok::<(), terrace_calibration::CalibrationError>(())
//! ```
//!
//! # Definitions
//! With `D` coordinates in each error and `n` errors:
//!
//! * **NEES per degree of freedom** ([`Calibration::nees`]), the normalised estimation error squared: the mean of
//!   `eᵀ C⁻¹ e` over `D`. On average 1 when covariances are right, whatever the distribution of the errors. Above 1 the
//!   estimates are *overconfident*: 4 means that standard deviations are too small by a factor of 2. Below 1 they are
//!   *underconfident*.
//! * **Band** ([`Calibration::nees_band`]): where NEES falls with a given probability if all is right; χ² quantiles.
//! * **Coverage** at a level p ([`Calibration::coverage`]): the share of errors within the ellipsoid that is to hold them
//!   with probability p. Its uncertainty is Wilson's interval ([`Share::interval`]).
//! * **Q-Q points** ([`Calibration::quantiles`]): each Mahalanobis distance against the one expected at its rank.
//! * **Median ratio** ([`Calibration::median_ratio`]): as NEES, but by medians; outliers do not move it.
//!
//! A wrong scale moves NEES and the median ratio alike and tilts the line of the Q-Q plot; outliers move NEES and leave
//! the median. NEES alone cannot tell the two apart, nor see that covariances too large here make up for those too small
//! there: the Q-Q plot and coverage can.
//!
//! # What is assumed
//! The band, the p-value of Kolmogorov and Smirnov, Wilson's interval and [`Calibration::nees_interval`] assume values
//! that are **independent**. Errors of planes from one simulated copy of a scan are, as long as the planes share none of
//! their points and the noise has no part common to several points. Not independent are planes that overlap, errors of
//! the sensor's pose that move all planes at once, and several estimates from the same noise, such as two methods or two
//! sets of parameters on one copy: count these apart. With dependent values the true bands are wider than told.
//!
//! Band and coverage assume Gaussian errors too; where an estimate is a linearised one, large errors are not. And which
//! errors are counted must not depend on the errors: to keep only planes that were matched to a true one leaves out the
//! worst, and NEES comes out too small.
//!
//! # Accuracy
//! Distributions are those of `statrs`, quantiles are solved on them. Against 40-digit arithmetic,
//! [`chi_squared_quantile`] is right to 1e-12 of its value for 1 to 6000 degrees of freedom and probabilities from 1e-6
//! to 1 − 1e-5. From 10⁷ degrees of freedom on, both functions use the cube root of Wilson and Hilferty.
//! [`squared_mahalanobis`] works on correlations, so that units and scales do not matter. The mean may differ in its last
//! digits with the order of the values; nothing else does, but for [`Calibration::nees_interval`].
//!
//! # Errors and absence
//! Values that are no squared Mahalanobis distances, and collections that do not belong together, are a
//! [`CalibrationError`]. What has no value is `None`: a mean of nothing, a quantile at a level that is no probability.
//! Nothing panics.

mod calibration;
mod chi_squared;
mod error;
mod mahalanobis;
mod quantiles;
mod share;
mod table;

pub use calibration::{Calibration, LEVELS};
pub use chi_squared::{chi_squared_cdf, chi_squared_quantile};
pub use error::CalibrationError;
pub use mahalanobis::squared_mahalanobis;
pub use quantiles::KolmogorovSmirnov;
pub use share::{Exceedance, Share};
pub use table::{Summary, table};

/// The examples of the README are tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
