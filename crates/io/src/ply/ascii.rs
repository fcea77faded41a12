//! The body of an ascii PLY file: a line a record.

use terrace_types::Sigma;

use super::PlyError;
use super::header::{Element, Header, Kind, Property};
use crate::cloud::fields::{Rows, Wanted};
use crate::cloud::lines::{Lines, count, number, shown, words};

/// A point needs at least `0 0 0` and a line end.
const LEAST_BYTES_OF_A_POINT: usize = 6;

pub(super) fn read(
    bytes: &[u8],
    header: &Header,
    vertex: usize,
    wanted: Wanted,
) -> Result<(Vec<[f64; 3]>, Sigma), PlyError> {
    let mut lines = Lines::new(bytes, header.body, header.lines);
    let most = bytes.len().saturating_sub(header.body) / LEAST_BYTES_OF_A_POINT + 1;
    let promised = header.elements.get(vertex).map_or(0, |element| element.count);
    let mut rows = Rows::new(wanted, usize::try_from(promised).unwrap_or(most).min(most));
    for (index, element) in header.elements.iter().enumerate() {
        // A record without properties takes no line.
        if element.properties.is_empty() {
            continue;
        }
        for found in 0..element.count {
            let (line, content) = lines.next_filled().ok_or_else(|| PlyError::MissingLines {
                element: element.name.clone(),
                count: element.count,
                found,
            })?;
            record(element, line, content, (index == vertex).then_some(&mut rows))?;
        }
    }
    Ok(rows.finish())
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
