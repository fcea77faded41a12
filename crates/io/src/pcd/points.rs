//! The points of a PCD file, taken piece by piece.

use terrace_types::Pose;

use super::header::{self, Data, Header, PADDING};
use super::{PcdError, ascii, binary};
use crate::FieldChoice;
use crate::bytes::{Bytes, Outcome};
use crate::cloud::fields::{Missing, Rows, Wanted};
use crate::cloud::lines::Lines;

/// A place in a file, and the points that were read and not yet taken.
pub(crate) struct Points {
    header: Header,
    body: Body,
    /// Index of the point that comes next.
    next: u64,
    pub(crate) rows: Rows,
}

enum Body {
    Ascii(Lines),
    Binary,
    /// Unpacked with the first points.
    Compressed(Option<Vec<u8>>),
}

impl Points {
    /// Reads the header.
    pub(crate) fn open<B: Bytes>(bytes: &mut B, errors_from: &FieldChoice) -> Outcome<Self, PcdError, B> {
        let header = header::parse(bytes)?;
        let names: Vec<&str> = header.fields.iter().map(|field| field.name.as_str()).collect();
        let wanted = Wanted::find(&names, errors_from)
            .map_err(|Missing { name, fields }| PcdError::MissingField { name, fields })?;
        let unusable = |index: usize| {
            header.fields.get(index).filter(|f| f.name == PADDING || f.count != 1 || f.scalar().is_none())
        };
        if let Some(field) = wanted.indices().find_map(unusable) {
            let (name, kind) = (field.name.clone(), char::from(field.kind));
            let (size, count) = (field.size, field.count);
            return Err(PcdError::FieldType { name, kind, size, count }.into());
        }
        let body = match header.data {
            Data::Ascii => Body::Ascii(Lines::new(header.body, header.lines)),
            Data::Binary => Body::Binary,
            Data::Compressed => Body::Compressed(None),
        };
        Ok(Self { header, body, next: 0, rows: Rows::new(wanted) })
    }

    /// Number of points that the header promises.
    pub(crate) fn promised(&self) -> u64 {
        self.header.points
    }

    /// The pose of the sensor, when the file has one.
    pub(crate) fn viewpoint(&self) -> Option<Pose> {
        self.header.viewpoint
    }

    /// Format and encoding for people.
    pub(crate) fn format(&self) -> &'static str {
        match self.header.data {
            Data::Ascii => "PCD ascii",
            Data::Binary => "PCD binary",
            Data::Compressed => "PCD binary_compressed",
        }
    }

    /// Adds the next points to the rows, `most` at most.
    pub(crate) fn read<B: Bytes>(&mut self, bytes: &mut B, most: usize) -> Outcome<(), PcdError, B> {
        let end = self.next.saturating_add(most as u64).min(self.header.points);
        let points = self.next..end;
        match &mut self.body {
            Body::Ascii(lines) => ascii::read(bytes, lines, &self.header, points, &mut self.rows)?,
            Body::Binary => binary::read(bytes, &self.header, points, &mut self.rows)?,
            Body::Compressed(Some(block)) => {
                binary::read_unpacked(block, &self.header, points, &mut self.rows)?;
            }
            Body::Compressed(unpacked) => {
                let block = unpacked.insert(binary::unpack(bytes, &self.header)?);
                binary::read_unpacked(block, &self.header, points, &mut self.rows)?;
            }
        }
        self.next = end;
        Ok(())
    }
}
