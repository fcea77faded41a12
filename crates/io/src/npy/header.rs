//! The header of an NPY file: a Python dictionary of `descr`, `fortran_order` and `shape`.
//!
//! Only this dictionary is read, not Python: a header is a handful of known words, and a general parser of literals
//! takes time and stack without bound on a hostile one.

use super::NpyError;
use crate::bytes::{Bytes, Failure, Outcome};
use crate::cloud::lines::shown;
use crate::cloud::records::{ByteOrder, Scalar};

pub(super) struct Header {
    /// The type as it is written.
    pub descr: String,
    /// The type, when it is a number of 1 to 8 bytes.
    pub scalar: Option<Scalar>,
    pub order: ByteOrder,
    pub fortran: bool,
    pub shape: Vec<u64>,
    /// Byte after the header.
    pub body: u64,
}

pub(super) fn parse<B: Bytes>(bytes: &mut B) -> Outcome<Header, NpyError, B> {
    const MARK: &[u8] = b"\x93NUMPY";
    let present = bytes.left(0);
    let truncated = |needed| NpyError::TruncatedHeader { needed, present };
    let start = bytes.window(0, 12).map_err(Failure::Input)?;
    if !start.starts_with(MARK) {
        return Err(NpyError::NotNpy { found: shown(start.get(..MARK.len()).unwrap_or(start)) }.into());
    }
    let rest = start.get(MARK.len()..).unwrap_or_default();
    let ([major, minor], rest) = rest.split_first_chunk().ok_or_else(|| truncated(10))?;
    let (length, at) = match (major, minor) {
        (1, 0) => {
            let (length, _) = rest.split_first_chunk().ok_or_else(|| truncated(10))?;
            (usize::from(u16::from_le_bytes(*length)), 10)
        }
        (2 | 3, 0) => {
            let (length, _) = rest.split_first_chunk().ok_or_else(|| truncated(12))?;
            (usize::try_from(u32::from_le_bytes(*length)).unwrap_or(usize::MAX), 12)
        }
        (major, minor) => return Err(NpyError::Version { major: *major, minor: *minor }.into()),
    };
    let body = length.saturating_add(at);
    if body > present {
        return Err(truncated(body).into());
    }
    let text = bytes.window(at as u64, length).map_err(Failure::Input)?;
    Ok(Cursor { text, at: 0, start: at }.dictionary(body as u64)?)
}

/// A place in the text of the header.
struct Cursor<'a> {
    text: &'a [u8],
    at: usize,
    /// Where the text starts in the file.
    start: usize,
}

impl<'a> Cursor<'a> {
    fn dictionary(mut self, body: u64) -> Result<Header, NpyError> {
        let (mut descr, mut fortran, mut shape) = (None, None, None);
        self.require(b"{", "`{`")?;
        while !self.take(b"}") {
            let key = self.quoted("a quoted key or `}`")?;
            self.require(b":", "`:`")?;
            match key {
                b"descr" => descr = Some(self.quoted("a type in quotes (structured arrays are not read)")?),
                b"fortran_order" => fortran = Some(self.truth()?),
                b"shape" => shape = Some(self.shape()?),
                _ => return Err(self.wrong("only `descr`, `fortran_order` and `shape`")),
            }
            if !self.take(b",") {
                self.require(b"}", "`,` or `}`")?;
                break;
            }
        }
        let (Some(descr), Some(fortran), Some(shape)) = (descr, fortran, shape) else {
            return Err(self.wrong("`descr`, `fortran_order` and `shape` before it ends"));
        };
        let (order, scalar) = number_type(descr);
        let descr = shown(descr);
        Ok(Header { descr, scalar, order, fortran, shape, body })
    }

    fn shape(&mut self) -> Result<Vec<u64>, NpyError> {
        let mut shape = Vec::new();
        self.require(b"(", "`(`")?;
        while !self.take(b")") {
            shape.push(self.whole()?);
            if !self.take(b",") {
                self.require(b")", "`,` or `)`")?;
                break;
            }
        }
        Ok(shape)
    }

    fn whole(&mut self) -> Result<u64, NpyError> {
        let rest = self.rest();
        let digits = rest.iter().take_while(|byte| byte.is_ascii_digit()).count();
        let number = rest.get(..digits).and_then(crate::cloud::lines::count);
        let number = number.ok_or_else(|| self.wrong("a whole number from 0 up"))?;
        self.at += digits;
        // Python 2 wrote long integers.
        self.take(b"L");
        Ok(number)
    }

    fn truth(&mut self) -> Result<bool, NpyError> {
        if self.take(b"True") {
            return Ok(true);
        }
        self.require(b"False", "`True` or `False`")?;
        Ok(false)
    }

    fn quoted(&mut self, expected: &'static str) -> Result<&'a [u8], NpyError> {
        let rest = self.rest();
        let inner = match rest.split_first() {
            Some((quote @ (b'\'' | b'"'), inner)) => {
                inner.iter().position(|byte| byte == quote).and_then(|end| inner.get(..end))
            }
            _ => None,
        };
        let inner = inner.ok_or_else(|| self.wrong(expected))?;
        self.at += inner.len() + 2;
        Ok(inner)
    }

    fn require(&mut self, word: &[u8], expected: &'static str) -> Result<(), NpyError> {
        if self.take(word) { Ok(()) } else { Err(self.wrong(expected)) }
    }

    /// Steps over white space, and over `word` when it comes next.
    fn take(&mut self, word: &[u8]) -> bool {
        let next = self.rest().starts_with(word);
        self.at += if next { word.len() } else { 0 };
        next
    }

    fn rest(&mut self) -> &'a [u8] {
        let rest = self.text.get(self.at..).unwrap_or_default();
        let trimmed = rest.trim_ascii_start();
        self.at += rest.len() - trimmed.len();
        trimmed
    }

    fn wrong(&mut self, expected: &'static str) -> NpyError {
        let found = self.rest();
        NpyError::Header { offset: self.start + self.at, expected, found: shown(found) }
    }
}

/// Byte order and type of such as `<f4`; no type when it is none of the numbers that are read.
fn number_type(descr: &[u8]) -> (ByteOrder, Option<Scalar>) {
    let (order, name) = match descr.split_first() {
        Some((b'>', name)) => (ByteOrder::Big, name),
        Some((b'<' | b'|' | b'=', name)) => (ByteOrder::Little, name),
        _ => (ByteOrder::Little, descr),
    };
    let scalar = match name {
        b"i1" => Some(Scalar::I8),
        b"u1" => Some(Scalar::U8),
        b"i2" => Some(Scalar::I16),
        b"u2" => Some(Scalar::U16),
        b"i4" => Some(Scalar::I32),
        b"u4" => Some(Scalar::U32),
        b"i8" => Some(Scalar::I64),
        b"u8" => Some(Scalar::U64),
        b"f4" => Some(Scalar::F32),
        b"f8" => Some(Scalar::F64),
        _ => None,
    };
    (order, scalar)
}
