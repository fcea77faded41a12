//! The body of a binary PLY file. Elements without lists are taken as one block, the others record by record.

use std::ops::Range;

use super::PlyError;
use super::header::{Element, Kind};
use crate::bytes::{Bytes, Failure, Outcome, place};
use crate::cloud::fields::Rows;
use crate::cloud::records::{ByteOrder, Scalar};

/// Reads `records` of an element from byte `at` on and, when they are points, adds them to `rows`; gives the byte after
/// them.
pub(super) fn read<B: Bytes>(
    bytes: &mut B,
    at: u64,
    element: &Element,
    order: ByteOrder,
    records: Range<u64>,
    mut rows: Option<&mut Rows>,
) -> Outcome<u64, PlyError, B> {
    if element.properties.iter().any(|property| matches!(property.kind, Kind::List { .. })) {
        if let Some(rows) = &mut rows {
            rows.reserve(room(bytes.left(at), element, &records));
        }
        return walk(bytes, at, element, order, records, rows);
    }
    let stride = element.stride().unwrap_or(usize::MAX);
    if stride == 0 {
        return Ok(at);
    }
    if records.start == 0 {
        check_size(bytes.left(at), at, element, stride)?;
    }
    // What was checked for all records can be counted for some.
    let count = usize::try_from(records.end - records.start).unwrap_or(usize::MAX);
    if let Some(rows) = rows {
        let fields = fields(element);
        // The rows ask for fields of this element only.
        let field = |property| fields.get(property).copied().unwrap_or((0, Scalar::U8));
        rows.gather_records(bytes, at, stride, count, order, field).map_err(Failure::Input)?;
    }
    Ok(at + (count as u64).saturating_mul(stride as u64))
}

/// Holds the number of records without lists against the bytes from `at` on.
fn check_size(present: usize, at: u64, element: &Element, stride: usize) -> Result<(), PlyError> {
    let size = usize::try_from(element.count).ok().and_then(|count| count.checked_mul(stride));
    let Some(size) = size else {
        return Err(PlyError::TooLarge { element: element.name.clone(), count: element.count, stride });
    };
    if size > present {
        return Err(PlyError::Truncated {
            element: element.name.clone(),
            count: element.count,
            stride,
            offset: place(at),
            present,
        });
    }
    Ok(())
}

/// Where in a record each property starts, and its type.
fn fields(element: &Element) -> Vec<(usize, Scalar)> {
    let mut offset = 0;
    let scalars = element.properties.iter().map(|property| match property.kind {
        Kind::Scalar(scalar) | Kind::List { item: scalar, .. } => scalar,
    });
    scalars
        .map(|scalar| {
            let start = offset;
            offset += scalar.size();
            (start, scalar)
        })
        .collect()
}

/// How many of `records` can be in `present` bytes when all their lists are empty.
fn room(present: usize, element: &Element, records: &Range<u64>) -> usize {
    let least = element.properties.iter().map(|property| match property.kind {
        Kind::Scalar(scalar) | Kind::List { length: scalar, .. } => scalar.size(),
    });
    let most = present / least.sum::<usize>().max(1);
    usize::try_from(records.end - records.start).unwrap_or(most).min(most)
}

/// Steps through records with lists and keeps the values of points; gives the byte after them.
fn walk<B: Bytes>(
    bytes: &mut B,
    mut at: u64,
    element: &Element,
    order: ByteOrder,
    records: Range<u64>,
    mut rows: Option<&mut Rows>,
) -> Outcome<u64, PlyError, B> {
    for record in records {
        for (index, property) in element.properties.iter().enumerate() {
            let present = bytes.left(at);
            let start = bytes.window(at, size_of::<u64>()).map_err(Failure::Input)?;
            let size = match property.kind {
                Kind::Scalar(scalar) => {
                    if let Some(rows) = rows.as_mut().filter(|rows| rows.wants(index)) {
                        rows.set(index, scalar.read(start, order));
                    }
                    Some(scalar.size())
                }
                Kind::List { length, item } => match length.read_integer(start, order) {
                    Some(length @ ..0) => {
                        return Err(PlyError::ListLength {
                            element: element.name.clone(),
                            record,
                            property: property.name.clone(),
                            length,
                            offset: place(at),
                        }
                        .into());
                    }
                    Some(items) => usize::try_from(items)
                        .ok()
                        .and_then(|items| items.checked_mul(item.size())?.checked_add(length.size())),
                    None => None,
                },
            };
            // A size that cannot be counted is beyond the end of the file as well.
            let size = size.filter(|size| *size <= present).ok_or_else(|| PlyError::TruncatedRecord {
                element: element.name.clone(),
                record,
                property: property.name.clone(),
                offset: place(at),
            })?;
            at += size as u64;
        }
        if let Some(rows) = rows.as_mut() {
            rows.push();
        }
    }
    Ok(at)
}
