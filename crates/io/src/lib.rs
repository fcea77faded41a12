//! Readers and writers of scans, trajectories and plane maps.

mod cloud;
pub mod npy;
pub mod pcd;
pub mod ply;
pub mod text;

pub use cloud::{Cloud, FieldChoice};
