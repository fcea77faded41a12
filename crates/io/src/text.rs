//! Points as text: XYZ, CSV, TXT, PTS.
//!
//! A line is a point, its values apart by semicolons, else by commas, else by spaces and tabs; the first line that is no
//! comment decides for the file. Without names the first three columns are `x`, `y` and `z`; names may stand in the first
//! line or in a comment before it (`//X Y Z` of CloudCompare, `# x y z sigma`) with as many words as there are columns.
//! Other columns are ignored, but every line must have as many as the first. A first line that is a whole number alone
//! is the number of points, and is held against them.
//!
//! **Tolerated:** comments (`#`, `//`), blank lines, CRLF and CR, a byte order mark, quotes, a separator at the end of
//! a line, `nan` and `inf`.
//!
//! **Refused:** decimal commas, and values that are no number where one is read: an absent measurement is `nan`.
//!
//! **Limits.** At most 32 bytes are asked for per byte of the file, and 128 per byte of its first line. A file without a
//! number of points that was cut at the end of a line, or within the last number of one, cannot be told from a whole one.
//!
//! ```
//! use terrace_io::{FieldChoice, text};
//! use terrace_types::Sigma;
//!
//! let cloud = text::read(b"x;y;z;sigma\n1;2;3.5;0.01\n", &FieldChoice::Automatic)?;
//! assert_eq!(cloud.points, [[1.0, 2.0, 3.5]]);
//! assert_eq!(cloud.sigma, Sigma::PerPoint(vec![0.01]));
//! # Ok::<(), text::TextError>(())
//! ```

mod points;

use crate::bytes::Failure;
use crate::cloud::fields::{Missing, Rows, Wanted};
use crate::cloud::lines::{count, number, shown};
use crate::{Cloud, FieldChoice};
pub(crate) use points::Points;

/// Why a text file was refused. Lines are counted from 1.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TextError {
    /// There is no line with a point.
    #[error("the file has no points in its {lines} lines")]
    NoPoints {
        /// Number of lines in the file.
        lines: usize,
    },
    /// A coordinate, or the column asked for as standard error, is not there.
    #[error("line {line}: there is no column `{name}`; the columns are: {columns}")]
    MissingColumn {
        /// Number of the line with the names, or of the first point when there are none.
        line: usize,
        /// The column looked for.
        name: String,
        /// The columns there are.
        columns: String,
    },
    /// A line has more or fewer columns than the first.
    #[error("line {line} has {found} columns instead of {expected}")]
    Columns {
        /// Number of the line.
        line: usize,
        /// Columns of this line.
        found: usize,
        /// Columns of the first line, at least 3.
        expected: usize,
    },
    /// A value is not a number.
    #[error("line {line}: `{token}` is not a number")]
    NotANumber {
        /// Number of the line.
        line: usize,
        /// The text found.
        token: String,
    },
    /// A number is written with a decimal comma. Write it with a point.
    #[error("line {line}: decimal commas as in `{token}` are not supported, write decimal points")]
    DecimalComma {
        /// Number of the line.
        line: usize,
        /// The number found.
        token: String,
    },
    /// The first line gives another number of points than there are.
    #[error("line {line} announces {announced} points, but there are {found}")]
    Count {
        /// Number of the line.
        line: usize,
        /// The number it gives.
        announced: u64,
        /// Number of points.
        found: usize,
    },
}

