//! The body of an ascii PCD file: a line a point.

use std::ops::Range;

use super::PcdError;
use super::header::{Field, Header};
use crate::bytes::{Bytes, Failure, Outcome};
use crate::cloud::LEAST_BYTES_OF_A_LINE;
use crate::cloud::fields::Rows;
use crate::cloud::lines::{Lines, number, shown, words};

/// Adds `points` to `rows`.
pub(super) fn read<B: Bytes>(
    bytes: &mut B,
    lines: &mut Lines,
    header: &Header,
    points: Range<u64>,
    rows: &mut Rows,
) -> Outcome<(), PcdError, B> {
    let most = bytes.left(lines.offset()) / LEAST_BYTES_OF_A_LINE + 1;
    rows.reserve(usize::try_from(points.end - points.start).unwrap_or(most).min(most));
    for found in points {
        let (line, content) = lines
            .next_filled(bytes)
            .map_err(Failure::Input)?
            .ok_or(PcdError::MissingLines { points: header.points, found })?;
        point(&header.fields, line, content, rows)?;
    }
    Ok(())
}

fn point(fields: &[Field], line: usize, content: &[u8], rows: &mut Rows) -> Result<(), PcdError> {
    let mut tokens = words(content);
    for (index, field) in fields.iter().enumerate() {
        for _ in 0..field.count {
            let token =
                tokens.next().ok_or_else(|| PcdError::ShortLine { line, field: field.name.clone() })?;
            if rows.wants(index) {
                let value = number(token).ok_or_else(|| PcdError::Value {
                    line,
                    field: field.name.clone(),
                    token: shown(token),
                })?;
                rows.set(index, value);
            }
        }
    }
    if let Some(token) = tokens.next() {
        return Err(PcdError::LongLine { line, token: shown(token) });
    }
    rows.push();
    Ok(())
}
