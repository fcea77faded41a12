//! The header of a PLY file: encoding, elements and their properties.

use super::PlyError;
use crate::bytes::{Bytes, Failure, Outcome};
use crate::cloud::lines::{Lines, count, shown, words};
use crate::cloud::records::{ByteOrder, Scalar};

pub(super) struct Header {
    pub encoding: Encoding,
    pub elements: Vec<Element>,
    /// Byte after the header.
    pub body: u64,
    /// Number of lines of the header.
    pub lines: usize,
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    Binary(ByteOrder),
}

pub(super) struct Element {
    pub name: String,
    pub count: u64,
    pub properties: Vec<Property>,
}

pub(super) struct Property {
    pub name: String,
    pub kind: Kind,
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Scalar(Scalar),
    List { length: Scalar, item: Scalar },
}

impl Element {
    /// Bytes of a record when all have the same number; `None` with lists, and when the sum overflows.
    pub(super) fn stride(&self) -> Option<usize> {
        self.properties.iter().try_fold(0_usize, |sum, property| match property.kind {
            Kind::Scalar(scalar) => sum.checked_add(scalar.size()),
            Kind::List { .. } => None,
        })
    }
}

pub(super) fn parse<B: Bytes>(bytes: &mut B) -> Outcome<Header, PlyError, B> {
    let mut lines = Lines::new(0, 0);
    let first = lines.next(bytes).map_err(Failure::Input)?.map(|(_, line)| line).unwrap_or_default();
    if first.trim_ascii() != b"ply" {
        return Err(PlyError::NotPly { found: shown(first) }.into());
    }
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    while let Some((line, content)) = lines.next(bytes).map_err(Failure::Input)? {
        let wrong = |expected| PlyError::Header { line, expected, found: shown(content) };
        let mut words = words(content);
        match words.next() {
            None | Some(b"comment" | b"obj_info") => {}
            Some(b"format") => {
                encoding = Some(match words.next() {
                    Some(b"ascii") => Encoding::Ascii,
                    Some(b"binary_little_endian") => Encoding::Binary(ByteOrder::Little),
                    Some(b"binary_big_endian") => Encoding::Binary(ByteOrder::Big),
                    _ => {
                        let expected = "`format` with ascii, binary_little_endian or binary_big_endian";
                        return Err(wrong(expected).into());
                    }
                });
            }
            Some(b"element") => {
                let expected = "`element NAME COUNT` with a whole count from 0 up";
                let (Some(name), Some(number), None) = (words.next(), words.next(), words.next()) else {
                    return Err(wrong(expected).into());
                };
                let count = count(number).ok_or_else(|| wrong(expected))?;
                elements.push(Element { name: text(name), count, properties: Vec::new() });
            }
            Some(b"property") => {
                let property = property(words)
                    .ok_or_else(|| wrong("`property TYPE NAME` or `property list TYPE TYPE NAME`"))?;
                let element = elements.last_mut().ok_or_else(|| wrong("an element before its properties"))?;
                element.properties.push(property);
            }
            Some(b"end_header") => {
                let encoding = encoding.ok_or(PlyError::NoFormat)?;
                return Ok(Header { encoding, elements, body: lines.offset(), lines: lines.read() });
            }
            Some(_) => {
                return Err(wrong("format, element, property, comment, obj_info or end_header").into());
            }
        }
    }
    Err(PlyError::NoEndOfHeader { lines: lines.read() }.into())
}

fn property<'a>(mut words: impl Iterator<Item = &'a [u8]>) -> Option<Property> {
    let kind = match words.next()? {
        b"list" => {
            let length = scalar(words.next()?).filter(|scalar| scalar.is_integer())?;
            Kind::List { length, item: scalar(words.next()?)? }
        }
        word => Kind::Scalar(scalar(word)?),
    };
    let name = text(words.next()?);
    words.next().is_none().then_some(Property { name, kind })
}

fn scalar(word: &[u8]) -> Option<Scalar> {
    Some(match word {
        b"char" | b"int8" => Scalar::I8,
        b"uchar" | b"uint8" => Scalar::U8,
        b"short" | b"int16" => Scalar::I16,
        b"ushort" | b"uint16" => Scalar::U16,
        b"int" | b"int32" => Scalar::I32,
        b"uint" | b"uint32" => Scalar::U32,
        b"int64" => Scalar::I64,
        b"uint64" => Scalar::U64,
        b"float" | b"float32" => Scalar::F32,
        b"double" | b"float64" => Scalar::F64,
        _ => return None,
    })
}

fn text(word: &[u8]) -> String {
    String::from_utf8_lossy(word).into_owned()
}
