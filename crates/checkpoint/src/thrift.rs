//! As much of the compact protocol of Thrift as headers of pages need: numbers by their place, everything else passed over.
//!
//! <https://github.com/apache/thrift/blob/master/doc/specs/thrift-compact-protocol.md>

/// Structures within each other; headers of pages have three.
const DEEPEST: u32 = 8;

/// Bytes that are read one after the other.
pub(crate) struct Thrift<'b> {
    bytes: &'b [u8],
    at: usize,
}

/// What a field of a structure holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Value {
    /// A whole number.
    Number(i64),
    /// A structure, which is to be read next.
    Structure,
    /// Something else, which was passed over.
    Other,
}

impl<'b> Thrift<'b> {
    pub(crate) fn new(bytes: &'b [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    /// Bytes that were read.
    pub(crate) fn read(&self) -> usize {
        self.at
    }

    /// Hands the fields of a structure to `field`, by their numbers. `None` when the bytes are none, or end before it does.
    /// Where a field is a structure, `field` reads it or has it passed over.
    pub(crate) fn structure(
        &mut self,
        mut field: impl FnMut(&mut Self, i64, Value) -> Option<()>,
    ) -> Option<()> {
        let mut number = 0_i64;
        loop {
            let head = self.byte()?;
            if head == 0 {
                return Some(());
            }
            number = match head >> 4 {
                0 => self.number()?,
                step => number.checked_add(i64::from(step))?,
            };
            let value = match head & 0xf {
                4..=6 => Value::Number(self.number()?),
                12 => Value::Structure,
                kind => {
                    self.pass_over(kind, true, DEEPEST)?;
                    Value::Other
                }
            };
            field(self, number, value)?;
        }
    }

    /// Reads a structure that nothing is wanted of.
    pub(crate) fn pass_over_structure(&mut self) -> Option<()> {
        self.pass_over(12, true, DEEPEST)
    }

    fn pass_over(&mut self, kind: u8, in_structure: bool, depth: u32) -> Option<()> {
        match kind {
            // True and false are in the head of a field.
            1 | 2 if in_structure => Some(()),
            1..=3 => self.skip(1),
            4..=6 => self.number().map(|_| ()),
            7 => self.skip(8),
            8 => {
                let length = usize::try_from(self.unsigned()?).ok()?;
                self.skip(length)
            }
            9 | 10 => {
                let head = self.byte()?;
                let size = match head >> 4 {
                    15 => self.unsigned()?,
                    size => u64::from(size),
                };
                // Each takes a byte at least.
                if size > (self.bytes.len() - self.at) as u64 {
                    return None;
                }
                (0..size).try_for_each(|_| self.pass_over(head & 0xf, false, depth.checked_sub(1)?))
            }
            12 => {
                let depth = depth.checked_sub(1)?;
                loop {
                    let head = self.byte()?;
                    if head == 0 {
                        return Some(());
                    }
                    if head >> 4 == 0 {
                        self.number()?;
                    }
                    self.pass_over(head & 0xf, true, depth)?;
                }
            }
            // Headers of pages have no maps.
            _ => None,
        }
    }

    fn byte(&mut self) -> Option<u8> {
        let byte = *self.bytes.get(self.at)?;
        self.at += 1;
        Some(byte)
    }

    fn skip(&mut self, bytes: usize) -> Option<()> {
        self.at = self.at.checked_add(bytes).filter(|at| *at <= self.bytes.len())?;
        Some(())
    }

    fn unsigned(&mut self) -> Option<u64> {
        let mut value = 0;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            value |= u64::from(byte & 0x7f) << shift;
            if byte < 0x80 {
                return Some(value);
            }
        }
        None
    }

    /// A number with a sign, which is its lowest bit.
    fn number(&mut self) -> Option<i64> {
        let bits = self.unsigned()?;
        Some((bits >> 1).cast_signed() ^ -(bits & 1).cast_signed())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fields(bytes: &[u8]) -> Option<Vec<(i64, Value)>> {
        let mut found = Vec::new();
        Thrift::new(bytes).structure(|thrift, number, value| {
            found.push((number, value));
            if value == Value::Structure { thrift.pass_over_structure() } else { Some(()) }
        })?;
        Some(found)
    }

    #[test]
    fn fields_are_told_by_their_numbers() {
        // 1: −1, 2: 150, 5: a structure with a text, a list of three and a bool, 40 (by its full number): 3.
        let bytes = [
            0x15, 0x01, 0x15, 0xac, 0x02, 0x3c, 0x18, 0x02, b'a', b'b', 0x19, 0x35, 0x02, 0x04, 0x06, 0x11,
            0x00, 0x05, 0x50, 0x06, 0x00,
        ];
        let found = fields(&bytes).unwrap();
        let number = Value::Number;
        assert_eq!(found, [(1, number(-1)), (2, number(150)), (5, Value::Structure), (40, number(3))]);
        for end in 0..bytes.len() {
            assert_eq!(fields(&bytes[..end]), None, "{end}");
        }
    }

    #[test]
    fn what_does_not_end_is_no_structure() {
        assert_eq!(
            fields(&[0x15, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x01, 0x00]),
            None
        );
        // A text and a list that are longer than what is there, and structures without end.
        assert_eq!(fields(&[0x18, 0xff, 0xff, 0xff, 0x7f, 0x00]), None);
        assert_eq!(fields(&[0x19, 0xf5, 0xff, 0xff, 0xff, 0x7f, 0x00]), None);
        assert_eq!(fields(&[0x1c; 10_000]), None);
    }
}
