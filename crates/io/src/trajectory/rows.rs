//! Lines of numbers.

use super::{TrajectoryError, TrajectoryFormat};
use crate::tokens::{tokens, without_comment};

/// More values than any kind of line has.
const MOST: usize = 16;

/// The numbers of one line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Row {
    line: usize,
    values: [f64; MOST + 1],
    count: usize,
}

impl Row {
    pub(super) fn line(&self) -> usize {
        self.line
    }

    /// The numbers; one more than 16 stands for any number beyond.
    pub(super) fn values(&self) -> &[f64] {
        self.values.get(..self.count).unwrap_or_default()
    }

    /// The numbers when there are exactly `N`.
    pub(super) fn exactly<const N: usize>(
        &self,
        format: TrajectoryFormat,
    ) -> Result<[f64; N], TrajectoryError> {
        self.values().try_into().map_err(|_| TrajectoryError::Columns {
            line: self.line,
            found: self.count,
            expected: N,
            format,
        })
    }
}

/// The lines of a text that hold numbers, one at a time.
pub(super) struct Rows<'a> {
    rest: &'a [u8],
    line: usize,
}

impl<'a> Rows<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes), line: 0 }
    }

    /// The next row, which stays to be read.
    pub(super) fn peek(&self) -> Result<Option<Row>, TrajectoryError> {
        Self { rest: self.rest, line: self.line }.next()
    }

    /// The next row; `None` at the end.
    pub(super) fn next(&mut self) -> Result<Option<Row>, TrajectoryError> {
        while !self.rest.is_empty() {
            let end = self.rest.iter().position(|b| *b == b'\n').unwrap_or(self.rest.len());
            let (text, rest) = self.rest.split_at(end);
            self.rest = rest.get(1..).unwrap_or_default();
            self.line += 1;
            let text = std::str::from_utf8(text).map_err(|_| TrajectoryError::NotText { line: self.line })?;
            let text = without_comment(text).trim();
            if !text.is_empty() {
                return self.parse(text).map(Some);
            }
        }
        Ok(None)
    }

    fn parse(&self, text: &str) -> Result<Row, TrajectoryError> {
        let mut row = Row { line: self.line, values: [0.0; MOST + 1], count: 0 };
        for token in tokens(text) {
            let Some(place) = row.values.get_mut(row.count) else { return Ok(row) };
            *place = token.parse().map_err(|_| TrajectoryError::NotANumber {
                line: self.line,
                column: row.count + 1,
                text: token.chars().take(40).collect(),
            })?;
            row.count += 1;
        }
        Ok(row)
    }
}
