//! Text split into numbered lines and numbers, with nothing asked of its encoding.

use crate::bytes::{Bytes, PIECE};

/// Bytes that are looked at first for the end of a line.
const USUAL_LINE: usize = 512;

/// A place in a file that goes from line to line. Lines are given with their numbers and without the line end (`\n` or
/// `\r\n`).
#[derive(Debug)]
pub(crate) struct Lines {
    at: u64,
    read: usize,
    end: u8,
}

impl Lines {
    /// From byte `at` on, before which there are `read` lines.
    pub(crate) fn new(at: u64, read: usize) -> Self {
        Self { at, read, end: b'\n' }
    }

    /// A text from byte `at` on, which may end its lines with `\r` alone.
    pub(crate) fn of_text<B: Bytes>(bytes: &mut B, at: u64) -> Result<Self, B::Error> {
        let (mut from, mut end) = (at, b'\r');
        loop {
            let piece = bytes.window(from, PIECE)?;
            if piece.contains(&b'\n') {
                end = b'\n';
                break;
            }
            if piece.is_empty() {
                break;
            }
            from += piece.len() as u64;
        }
        Ok(Self { at, read: 0, end })
    }

    /// Byte offset of the line that comes next.
    pub(crate) fn offset(&self) -> u64 {
        self.at
    }

    /// How many lines were read.
    pub(crate) fn read(&self) -> usize {
        self.read
    }

    /// The next line.
    pub(crate) fn next<'b, B: Bytes>(
        &mut self,
        bytes: &'b mut B,
    ) -> Result<Option<(usize, &'b [u8])>, B::Error> {
        let at = self.at;
        let Some((length, _)) = self.step(bytes)? else { return Ok(None) };
        let line = bytes.window(at, length)?;
        Ok(Some((self.read, line.strip_suffix(b"\r").unwrap_or(line))))
    }

    /// The next line that holds more than white space.
    pub(crate) fn next_filled<'b, B: Bytes>(
        &mut self,
        bytes: &'b mut B,
    ) -> Result<Option<(usize, &'b [u8])>, B::Error> {
        loop {
            let at = self.at;
            match self.step(bytes)? {
                None => return Ok(None),
                Some((_, true)) => {}
                Some((length, false)) => {
                    let line = bytes.window(at, length)?;
                    return Ok(Some((self.read, line.strip_suffix(b"\r").unwrap_or(line))));
                }
            }
        }
    }

    /// Goes over a line; tells its length without the last byte of its end, and whether it is blank.
    fn step<B: Bytes>(&mut self, bytes: &mut B) -> Result<Option<(usize, bool)>, B::Error> {
        let mut size = USUAL_LINE;
        let (length, blank) = loop {
            let window = bytes.window(self.at, size)?;
            if window.is_empty() {
                return Ok(None);
            }
            let end = window.iter().position(|byte| *byte == self.end);
            if end.is_some() || window.len() < size {
                let length = end.unwrap_or(window.len());
                let line = window.get(..length).unwrap_or(window);
                break (length, line.trim_ascii_start().is_empty());
            }
            size = size.saturating_mul(4);
        };
        self.at = (self.at + length as u64 + 1).min(bytes.length());
        self.read += 1;
        Ok(Some((length, blank)))
    }
}

/// Words between white space.
pub(crate) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
}

/// A number as text; `nan` and `inf` in any case count.
pub(crate) fn number(token: &[u8]) -> Option<f64> {
    std::str::from_utf8(token).ok()?.parse().ok()
}

/// A count as text.
pub(crate) fn count(token: &[u8]) -> Option<u64> {
    std::str::from_utf8(token).ok()?.parse().ok()
}

/// What stands in the file, for a message: readable and short.
pub(crate) fn shown(bytes: &[u8]) -> String {
    const MOST: usize = 60;
    let start = bytes.get(..MOST).unwrap_or(bytes);
    let text: String = String::from_utf8_lossy(start).escape_debug().collect();
    if bytes.len() > MOST { text + "..." } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(lines: &mut Lines, mut bytes: &[u8]) -> Vec<(usize, Vec<u8>)> {
        let mut next = || lines.next(&mut bytes).unwrap().map(|(number, line)| (number, line.to_vec()));
        std::iter::from_fn(&mut next).collect()
    }

    #[test]
    fn lines_keep_count_of_blanks_and_offsets() {
        let mut bytes = &b"a\r\n\n b\nc"[..];
        let mut lines = Lines::new(0, 0);
        assert_eq!(lines.next(&mut bytes), Ok(Some((1, &b"a"[..]))));
        assert_eq!(lines.offset(), 3);
        assert_eq!(lines.next_filled(&mut bytes), Ok(Some((3, &b" b"[..]))));
        assert_eq!(lines.next(&mut bytes), Ok(Some((4, &b"c"[..]))));
        assert_eq!((lines.next(&mut bytes), lines.offset(), lines.read()), (Ok(None), 8, 4));
    }

    #[test]
    fn lines_longer_than_a_window_and_of_old_machines() {
        for length in [USUAL_LINE - 1, USUAL_LINE, USUAL_LINE + 1, 9 * USUAL_LINE] {
            let text = [&vec![b'x'; length][..], b"\nend"].concat();
            let found = all(&mut Lines::new(0, 0), &text);
            assert_eq!(found, [(1, vec![b'x'; length]), (2, b"end".to_vec())]);
        }
        let mut text = &b"1\r2"[..];
        assert_eq!(
            all(&mut Lines::of_text(&mut text, 0).unwrap(), text),
            [(1, b"1".to_vec()), (2, b"2".to_vec())]
        );
        // The first line end of the other kind may be far away.
        let far = [&vec![b'\r'; PIECE + 7][..], b"\n"].concat();
        assert_eq!(all(&mut Lines::of_text(&mut &far[..], 0).unwrap(), &far).len(), 1);
    }

    #[test]
    fn messages_are_short_and_readable() {
        assert_eq!(shown(b"\xff\n"), "\u{fffd}\\n");
        assert_eq!(shown(&[b'a'; 1000]).len(), 63);
    }
}
