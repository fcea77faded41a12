//! Noise models of range sensors: the covariance of a measured point, from where the sensor stood and where the point
//! is.
//!
//! A depth camera is sure of the direction of a point and unsure of its distance, ever more so the farther away it
//! is; a lidar is the other way round on long ranges. One number for all points and directions hides both. Here a
//! model of the sensor gives each point its 3×3 [`Covariance`]:
//!
//! ```
//! use terrace_noise::{ScanNoise, SensorNoise};
//!
//! let noise: SensorNoise = "kinect".parse()?;
//! let scan = ScanNoise::new(noise, Some([0.0; 3]))?.with_axis([0.0, 0.0, 1.0])?;
//! // Twice the depth, and the error along the ray grows fourfold.
//! let sigma = |z: f64| scan.covariance([0.0, 0.0, z]).map(|c| c.deviations()[2]);
//! assert!((sigma(1.5).unwrap() - 0.003499).abs() < 1e-12);
//! assert!((sigma(3.0).unwrap() - 0.014044).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! * [`SensorNoise`]: one of the models below, and the texts that name it.
//! * [`Sight`]: how the sensor saw a point: ray and range, and when known optical axis and incidence angle.
//! * [`ScanNoise`]: a model for all points of a scan, one after the other.
//! * [`CommonNoise`], [`PoseNoise`], [`jacobian`]: errors that all points of a scan share; [`PoseSigma`], a pose's as
//!   text.
//!
//! # The models
//!
//! | Model | Standard deviation along the ray | Across | Made for |
//! | --- | --- | --- | --- |
//! | [`Uniform`] | σ | σ | as measured |
//! | [`PerAxis`] | σ_x, σ_y, σ_z of the world | | as measured |
//! | [`Kinect`] | 0.0012 + 0.0019 (z − 0.4)² + (0.0001/√z) θ²/(π/2 − θ)² | (0.8 + 0.035 θ/(π/2 − θ)) z/f | 0.4 to 5 m |
//! | [`Stereo`] | z² σ_d/(f b) | σ_px z/f | z σ_d/(f b) ≤ 0.1 |
//! | [`Lidar`] | a + b r | r σ_α | σ_α of some 0.01 rad at most |
//!
//! Source, validity, and what happens outside it stand at each type; [`SensorNoise::valid_depths`] tells the depths.
//!
//! # Why this interface
//!
//! * **A covariance, not a σ.** A wall seen at a slant takes its error from the ray and from across it; what counts
//!   is the variance along its normal, [`Covariance::along`].
//! * **Depth is not range.** A depth camera measures along its optical axis and a place in the image. Off the middle,
//!   an error of depth moves a point along its slanted ray, and farther than the error itself; an error in the image
//!   moves it perpendicular to the axis, not to the ray. With the axis given ([`Sight::with_axis`]) both are right.
//!   Without it the ray is taken as the axis and the straight distance as the depth, which in a corner of a Kinect's
//!   image is 20 % too much.
//! * **What is shared is apart.** The errors of the sensor are independent from point to point and average out; those
//!   of its pose are common to a scan and do not. Adding both up per point makes planes of many points look too good.
//!   So [`PoseNoise`] gives a [`jacobian`], to propagate once per scan.
//! * **Plain arrays**, so that any geometry library fits.
//!
//! # Accuracy
//!
//! Covariances are first order: exact for small errors. In the tests, simulated beams, disparities and poses agree
//! with them to within 2 % of each standard deviation; where stereo ends to be valid they are 4 % too small. They are
//! positive semidefinite up to rounding, and turn with sensor and point. How well a model fits *your* sensor is
//! another matter: measure a flat wall.
//!
//! # Errors
//!
//! Parameters are checked by the constructors ([`ParameterError`], [`PoseNoiseError`], [`ScanNoiseError`]) and texts
//! by the parser ([`ParseNoiseError`]); each error names the parameter and its value. A point without a covariance
//! (at the sensor, not finite, behind a camera, on a surface seen from its edge) has `None`. Of checked parameters no
//! answer holds NaN, and nothing panics.
//!
//! # Limitations
//!
//! No outliers: flying pixels, wrong matches, reflections. No correlation between neighbouring pixels. No loss of
//! accuracy with weak returns. No models of time-of-flight cameras yet. An error of time, or of the place of the
//! sensor in its vehicle, is part of the pose.

mod common_noise;
mod covariance;
mod grammar;
mod keys;
mod kinect;
mod lidar;
mod parameter;
mod per_axis;
mod point_noise;
mod pose_noise;
mod pose_sigma;
mod scan_noise;
mod semidefinite;
mod sensor_noise;
mod sight;
mod stereo;
mod uniform;
mod vector;

pub use common_noise::CommonNoise;
pub use covariance::Covariance;
pub use grammar::ParseNoiseError;
pub use kinect::Kinect;
pub use lidar::Lidar;
pub use parameter::ParameterError;
pub use per_axis::PerAxis;
pub use point_noise::PointNoise;
pub use pose_noise::{PoseNoise, PoseNoiseError, jacobian};
pub use pose_sigma::PoseSigma;
pub use scan_noise::{ScanNoise, ScanNoiseError};
pub use sensor_noise::SensorNoise;
pub use sight::Sight;
pub use stereo::{Stereo, StereoParameters};
pub use uniform::Uniform;

/// The examples of the README are tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
