//! PCD, the format of the Point Cloud Library: ascii, binary and `binary_compressed`, versions .5 to 0.7.
//!
//! Fields may come in any order, of any type and `COUNT`, with `_` padding; `x`, `y` and `z` are needed. Points that are
//! NaN keep their place. `VIEWPOINT` becomes [`Cloud::viewpoint`], the default `0 0 0 1 0 0 0` included. Numbers of an
//! ascii file are read in double precision whatever `SIZE` says, so that large coordinates stay exact.
//!
//! **Tolerated:** CRLF, comments, blank lines, keys in any order before `DATA`, `COLUMNS` for `FIELDS`; no `SIZE` (4),
//! `TYPE` (F), `COUNT` (1), `VERSION`, `VIEWPOINT`, and either of `POINTS` and `WIDTH` with `HEIGHT` (1); anything after
//! the last point.
//!
//! **Refused:** `POINTS` that is not `WIDTH` × `HEIGHT`, as PCL does: one of them is wrong, and a label per point could
//! not be matched to pixels.
//!
//! **Limits.** At most 32 bytes are asked for per byte after the header, and 128 per byte of the header, whatever counts
//! it holds. Compressed data is measured before it is unpacked, and LZF yields at most 88 bytes for one; the unpacked
//! bytes count as those of a binary file. An ascii file that was cut within its very last number cannot be told from a
//! whole one.
//!
//! ```
//! use terrace_io::{FieldChoice, pcd};
//!
//! let file = b"VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1\nHEIGHT 1\n\
//!     VIEWPOINT 0 0 1.5 1 0 0 0\nPOINTS 1\nDATA ascii\n1 2 nan\n";
//! let cloud = pcd::read(file, &FieldChoice::Automatic)?;
//! assert!(cloud.points[0][2].is_nan());
//! assert_eq!(cloud.viewpoint.unwrap().translation(), [0.0, 0.0, 1.5]);
//! # Ok::<(), pcd::PcdError>(())
//! ```

mod ascii;
mod binary;
mod header;
mod lzf;
mod points;

use terrace_types::PoseError;

use crate::bytes::Failure;
use crate::{Cloud, FieldChoice};
pub use lzf::LzfError;
pub(crate) use points::Points;

/// Why a PCD file was refused. Lines are counted from 1, offsets in bytes from the start of the file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PcdError {
    /// The file ends before `DATA`.
    #[error("the header ends after line {lines} without `DATA`")]
    NoData {
        /// Number of lines in the file.
        lines: usize,
    },
    /// A line of the header is not understood.
    #[error("line {line}: expected {expected}, found `{found}`")]
    Header {
        /// Number of the line.
        line: usize,
        /// What would have been right.
        expected: &'static str,
        /// The line.
        found: String,
    },
    /// A line of the header is missing.
    #[error("the header has no `{key}` line")]
    MissingKey {
        /// The key of the line.
        key: &'static str,
    },
    /// `SIZE`, `TYPE` or `COUNT` has not one entry per field.
    #[error("`{key}` has {entries} entries for {fields} fields")]
    Entries {
        /// The key of the line.
        key: &'static str,
        /// Number of its entries.
        entries: usize,
        /// Number of fields.
        fields: usize,
    },
    /// `POINTS` is not `WIDTH` times `HEIGHT`.
    #[error("POINTS is {points}, but WIDTH x HEIGHT is {width} x {height}")]
    PointCount {
        /// `POINTS` of the header.
        points: u64,
        /// `WIDTH` of the header.
        width: u64,
        /// `HEIGHT` of the header.
        height: u64,
    },
    /// `VIEWPOINT` is no pose.
    #[error("line {line}: VIEWPOINT: {source}")]
    Viewpoint {
        /// Number of the line.
        line: usize,
        /// What is wrong with it.
        source: PoseError,
    },
    /// A coordinate, or the field asked for as standard error, is not there.
    #[error("the file has no field `{name}`; it has: {fields}")]
    MissingField {
        /// The field looked for.
        name: String,
        /// The fields there are.
        fields: String,
    },
    /// A coordinate or standard error is of a type that PCD does not have, or several numbers.
    #[error("the field `{name}` has TYPE {kind}, SIZE {size}, COUNT {count}, which is not one number")]
    FieldType {
        /// The field.
        name: String,
        /// Its `TYPE`.
        kind: char,
        /// Its `SIZE`.
        size: usize,
        /// Its `COUNT`.
        count: usize,
    },
    /// The size of the points is beyond what can be counted.
    #[error("{points} points of {stride} bytes cannot be in any file")]
    TooLarge {
        /// Number of points in the header.
        points: u64,
        /// Bytes of a point; the largest number there is when they cannot be counted.
        stride: usize,
    },
    /// The header promises more than the file has. It was cut, or the count is wrong.
    #[error(
        "{points} points of {stride} bytes from byte {offset} on do not fit the {present} bytes that are there"
    )]
    Truncated {
        /// Number of points in the header.
        points: u64,
        /// Bytes of a point.
        stride: usize,
        /// Where the points start.
        offset: usize,
        /// Bytes from there to the end of the file.
        present: usize,
    },
    /// The compressed data is cut.
    #[error("{needed} bytes of compressed data from byte {offset} on, but {present} are there")]
    TruncatedCompressed {
        /// Bytes that are needed.
        needed: usize,
        /// Where they start.
        offset: usize,
        /// Bytes from there to the end of the file.
        present: usize,
    },
    /// The compressed data says it holds another number of bytes than the header.
    #[error("byte {offset}: {unpacked} unpacked bytes are announced for {points} points of {stride} bytes")]
    UnpackedSize {
        /// Where the size stands.
        offset: usize,
        /// The size announced.
        unpacked: usize,
        /// Number of points in the header.
        points: u64,
        /// Bytes of a point.
        stride: usize,
    },
    /// The compressed data is damaged.
    #[error("the compressed data from byte {offset} on is damaged: {source}")]
    Compressed {
        /// Where the compressed data starts.
        offset: usize,
        /// What is wrong with it.
        source: LzfError,
    },
    /// An ascii file has fewer lines than points.
    #[error("the file ends after {found} of {points} points")]
    MissingLines {
        /// Number of points in the header.
        points: u64,
        /// Number of points found.
        found: u64,
    },
    /// A line of an ascii file has too few values.
    #[error("line {line} ends before field `{field}`")]
    ShortLine {
        /// Number of the line.
        line: usize,
        /// Name of the field that is missing.
        field: String,
    },
    /// A line of an ascii file has more values than there are fields.
    #[error("line {line} goes on with `{token}` after the last field")]
    LongLine {
        /// Number of the line.
        line: usize,
        /// The first value too many.
        token: String,
    },
    /// A value of an ascii file is not a number.
    #[error("line {line}: `{token}` is no value for field `{field}`")]
    Value {
        /// Number of the line.
        line: usize,
        /// Name of the field.
        field: String,
        /// The text found.
        token: String,
    },
}

/// Reads the points of a PCD file.
///
/// # Errors
/// [`PcdError`] when the file is not a whole PCD file with points, or has no field for the errors that were asked for.
pub fn read(mut bytes: &[u8], errors_from: &FieldChoice) -> Result<Cloud, PcdError> {
    let mut points = Points::open(&mut bytes, errors_from).map_err(Failure::content)?;
    points.read(&mut bytes, usize::MAX).map_err(Failure::content)?;
    let (format, viewpoint) = (points.format(), points.viewpoint());
    let (points, sigma) = points.rows.take();
    Ok(Cloud { points, sigma, viewpoint, format })
}