/// How the columns of a file are laid out.
struct Layout {
    separator: Separator,
    columns: usize,
    rows: Rows,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Separator {
    WhiteSpace,
    Byte(u8),
}

/// Reads the points of a text file.
///
/// # Errors
/// [`TextError`] when a line is no point, there are none, or there is no column for the errors that were asked for.
pub fn read(mut bytes: &[u8], errors_from: &FieldChoice) -> Result<Cloud, TextError> {
    let mut points = Points::open(&mut bytes, errors_from).map_err(Failure::content)?;
    points.read(&mut bytes, usize::MAX).map_err(Failure::content)?;
    let format = points.format();
    let (points, sigma) = points.take();
    Ok(Cloud { points, sigma, viewpoint: None, format })
}

/// The count when a line is digits alone.
fn whole(content: &[u8], line: usize) -> Result<Option<u64>, TextError> {
    if !content.iter().all(u8::is_ascii_digit) {
        return Ok(None);
    }
    let too_large = || TextError::NotANumber { line, token: shown(content) };
    count(content).map(Some).ok_or_else(too_large)
}

/// The words of a comment when it can be a line of names.
fn names_in_comment(comment: &[u8]) -> Option<Vec<String>> {
    let names: Vec<&str> = std::str::from_utf8(comment)
        .ok()?
        .split([',', ';', ' ', '\t'])
        .map(|name| name.trim_matches('"'))
        .filter(|name| !name.is_empty())
        .collect();
    let has = |wanted: &str| names.iter().any(|name| name.eq_ignore_ascii_case(wanted));
    (has("x") && has("y") && has("z")).then(|| names.into_iter().map(str::to_owned).collect())
}

/// The layout that the first line after the comments gives, and whether it holds names instead of a point.
fn first_line(
    line: usize,
    content: &[u8],
    comments: &[(usize, Vec<String>)],
    errors_from: &FieldChoice,
) -> Result<(Layout, bool), TextError> {
    let separator = match content {
        _ if content.contains(&b';') => Separator::Byte(b';'),
        _ if content.contains(&b',') => Separator::Byte(b','),
        _ => Separator::WhiteSpace,
    };
    let tokens: Vec<&[u8]> = tokens(content, separator).collect();
    let columns = tokens.len();
    let starts_with_number = tokens.first().is_none_or(|token| number(token).is_some());
    let is_header = !starts_with_number && decimal_comma(content).is_none();
    let texts: Vec<_> = tokens.iter().map(|token| String::from_utf8_lossy(token)).collect();
    let names: Vec<&str> = texts.iter().map(AsRef::as_ref).collect();
    let commented = comments.iter().rev().find(|(_, names)| names.len() == columns);
    let (line, found) = if is_header {
        (line, Wanted::find(&names, errors_from))
    } else if let Some((line, names)) = commented {
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        (*line, Wanted::find(&names, errors_from))
    } else {
        if columns < 3 {
            return Err(TextError::Columns { line, found: columns, expected: 3 });
        }
        (line, Wanted::find(&["x", "y", "z"], errors_from))
    };
    let wanted =
        found.map_err(|Missing { name, fields }| TextError::MissingColumn { line, name, columns: fields })?;
    Ok((Layout { separator, columns, rows: Rows::new(wanted) }, is_header))
}

/// Adds the point of a line.
fn row(layout: &mut Layout, line: usize, content: &[u8]) -> Result<(), TextError> {
    let mut found = 0;
    for token in tokens(content, layout.separator) {
        if layout.rows.wants(found) {
            let value = number(token).ok_or_else(|| match decimal_comma(content) {
                Some(token) => TextError::DecimalComma { line, token: shown(token) },
                None => TextError::NotANumber { line, token: shown(token) },
            })?;
            layout.rows.set(found, value);
        }
        found += 1;
    }
    if found != layout.columns {
        return Err(TextError::Columns { line, found, expected: layout.columns });
    }
    layout.rows.push();
    Ok(())
}

/// The values of a trimmed line, without quotes. White space joins; other separators have a value on either side, but a
/// last one may end the line.
fn tokens(content: &[u8], separator: Separator) -> impl Iterator<Item = &[u8]> {
    let content = match separator {
        Separator::WhiteSpace => content,
        Separator::Byte(byte) => content.strip_suffix(&[byte]).unwrap_or(content),
    };
    content
        .split(move |byte| match separator {
            Separator::WhiteSpace => byte.is_ascii_whitespace(),
            Separator::Byte(separator) => *byte == separator,
        })
        .filter(move |token| separator != Separator::WhiteSpace || !token.is_empty())
        .map(|token| {
            let token = token.trim_ascii();
            token.strip_prefix(b"\"").and_then(|token| token.strip_suffix(b"\"")).unwrap_or(token)
        })
}

/// A number with a comma between digits, among values apart by semicolons or white space.
fn decimal_comma(content: &[u8]) -> Option<&[u8]> {
    let digits = |text: &[u8]| !text.is_empty() && text.iter().all(u8::is_ascii_digit);
    content.split(|byte| *byte == b';' || byte.is_ascii_whitespace()).find(|token| {
        let unsigned = token.strip_prefix(b"-").unwrap_or(token);
        let mut parts = unsigned.split(|byte| *byte == b',');
        matches!((parts.next(), parts.next(), parts.next()), (Some(a), Some(b), None) if digits(a) && digits(b))
    })
}
