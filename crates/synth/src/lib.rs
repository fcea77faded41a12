//! Synthetic scans of scenes whose planes are known: a table, a furnished room, a building of such rooms, a
//! corridor; and noisy copies of scans.
//!
//! A plane finder is judged against the truth, and truth by hand is never quite true. Here a sensor is simulated: rays
//! end on the nearest surface of a building, the label of a point is the surface its ray met, and the planes are those
//! the building was made of.
//!
//! | scene | made of | sensor | noise unless chosen |
//! |---|---|---|---|
//! | [`Scene::table`] | a top and two side panels, mutually perpendicular, none parallel to an axis | none: points spread over the area | white, 1 cm along every axis |
//! | [`Scene::desk`] | a board on two side panels, along the axes | none | as the table |
//! | [`Scene::strip`] | one plane of 0.9 × 0.3 m, 1.5 m from the origin, parallel to no axis | none | as the table |
//! | [`Scene::patch`] | one plane of 0.6 × 0.6 m at the same place | none | white, growing along one side from 1 to 12 mm |
//! | [`Scene::room`] | 5 × 4 × 2.6 m: floor, ceiling, walls, a door 6 cm behind its wall, two tables, a sideboard, a leaning board; ball, pillar and table legs | depth camera at 14 places | σ(z) = 0.0012 + 0.0019 (z − 0.4)² along the ray, z the depth |
//! | [`Scene::building`] | such rooms side by side and above each other, one for every 100 000 points | as the room, in each | as the room |
//! | [`Scene::corridor`] | 26 m with a right-angled bend: floor, ceiling, walls, eight doors in niches of 8 to 20 cm; pipes and a bin | lidar at 17 places | 2 cm along the ray |
//!
//! # Why this interface
//!
//! A [`Scene`] is the building and the places of the sensor; [`Params`] say how it is scanned. The same building from
//! the same places gives a thousand points or a billion: [`Scene::generate`] returns them all, [`Scene::chunks`] in
//! pieces with the same bits, so that memory stays bounded. Points come in the sensor's frame with its pose, in the order
//! in which such a sensor delivers them; [`Synthetic::merged`] puts them into the world. [`Scene::transformed`] moves
//! everything rigidly and leaves what the sensors measured untouched, for tests of invariance. More points make a room
//! denser; a building they make larger ([`Scene::sized`]), to see what cost does as a place grows.
//!
//! ```
//! use terrace_synth::{Params, Scene};
//!
//! let room = Scene::room().generate(&Params { points: Some(20_000), seed: 7, ..Params::default() })?;
//! assert_eq!((room.scans.len(), room.points()), (14, 20_000));
//!
//! let floor = &room.planes[0];
//! assert_eq!((floor.name, floor.plane.normal()), ("floor", [0.0, 0.0, 1.0]));
//!
//! // A point, with how far it was measured from its true plane.
//! let scan = &room.scans[0];
//! if let (Some(point), Some(id)) = (scan.scan.world_point(0), scan.labels[0]) {
//!     let distance = room.planes[id.index()].plane.signed_distance(point.position);
//!     assert!(distance.abs() < 0.3);
//! }
//! # Ok::<(), terrace_synth::SynthError>(())
//! ```
//!
//! # Noisy copies
//!
//! Whether stated uncertainties are true shows when the same exact scan is measured many times. With a standard error of
//! zero in [`Params`] a scan is exact; then
//!
//! * [`stated`] says what errors a model of the sensor has at its points, as covariances;
//! * [`perturbed`] moves each point by noise of its stated error, standard error or covariance of any rank;
//! * [`misplaced`] tells the pose with an error of a [`PoseNoise`](terrace_noise::PoseNoise).
//!
//! ```
//! use terrace_noise::{PoseNoise, SensorNoise};
//! use terrace_synth::{Params, Scene, misplaced, perturbed, stated};
//!
//! let corridor = Scene::corridor();
//! let lidar: SensorNoise = "lidar:range=0.02,angle=0.1deg".parse()?;
//! let poses = PoseNoise::from_degrees(0.01, 0.1)?;
//! let exact = corridor.generate(&Params { points: Some(17_000), sigma: Some(0.0), ..Params::default() })?;
//! let axis = corridor.optical_axis();
//! let seed = 7;
//! for copy in 0..3 {
//!     for (view, scan) in (0..).zip(&exact.scans) {
//!         // A stream for each scan of each copy.
//!         let stream = copy * exact.scans.len() as u64 + view;
//!         let noisy = perturbed(&stated(&scan.scan, &lidar, axis)?, seed, stream);
//!         let told = misplaced(&stated(&noisy, &lidar, axis)?, &poses, seed, stream)?;
//!         assert_eq!(told.present(), scan.labels.len());
//!     }
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Labels
//!
//! Coplanar parts of one surface, such as the two legs of the corridor's floor, share an identity. Curved things have the
//! label `None`, and so have flat parts too narrow to count as planes: the reveals, lintels and sills of door niches.
//! Every plane is listed, however few points it got; normals point to the side from which the plane is seen.
//!
//! # Accuracy
//!
//! Without noise a labelled point lies on its plane to 1e-9 m. Noise is Gaussian, by Marsaglia's polar method; the
//! standard error given with a point is the one its noise was drawn with. The noise of a sensor acts along the ray alone,
//! while the error given is one number for all axes: a plane seen at a slant has less noise across it than stated. Noise
//! of [`perturbed`] has the stated covariance whole. Pose errors are exact exponentials, of which a covariance of points is
//! the first order.
//!
//! # Randomness
//!
//! All of it comes from `ChaCha8` with the seed of [`Params`], a stream for each view. [`perturbed`] and [`misplaced`] have
//! keys of their own, so that one seed serves for scene, noise and poses. The same seed gives the same bits
//! on one platform; between platforms the last bit of a logarithm or sine may differ.
//!
//! # Errors and limits
//!
//! [`SynthError`] for zero points, more than [`MAX_POINTS`], a standard error that is negative, not a number or above
//! [`MAX_SIGMA`], and motions out of the range of numbers; [`StatedError`] where a model of a sensor has no covariance;
//! [`MisplacedError`] for scans without a pose. Nothing panics. Memory of [`Scene::generate`] is that of the
//! points. No lens distortion, no quantised depth, no mixed pixels at edges, no drop-outs: real sensors are worse.
//! Callers cannot make buildings of their own.

mod build;
mod chunks;
mod draws;
mod factor;
mod gauss;
mod kind;
mod merge;
mod misplaced;
mod params;
mod perturb;
mod scene;
mod scenes;
mod sensor;
mod shape;
mod stated;
mod synthetic;
mod vector;

pub use chunks::{Chunk, Chunks};
pub use kind::{SceneKind, UnknownScene};
pub use misplaced::{MisplacedError, PoseOffset, misplaced};
pub use params::{MAX_POINTS, MAX_SIGMA, Params, SynthError};
pub use perturb::perturbed;
pub use scene::{Scene, ScenePlane};
pub use scenes::POINTS_PER_ROOM;
pub use stated::{StatedError, stated};
pub use synthetic::{LabelledScan, Synthetic, TruePlane};
