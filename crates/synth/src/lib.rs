//! Synthetic scans of scenes with known planes.

mod build;
mod chunks;
mod gauss;
mod params;
mod scene;
mod scenes;
mod sensor;
mod shape;
mod synthetic;
mod vector;

pub use chunks::{Chunk, Chunks};
pub use params::{MAX_POINTS, MAX_SIGMA, Params, SynthError};
pub use scene::{Scene, SceneKind, ScenePlane, UnknownScene};
pub use synthetic::{LabelledScan, Synthetic, TruePlane};
