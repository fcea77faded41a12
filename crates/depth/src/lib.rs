#![doc = include_str!("../README.md")]

mod around;
mod camera;
mod error;
mod errors;
mod finder;
mod flat;
mod grow;
mod labels;
mod looks;
mod plane;
mod pyramid;
mod regions;
mod settings;
mod strips;
mod tile;
mod tiles;

pub use camera::Camera;
pub use error::DepthError;
pub use finder::{DepthPlanes, PlaneFinder};
pub use plane::DepthPlane;
pub use settings::Settings;
