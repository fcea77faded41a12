//! The points of a PLY file, taken piece by piece.

use super::header::{self, Encoding, Header, Kind};
use super::{PlyError, ascii, binary};
use crate::FieldChoice;
use crate::bytes::{Bytes, Outcome};
use crate::cloud::fields::{Missing, Rows, Wanted};
use crate::cloud::lines::Lines;
use crate::cloud::records::ByteOrder;

/// A place in a file, and the points that were read and not yet taken.
pub(crate) struct Points {
    header: Header,
    body: Body,
    /// Index of the element of points, and of the element and record that come next.
    vertex: usize,
    element: usize,
    record: u64,
    pub(crate) rows: Rows,
}

/// Where the next record starts.
enum Body {
    Ascii(Lines),
    Binary(ByteOrder, u64),
}

impl Points {
    /// Reads the header.
    pub(crate) fn open<B: Bytes>(bytes: &mut B, errors_from: &FieldChoice) -> Outcome<Self, PlyError, B> {
        let header = header::parse(bytes)?;
        let vertex = header.elements.iter().position(|element| element.name == "vertex");
        let vertex = vertex.ok_or(PlyError::NoVertices)?;
        let properties =
            header.elements.get(vertex).map(|element| &element.properties[..]).unwrap_or_default();
        let names: Vec<&str> = properties.iter().map(|property| property.name.as_str()).collect();
        let wanted = Wanted::find(&names, errors_from)
            .map_err(|Missing { name, fields }| PlyError::MissingProperty { name, properties: fields })?;
        let list = |index: &usize| properties.get(*index).filter(|p| matches!(p.kind, Kind::List { .. }));
        if let Some(property) = wanted.indices().find_map(|index| list(&index)) {
            return Err(PlyError::ListProperty { name: property.name.clone() }.into());
        }
        let body = match header.encoding {
            Encoding::Ascii => Body::Ascii(Lines::new(header.body, header.lines)),
            Encoding::Binary(order) => Body::Binary(order, header.body),
        };
        Ok(Self { header, body, vertex, element: 0, record: 0, rows: Rows::new(wanted) })
    }

    /// Number of points that the header promises.
    pub(crate) fn promised(&self) -> u64 {
        self.header.elements.get(self.vertex).map_or(0, |element| element.count)
    }

    /// Format and encoding for people.
    pub(crate) fn format(&self) -> &'static str {
        match self.header.encoding {
            Encoding::Ascii => "PLY ascii",
            Encoding::Binary(ByteOrder::Little) => "PLY binary_little_endian",
            Encoding::Binary(ByteOrder::Big) => "PLY binary_big_endian",
        }
    }

    /// Adds the next points to the rows, `most` at most. With the last points goes what stands behind them in the file.
    pub(crate) fn read<B: Bytes>(&mut self, bytes: &mut B, most: usize) -> Outcome<(), PlyError, B> {
        while let Some(element) = self.header.elements.get(self.element) {
            let (end, rows) = if self.element == self.vertex {
                let end = self.record.saturating_add(most as u64).min(element.count);
                (end, Some(&mut self.rows))
            } else {
                (element.count, None)
            };
            match &mut self.body {
                Body::Ascii(lines) => ascii::read(bytes, lines, element, self.record..end, rows)?,
                Body::Binary(order, at) => {
                    *at = binary::read(bytes, *at, element, *order, self.record..end, rows)?;
                }
            }
            self.record = end;
            if end < element.count {
                break;
            }
            self.element += 1;
            self.record = 0;
        }
        Ok(())
    }
}
