//! Readers and writers of scans, trajectories and plane maps: from what a user names on a command line to
//! [`Scan`](terrace_types::Scan)s, and from planes to files.
//!
//! | read | by | notes |
//! |---|---|---|
//! | PLY | [`ply`] | ascii, both byte orders, extra and list properties |
//! | PCD | [`pcd`] | ascii, binary and compressed; VIEWPOINT |
//! | XYZ, CSV and other text | [`text`] | columns by header or place |
//! | NPY | [`npy`] | N×3 or H×W×3 points; labels |
//! | 16-bit depth PNG | [`depth`] | with [`Intrinsics`] and raw units per metre; 0 and 65535 are no measurement |
//! | TUM, KITTI, 4×4 matrices, `Open3D` log, NPY | [`trajectory`] | poses |
//! | covariances of poses | [`pose_noise`] | text, 36 or 2 numbers a row |
//! | `planes.json` | [`planes_json`] | its fields are in `docs/planes-json.md` |
//!
//! | written | by |
//! |---|---|
//! | `planes.json` | [`planes_json::PlanesFile::write`] |
//! | labels as int32 NPY | [`write_labels_npy`], in chunks [`LabelsWriter`] |
//! | points coloured by plane as binary PLY | [`write_labelled_ply`], with σ [`write_measured_ply`], in chunks [`PlyWriter`] |
//!
//! **Three levels.** [`find_sources`] turns files, folders and patterns into a list of scans with their poses;
//! [`read_scan`] reads one of them, whatever its format; below are functions from bytes to a [`Cloud`], a [`DepthImage`]
//! or a [`Trajectory`](trajectory::Trajectory), which open no file.
//!
//! ```no_run
//! use terrace_io::{ErrorSource, ReadOptions, find_sources, read_scan};
//!
//! let options = ReadOptions {
//!     intrinsics: Some("585,585,320,240".parse()?),
//!     errors: ErrorSource::Model("kinect".parse()?),
//!     ..ReadOptions::default()
//! };
//! // A folder of NAME.depth.png with NAME.pose.txt beside them.
//! for source in find_sources(&["kitchen"], None)? {
//!     let scan = read_scan(&source, &options)?;
//!     println!("{}: {} points", source.path.display(), scan.present());
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! **Units and frames.** Metres and seconds. A scan keeps the frame of its file, see [`read_scan`].
//!
//! **Errors of points** come from fields of the file or from a noise model of the sensor (`terrace_noise`), see
//! [`ErrorSource`].
//!
//! **Absent measurements** keep their place in a scan as NaN, so that one label per input point can be written.
//!
//! **Any bytes** may be given to the readers: damaged files are errors that name line, record or value, and memory stays
//! within a stated multiple of the size of the file. [`WriteError`], [`ReadError`], [`SourceError`] and [`FileError`]
//! name the file as well.
//!
//! **Files larger than memory** are read by [`ScanReader`] in chunks, and what belongs to their points is written in
//! chunks. [`read_scan`] holds all points of a file, but not its bytes.
//!
//! **Outputs** are written aside and renamed into place, as [`write_atomically`] does: they are there whole, or not at all.
//! A program that is interrupted calls [`abandon_outputs`].
//!
//! **Limits.** No LAS, E57 or ROS bags: export them to PLY or PCD. One camera model:
//! the pinhole without distortion.

mod atomic;
mod by_model;
mod bytes;
mod cloud;
mod content;
pub mod depth;
mod detect;
mod file;
mod inspect;
mod intrinsics;
mod labels;
mod natural;
pub mod npy;
pub mod palette;
pub mod pcd;
pub mod planes_json;
pub mod ply;
mod ply_out;
mod ply_writer;
pub mod pose_noise;
mod read;
mod scan_reader;
pub mod source;
mod spacing;
pub mod text;
mod tokens;
pub mod trajectory;
mod unfinished;

pub use atomic::{WriteError, WriteErrorKind, write_atomically};
pub use cloud::{Cloud, FieldChoice};
pub use depth::{DepthError, DepthImage};
pub use file::FileError;
pub use inspect::{Info, inspect};
pub use intrinsics::{Intrinsics, IntrinsicsError};
pub use labels::{LabelsWriter, write_labels_npy};
pub use natural::natural_order;
pub use ply_out::{LabelledPoint, MeasuredPoint, PlyExtent, write_labelled_ply, write_measured_ply};
pub use ply_writer::{PlyPoint, PlyWriter};
pub use read::{Counted, ErrorSource, ReadError, ReadErrorKind, ReadOptions, read_counted, read_scan};
pub use scan_reader::ScanReader;
pub use source::{Source, SourceError, find_sources, find_uncertain_sources};
pub use unfinished::abandon_outputs;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
