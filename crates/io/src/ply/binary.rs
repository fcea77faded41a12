//! The body of a binary PLY file. Elements without lists are taken as one block, the others record by record.

use terrace_types::Sigma;

use super::PlyError;
use super::header::{Element, Header, Kind};
use crate::cloud::fields::{Rows, Wanted};
use crate::cloud::records::{ByteOrder, Column, Scalar};

pub(super) fn read(
    bytes: &[u8],
    header: &Header,
    vertex: usize,
    wanted: Wanted,
    order: ByteOrder,
) -> Result<(Vec<[f64; 3]>, Sigma), PlyError> {
    let mut at = header.body;
    let mut vertices = (Vec::new(), Sigma::Unknown);
    for (index, element) in header.elements.iter().enumerate() {
        let is_vertex = index == vertex;
        if element.properties.iter().any(|property| matches!(property.kind, Kind::List { .. })) {
            let room = room(bytes.len().saturating_sub(at), element);
            let mut rows = is_vertex.then(|| Rows::new(wanted, room));
            at = walk(bytes, at, element, order, rows.as_mut())?;
            vertices = rows.map_or(vertices, Rows::finish);
            continue;
        }
        let (block, count, stride) = block(bytes, at, element)?;
        at += block.len();
        if is_vertex {
            let columns = columns(element, block, stride);
            // `wanted` holds indices of this element's properties.
            let nothing = Column { bytes: &[], stride, offset: 0, scalar: Scalar::U8 };
            vertices =
                wanted.gather(order, count, |property| columns.get(property).copied().unwrap_or(nothing));
        }
    }
    Ok(vertices)
}

/// The bytes of an element without lists, the number of its records and their size.
fn block<'a>(bytes: &'a [u8], at: usize, element: &Element) -> Result<(&'a [u8], usize, usize), PlyError> {
    let stride = element.stride().unwrap_or(usize::MAX);
    let rest = bytes.get(at..).unwrap_or_default();
    if stride == 0 {
        return Ok((&[], 0, 0));
    }
    let count = usize::try_from(element.count).ok();
    let Some((count, size)) = count.and_then(|count| Some((count, count.checked_mul(stride)?))) else {
        return Err(PlyError::TooLarge { element: element.name.clone(), count: element.count, stride });
    };
    let block = rest.get(..size).ok_or_else(|| PlyError::Truncated {
        element: element.name.clone(),
        count: element.count,
        stride,
        offset: at,
        present: rest.len(),
    })?;
    Ok((block, count, stride))
}

fn columns<'a>(element: &Element, bytes: &'a [u8], stride: usize) -> Vec<Column<'a>> {
    let mut offset = 0;
    let scalars = element.properties.iter().map(|property| match property.kind {
        Kind::Scalar(scalar) | Kind::List { item: scalar, .. } => scalar,
    });
    scalars
        .map(|scalar| {
            let column = Column { bytes, stride, offset, scalar };
            offset += scalar.size();
            column
        })
        .collect()
}

/// How many records can be in `present` bytes when all their lists are empty, and not more than promised.
fn room(present: usize, element: &Element) -> usize {
    let least = element.properties.iter().map(|property| match property.kind {
        Kind::Scalar(scalar) | Kind::List { length: scalar, .. } => scalar.size(),
    });
    let most = present / least.sum::<usize>().max(1);
    usize::try_from(element.count).unwrap_or(most).min(most)
}

/// Steps through records with lists and keeps the values of vertices; gives the byte after the element.
fn walk(
    bytes: &[u8],
    mut at: usize,
    element: &Element,
    order: ByteOrder,
    mut rows: Option<&mut Rows>,
) -> Result<usize, PlyError> {
    for record in 0..element.count {
        for (index, property) in element.properties.iter().enumerate() {
            let rest = bytes.get(at..).unwrap_or_default();
            let size = match property.kind {
                Kind::Scalar(scalar) => {
                    if let Some(rows) = rows.as_mut().filter(|rows| rows.wants(index)) {
                        rows.set(index, scalar.read(rest, order));
                    }
                    Some(scalar.size())
                }
                Kind::List { length, item } => match length.read_integer(rest, order) {
                    Some(length @ ..0) => {
                        return Err(PlyError::ListLength {
                            element: element.name.clone(),
                            record,
                            property: property.name.clone(),
                            length,
                            offset: at,
                        });
                    }
                    Some(items) => usize::try_from(items)
                        .ok()
                        .and_then(|items| items.checked_mul(item.size())?.checked_add(length.size())),
                    None => None,
                },
            };
            // A size that cannot be counted is beyond the end of the file as well.
            let size = size.filter(|size| *size <= rest.len()).ok_or_else(|| PlyError::TruncatedRecord {
                element: element.name.clone(),
                record,
                property: property.name.clone(),
                offset: at,
            })?;
            at += size;
        }
        if let Some(rows) = rows.as_mut() {
            rows.push();
        }
    }
    Ok(at)
}
