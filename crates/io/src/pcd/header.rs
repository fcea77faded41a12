//! The header of a PCD file.

use terrace_types::Pose;

use super::PcdError;
use crate::bytes::{Bytes, Failure, Outcome};
use crate::cloud::lines::{Lines, count, number, shown, words};
use crate::cloud::records::Scalar;

/// The name of fields that only fill space.
pub(super) const PADDING: &str = "_";

pub(super) struct Header {
    pub fields: Vec<Field>,
    pub points: u64,
    pub viewpoint: Option<Pose>,
    pub data: Data,
    /// Byte after the header.
    pub body: u64,
    /// Number of lines of the header.
    pub lines: usize,
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Data {
    Ascii,
    Binary,
    Compressed,
}

pub(super) struct Field {
    pub name: String,
    pub size: usize,
    pub kind: u8,
    pub count: usize,
}

impl Field {
    /// Its type, when it is one of the format's.
    pub(super) fn scalar(&self) -> Option<Scalar> {
        Some(match (self.kind.to_ascii_uppercase(), self.size) {
            (b'I', 1) => Scalar::I8,
            (b'I', 2) => Scalar::I16,
            (b'I', 4) => Scalar::I32,
            (b'I', 8) => Scalar::I64,
            (b'U', 1) => Scalar::U8,
            (b'U', 2) => Scalar::U16,
            (b'U', 4) => Scalar::U32,
            (b'U', 8) => Scalar::U64,
            (b'F', 4) => Scalar::F32,
            (b'F', 8) => Scalar::F64,
            _ => return None,
        })
    }
}

impl Header {
    /// Bytes of a point, and of all points, where both can be counted.
    pub(super) fn sizes(&self) -> Result<(usize, usize), PcdError> {
        let mut sum = Some(0_usize);
        for field in &self.fields {
            sum = sum.and_then(|sum| sum.checked_add(field.size.checked_mul(field.count)?));
        }
        let points = usize::try_from(self.points).ok();
        sum.and_then(|stride| Some((stride, stride.checked_mul(points?)?)))
            .ok_or(PcdError::TooLarge { points: self.points, stride: sum.unwrap_or(usize::MAX) })
    }
}

/// The lines of a header as they were found.
#[derive(Default)]
struct Found {
    fields: Option<Vec<String>>,
    sizes: Option<Vec<usize>>,
    kinds: Option<Vec<u8>>,
    counts: Option<Vec<usize>>,
    width: Option<u64>,
    height: Option<u64>,
    points: Option<u64>,
    viewpoint: Option<(usize, Vec<u8>)>,
}

pub(super) fn parse<B: Bytes>(bytes: &mut B) -> Outcome<Header, PcdError, B> {
    let mut lines = Lines::new(0, 0);
    let mut found = Found::default();
    while let Some((line, content)) = lines.next(bytes).map_err(Failure::Input)? {
        let wrong = |expected| PcdError::Header { line, expected, found: shown(content) };
        let mut entries = words(content);
        let Some(key) = entries.next().filter(|key| !key.starts_with(b"#")) else { continue };
        match key {
            b"VERSION" => {}
            b"FIELDS" | b"COLUMNS" => {
                found.fields = Some(entries.map(|e| String::from_utf8_lossy(e).into_owned()).collect());
            }
            b"SIZE" => found.sizes = Some(wholes(entries).ok_or_else(|| wrong("whole sizes from 0 up"))?),
            b"COUNT" => found.counts = Some(wholes(entries).ok_or_else(|| wrong("whole counts from 0 up"))?),
            b"TYPE" => {
                let letter = |entry: &[u8]| if let [letter] = entry { Some(*letter) } else { None };
                let kinds = entries.map(letter).collect::<Option<_>>();
                found.kinds = Some(kinds.ok_or_else(|| wrong("types of one letter"))?);
            }
            b"WIDTH" | b"HEIGHT" | b"POINTS" => {
                let number = match (entries.next(), entries.next()) {
                    (Some(entry), None) => count(entry),
                    _ => None,
                };
                let number = number.ok_or_else(|| wrong("one whole number from 0 up"))?;
                match key {
                    b"WIDTH" => found.width = Some(number),
                    b"HEIGHT" => found.height = Some(number),
                    _ => found.points = Some(number),
                }
            }
            b"VIEWPOINT" => found.viewpoint = Some((line, content.to_vec())),
            b"DATA" => {
                let data = match entries.next() {
                    Some(b"ascii") => Data::Ascii,
                    Some(b"binary") => Data::Binary,
                    Some(b"binary_compressed") => Data::Compressed,
                    _ => return Err(wrong("`DATA` with ascii, binary or binary_compressed").into()),
                };
                return Ok(found.assemble(data, &lines)?);
            }
            _ => return Err(wrong("a key of a PCD header").into()),
        }
    }
    Err(PcdError::NoData { lines: lines.read() }.into())
}

impl Found {
    fn assemble(self, data: Data, lines: &Lines) -> Result<Header, PcdError> {
        let names = self.fields.ok_or(PcdError::MissingKey { key: "FIELDS" })?;
        let fields = names.len();
        let sizes = entries(self.sizes, "SIZE", fields, 4)?;
        let kinds = entries(self.kinds, "TYPE", fields, b'F')?;
        let counts = entries(self.counts, "COUNT", fields, 1)?;
        let points = match (self.points, self.width, self.height.unwrap_or(1)) {
            (Some(points), Some(width), height) if width.checked_mul(height) != Some(points) => {
                return Err(PcdError::PointCount { points, width, height });
            }
            (Some(points), ..) => points,
            (None, Some(width), height) => {
                width.checked_mul(height).ok_or(PcdError::PointCount { points: u64::MAX, width, height })?
            }
            (None, None, _) => return Err(PcdError::MissingKey { key: "POINTS" }),
        };
        let fields = names.into_iter().zip(sizes).zip(kinds).zip(counts);
        Ok(Header {
            fields: fields.map(|(((name, size), kind), count)| Field { name, size, kind, count }).collect(),
            points,
            viewpoint: self.viewpoint.map(|(line, content)| viewpoint(line, &content)).transpose()?,
            data,
            body: lines.offset(),
            lines: lines.read(),
        })
    }
}

/// `VIEWPOINT tx ty tz qw qx qy qz`.
fn viewpoint(line: usize, content: &[u8]) -> Result<Pose, PcdError> {
    let numbers: Option<Vec<f64>> = words(content).skip(1).map(number).collect();
    let Some([tx, ty, tz, qw, qx, qy, qz]) = numbers.as_deref() else {
        return Err(PcdError::Header {
            line,
            expected: "`VIEWPOINT` with seven numbers",
            found: shown(content),
        });
    };
    Pose::from_quaternion([*tx, *ty, *tz], [*qx, *qy, *qz, *qw])
        .map_err(|source| PcdError::Viewpoint { line, source })
}

fn wholes<'a>(entries: impl Iterator<Item = &'a [u8]>) -> Option<Vec<usize>> {
    entries.map(|entry| count(entry).and_then(|number| usize::try_from(number).ok())).collect()
}

/// One entry per field, by default `default`.
fn entries<T: Clone>(
    found: Option<Vec<T>>,
    key: &'static str,
    fields: usize,
    default: T,
) -> Result<Vec<T>, PcdError> {
    let found = found.unwrap_or_else(|| vec![default; fields]);
    if found.len() == fields {
        Ok(found)
    } else {
        Err(PcdError::Entries { key, entries: found.len(), fields })
    }
}
