//! How sure the poses of a sequence are, from a text with a row for each.
//!
//! A row is a covariance of 6×6, its 36 numbers row by row, or two standard deviations: of the translation along each
//! axis in metres, and of the rotation about each axis in radians, uncorrelated. The first row decides for the file.
//! Order and axes of a covariance are those of [`PoseNoise`]: translation first, then rotation; along the axes of the
//! world, about the sensor; in m², m·rad and rad².
//!
//! Values are separated by spaces, commas, or both; a comma may end a line; `#` starts a comment; empty lines are skipped.
//! Lines are counted from 1, comments and empty lines included.
//!
//! ```
//! use terrace_io::pose_noise;
//! use terrace_noise::PoseNoise;
//!
//! let text = b"# sigma_t [m], sigma_r [rad]\n0.02, 0.001\n0.05, 0.002\n";
//! let noise = pose_noise::read(text)?;
//! assert_eq!(noise, [PoseNoise::from_radians(0.02, 0.001)?, PoseNoise::from_radians(0.05, 0.002)?]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use std::path::Path;

use terrace_noise::{ParameterError, PoseNoise, PoseNoiseError};

use crate::FileError;
use crate::tokens::{tokens, without_comment};

/// Numbers of a covariance.
const COVARIANCE: usize = 36;

/// Numbers of two standard deviations.
const DEVIATIONS: usize = 2;

/// Why a text tells no noise of poses.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PoseNoiseTextError {
    /// There is no row in the file.
    #[error("there is no row of numbers in the file")]
    Empty,
    /// A line is not UTF-8 text.
    #[error("line {line} is not text")]
    NotText {
        /// The line.
        line: usize,
    },
    /// A value is not a number.
    #[error("line {line}, value {column}: '{text}' is not a number")]
    NotANumber {
        /// The line.
        line: usize,
        /// The value in the line, from 1.
        column: usize,
        /// What stands there, shortened.
        text: String,
    },
    /// The first row is neither a covariance nor two standard deviations.
    #[error(
        "line {line} has {found} values; a pose has 36 (a covariance of 6x6, row by row) or 2 (standard deviations in \
         m and rad)"
    )]
    UnknownShape {
        /// The line.
        line: usize,
        /// Values in it; 37 stands for more than 36.
        found: usize,
    },
    /// A row has more or fewer values than the first.
    #[error("line {line} has {found} values where {expected} were expected, as in the first row")]
    Columns {
        /// The line.
        line: usize,
        /// Values in it; 37 stands for more than 36.
        found: usize,
        /// Values in the first row.
        expected: usize,
    },
    /// A standard deviation is negative or not finite.
    #[error("line {line}: {error}")]
    Deviation {
        /// The line.
        line: usize,
        /// What is wrong, with the value.
        error: ParameterError,
    },
    /// The 36 numbers are not a covariance.
    #[error("line {line}: {error}")]
    Covariance {
        /// The line.
        line: usize,
        /// What is wrong, with the values.
        error: PoseNoiseError,
    },
}

/// Reads the noise of poses, one a row; never none.
///
/// # Errors
/// [`PoseNoiseTextError`], which names the line and the value.
pub fn read(bytes: &[u8]) -> Result<Vec<PoseNoise>, PoseNoiseTextError> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let (mut rows, mut expected) = (Vec::new(), None);
    for (text, line) in bytes.split(|b| *b == b'\n').zip(1..) {
        let text = std::str::from_utf8(text).map_err(|_| PoseNoiseTextError::NotText { line })?;
        let text = without_comment(text).trim();
        if text.is_empty() {
            continue;
        }
        let numbers = numbers(text, line)?;
        let found = numbers.len();
        match expected {
            Some(expected) if expected != found => {
                return Err(PoseNoiseTextError::Columns { line, found, expected });
            }
            _ => expected = Some(found),
        }
        rows.push(noise(&numbers, line)?);
    }
    if rows.is_empty() { Err(PoseNoiseTextError::Empty) } else { Ok(rows) }
}

/// Reads the noise of poses from a file as [`read`] does.
///
/// # Errors
/// [`FileError`] naming the file.
pub fn open(path: &Path) -> Result<Vec<PoseNoise>, FileError<PoseNoiseTextError>> {
    crate::file::open_with(path, read)
}

/// The numbers of a line, at most one more than any row has.
fn numbers(text: &str, line: usize) -> Result<Vec<f64>, PoseNoiseTextError> {
    let number = |(token, column): (&str, usize)| {
        token.parse().map_err(|_| PoseNoiseTextError::NotANumber {
            line,
            column,
            text: token.chars().take(40).collect(),
        })
    };
    tokens(text).take(COVARIANCE + 1).zip(1..).map(number).collect()
}

fn noise(numbers: &[f64], line: usize) -> Result<PoseNoise, PoseNoiseTextError> {
    if let Ok([translation, rotation]) = <[f64; DEVIATIONS]>::try_from(numbers) {
        return PoseNoise::from_radians(translation, rotation)
            .map_err(|error| PoseNoiseTextError::Deviation { line, error });
    }
    if numbers.len() != COVARIANCE {
        return Err(PoseNoiseTextError::UnknownShape { line, found: numbers.len() });
    }
    let mut covariance = [[0.0; 6]; 6];
    for (entry, number) in covariance.as_flattened_mut().iter_mut().zip(numbers) {
        *entry = *number;
    }
    PoseNoise::from_covariance(covariance).map_err(|error| PoseNoiseTextError::Covariance { line, error })
}
