//! Maps of `terrace` as Parquet files.
//!
//! A map is a grid of sums, and sums add: parts of a map that were built on several machines, each saved to a file, make the map of all
//! points. A file has a row for each cell and can be read by anything that reads Parquet; its columns, with their units, are described in
//! `docs/map-parquet.md` of the repository.
//!
//! ```
//! use terrace::{Frame, Mapper, Params, Scan, Sigma};
//! use terrace_checkpoint::{read_map, write_map};
//!
//! let floor = (0..10_000).map(|k| [0.02 * f64::from(k % 100), 0.02 * f64::from(k / 100), 0.0]);
//! let scan = Scan::new(floor.collect(), Sigma::Uniform(0.005), Frame::World { sensor: None })?;
//! let mut mapper = Mapper::streaming(Params { cell_size: Some(0.1), ..Params::default() })?;
//! mapper.insert(&scan)?;
//!
//! let mut file = Vec::new();
//! write_map(&mapper, &mut file)?;
//! let mut again = read_map(file)?;
//! assert_eq!(again.extract()?, mapper.extract()?);
//! // It can grow on, and be merged with others.
//! again.merge(&mapper)?;
//! assert_eq!(again.len(), 20_000);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # What is saved
//! All that planes follow from: the sums of cells, samples of their points, which scan saw how many of them, the sensors and how sure
//! their poses are, and every setting. What is read has the same bits, and so have its planes. Points themselves are not saved: a map that
//! keeps them is saved as one that [forgets](terrace::Mapper::streaming) them, and only maps that can do without may be saved.
//!
//! # Why this interface
//! * Two functions, from and to a [`Mapper`](terrace::Mapper), on any writer and on bytes or a file. Where files are, and that none is
//!   left half-written, is the caller's business.
//! * No trust: a file is checked as a whole, down to whether points in a cell can have its sums and whether the cells have the points
//!   of each scan.
//!
//! # Any bytes
//! Files may come from anywhere. What is no map, or a damaged one, is a [`MapFileError`]; a map whose sums are not finite is never returned.
//! Memory stays within a multiple of the size of the file: pages are looked at before they are unpacked. Single bits of a sum
//! that were flipped and still fit the cell are not noticed: there is no checksum.
//!
//! # Limits
//! Only what [`write_map`] may write is read for sure: other tools may change rows, order and compression (none or Snappy), but all
//! columns and the metadata have to be there.

mod cells;
mod error;
mod guard;
mod head;
mod read;
mod schema;
mod settings;
mod thrift;
mod write;

pub use error::{MapFileError, PageError, SaveError};
pub use read::{is_parquet, open_map, read_map};
pub use schema::{METADATA_KEY, VERSION};
pub use write::write_map;

/// The examples of the README are tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
