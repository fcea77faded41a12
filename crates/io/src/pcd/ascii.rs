//! The body of an ascii PCD file: a line a point.

use terrace_types::Sigma;

use super::PcdError;
use super::header::{Field, Header};
use crate::cloud::fields::{Rows, Wanted};
use crate::cloud::lines::{Lines, number, shown, words};

/// A point needs at least `0 0 0` and a line end.
const LEAST_BYTES_OF_A_POINT: usize = 6;

pub(super) fn read(
    bytes: &[u8],
    header: &Header,
    wanted: Wanted,
) -> Result<(Vec<[f64; 3]>, Sigma), PcdError> {
    let most = bytes.len().saturating_sub(header.body) / LEAST_BYTES_OF_A_POINT + 1;
    let mut rows = Rows::new(wanted, usize::try_from(header.points).unwrap_or(most).min(most));
    let mut lines = Lines::new(bytes, header.body, header.lines);
    for found in 0..header.points {
        let (line, content) =
            lines.next_filled().ok_or(PcdError::MissingLines { points: header.points, found })?;
        point(&header.fields, line, content, &mut rows)?;
    }
    Ok(rows.finish())
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
