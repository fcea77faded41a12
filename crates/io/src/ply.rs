//! PLY: ascii, binary little- and big-endian.
//!
//! The points are the element `vertex`, their coordinates its scalar properties `x`, `y` and `z` of any type. Other
//! properties and elements may be of any type, lists included; they are stepped over, but must be there. Numbers of an
//! ascii file are read in double precision whatever type the header gives them, so that large coordinates stay exact.
//!
//! **Tolerated:** CRLF headers, comments and `obj_info` anywhere in the header, types `int64` and `uint64`, blank lines,
//! and anything after the last element.
//!
//! **Limits.** At most 32 bytes are asked for per byte after the header, and 128 per byte of the header, whatever counts
//! it holds. An ascii file that was cut within its very last number cannot be told from a whole one.
//!
//! ```
//! use terrace_io::{FieldChoice, ply};
//!
//! let file = b"ply\nformat ascii 1.0\nelement vertex 1\n\
//!     property float x\nproperty float y\nproperty float z\nend_header\n1 2 3.5\n";
//! let cloud = ply::read(file, &FieldChoice::Automatic)?;
//! assert_eq!(cloud.points, [[1.0, 2.0, 3.5]]);
//! # Ok::<(), ply::PlyError>(())
//! ```

mod ascii;
mod binary;
mod header;
mod points;

use crate::bytes::Failure;
use crate::{Cloud, FieldChoice};
pub(crate) use points::Points;

/// Why a PLY file was refused. Lines are counted from 1, records from 0, offsets in bytes from the start of the file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PlyError {
    /// The first line is not `ply`.
    #[error("a PLY file starts with the line `ply`, this one with `{found}`")]
    NotPly {
        /// The start of the file.
        found: String,
    },
    /// The file ends before `end_header`.
    #[error("the header ends after line {lines} without `end_header`")]
    NoEndOfHeader {
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
    /// There is no `format` line.
    #[error("the header has no `format` line")]
    NoFormat,
    /// There is no element `vertex`.
    #[error("the file has no element `vertex`")]
    NoVertices,
    /// A coordinate, or the field asked for as standard error, is not there.
    #[error("the element `vertex` has no property `{name}`; it has: {properties}")]
    MissingProperty {
        /// The property looked for.
        name: String,
        /// The properties there are.
        properties: String,
    },
    /// A coordinate or standard error is a list.
    #[error("the property `{name}` is a list, not a number")]
    ListProperty {
        /// The property.
        name: String,
    },
    /// The size of an element is beyond what can be counted.
    #[error("the element `{element}` of {count} records with {stride} bytes each cannot be in any file")]
    TooLarge {
        /// Name of the element.
        element: String,
        /// Number of records in the header.
        count: u64,
        /// Bytes of a record.
        stride: usize,
    },
    /// The header promises more than the file has. It was cut, or the count is wrong.
    #[error(
        "the element `{element}` starts at byte {offset} and needs {count} records of {stride} bytes, but the file has {present} bytes from there on"
    )]
    Truncated {
        /// Name of the element.
        element: String,
        /// Number of records in the header.
        count: u64,
        /// Bytes of a record.
        stride: usize,
        /// Where the element starts.
        offset: usize,
        /// Bytes from there to the end of the file.
        present: usize,
    },
    /// The file ends within a record with lists, or before it.
    #[error(
        "the file ends in record {record} of the element `{element}`, in property `{property}` at byte {offset}"
    )]
    TruncatedRecord {
        /// Name of the element.
        element: String,
        /// Index of the record.
        record: u64,
        /// Name of the property.
        property: String,
        /// Where the property starts.
        offset: usize,
    },
    /// The length of a list is negative.
    #[error(
        "record {record} of the element `{element}` has a list `{property}` of length {length} at byte {offset}"
    )]
    ListLength {
        /// Name of the element.
        element: String,
        /// Index of the record.
        record: u64,
        /// Name of the property.
        property: String,
        /// The length found.
        length: i128,
        /// Where it stands.
        offset: usize,
    },
    /// An ascii file has fewer lines than the header promises.
    #[error("the file ends after {found} of {count} records of the element `{element}`")]
    MissingLines {
        /// Name of the element.
        element: String,
        /// Number of records in the header.
        count: u64,
        /// Number of records found.
        found: u64,
    },
    /// A line of an ascii file has too few values.
    #[error("line {line} ends before property `{property}`")]
    ShortLine {
        /// Number of the line.
        line: usize,
        /// Name of the property that is missing.
        property: String,
    },
    /// A line of an ascii file has more values than its element has properties.
    #[error("line {line} goes on with `{token}` after the last property")]
    LongLine {
        /// Number of the line.
        line: usize,
        /// The first value too many.
        token: String,
    },
    /// A value of an ascii file is not a number, or the length of a list not a whole one from 0 up.
    #[error("line {line}: `{token}` is no value for property `{property}`")]
    Value {
        /// Number of the line.
        line: usize,
        /// Name of the property.
        property: String,
        /// The text found.
        token: String,
    },
}

/// Reads the points of a PLY file.
///
/// # Errors
/// [`PlyError`] when the file is not a whole PLY file with points, or has no field for the errors that were asked for.
pub fn read(mut bytes: &[u8], errors_from: &FieldChoice) -> Result<Cloud, PlyError> {
    let mut points = Points::open(&mut bytes, errors_from).map_err(Failure::content)?;
    points.read(&mut bytes, usize::MAX).map_err(Failure::content)?;
    let format = points.format();
    let (points, sigma) = points.rows.take();
    Ok(Cloud { points, sigma, viewpoint: None, format })
}
