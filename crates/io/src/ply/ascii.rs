//! The body of an ascii PLY file: a line a record.

use std::ops::Range;

use super::PlyError;
use super::header::{Element, Kind, Property};
use crate::bytes::{Bytes, Failure, Outcome};
use crate::cloud::LEAST_BYTES_OF_A_LINE;
use crate::cloud::fields::Rows;
use crate::cloud::lines::{Lines, count, number, shown, words};

/// Reads `records` of an element and, when they are points, adds them to `rows`.
pub(super) fn read<B: Bytes>(
    bytes: &mut B,
    lines: &mut Lines,
    element: &Element,
    records: Range<u64>,
    mut rows: Option<&mut Rows>,
) -> Outcome<(), PlyError, B> {
    // A record without properties takes no line.
    if element.properties.is_empty() {
        return Ok(());
    }
    if let Some(rows) = &mut rows {
        let most = bytes.left(lines.offset()) / LEAST_BYTES_OF_A_LINE + 1;
        rows.reserve(usize::try_from(records.end - records.start).unwrap_or(most).min(most));
    }
    for found in records {
        let (line, content) = lines.next_filled(bytes).map_err(Failure::Input)?.ok_or_else(|| {
            PlyError::MissingLines { element: element.name.clone(), count: element.count, found }
        })?;
        record(element, line, content, rows.as_deref_mut())?;
    }
    Ok(())
}

/// Checks one line and, when it is a vertex, keeps its values.
fn record(
    element: &Element,
    line: usize,
    content: &[u8],
    mut rows: Option<&mut Rows>,
) -> Result<(), PlyError> {
    let mut tokens = words(content);
    for (index, property) in element.properties.iter().enumerate() {
        let token = tokens.next().ok_or_else(|| short(line, property))?;
        match property.kind {
            Kind::List { .. } => {
                for _ in 0..count(token).ok_or_else(|| value(line, property, token))? {
                    tokens.next().ok_or_else(|| short(line, property))?;
                }
            }
            Kind::Scalar(_) => {
                if let Some(rows) = rows.as_mut().filter(|rows| rows.wants(index)) {
                    rows.set(index, number(token).ok_or_else(|| value(line, property, token))?);
                }
            }
        }
    }
    if let Some(token) = tokens.next() {
        return Err(PlyError::LongLine { line, token: shown(token) });
    }
    if let Some(rows) = rows {
        rows.push();
    }
    Ok(())
}

fn short(line: usize, property: &Property) -> PlyError {
    PlyError::ShortLine { line, property: property.name.clone() }
}

fn value(line: usize, property: &Property, token: &[u8]) -> PlyError {
    PlyError::Value { line, property: property.name.clone(), token: shown(token) }
}
