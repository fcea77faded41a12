//! Readers and writers of scans, trajectories and plane maps.

mod atomic;
mod cloud;
pub mod depth;
mod detect;
mod file;
mod inspect;
mod intrinsics;
mod labels;
mod natural;
mod noise;
pub mod npy;
pub mod palette;
pub mod pcd;
pub mod planes_json;
pub mod ply;
mod ply_out;
mod read;
pub mod source;
mod spacing;
pub mod text;
pub mod trajectory;

pub use atomic::{WriteError, WriteErrorKind, write_atomically};
pub use cloud::{Cloud, FieldChoice};
pub use depth::{DepthError, DepthImage};
pub use file::FileError;
pub use inspect::{Info, inspect};
pub use intrinsics::{Intrinsics, IntrinsicsError};
pub use labels::write_labels_npy;
pub use natural::natural_order;
pub use noise::NoiseModel;
pub use ply_out::{LabelledPoint, MeasuredPoint, PlyExtent, write_labelled_ply, write_measured_ply};
pub use read::{ErrorSource, ReadError, ReadErrorKind, ReadOptions, read_scan};
pub use source::{Source, SourceError, find_sources};
