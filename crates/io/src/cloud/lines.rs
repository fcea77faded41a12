//! Text split into numbered lines and numbers, with nothing asked of its encoding.

/// Lines of a file with their numbers, without the line end (`\n` or `\r\n`).
pub(crate) struct Lines<'a> {
    bytes: &'a [u8],
    at: usize,
    read: usize,
    end: u8,
}

impl<'a> Lines<'a> {
    /// From byte `at` on, before which there are `read` lines.
    pub(crate) fn new(bytes: &'a [u8], at: usize, read: usize) -> Self {
        Self { bytes, at, read, end: b'\n' }
    }

    /// A whole file, which may end its lines with `\r` alone.
    pub(crate) fn of_text(bytes: &'a [u8]) -> Self {
        let end = if bytes.contains(&b'\n') { b'\n' } else { b'\r' };
        Self { bytes, at: 0, read: 0, end }
    }

    /// Byte offset of the line that comes next.
    pub(crate) fn offset(&self) -> usize {
        self.at
    }

    /// How many lines were read.
    pub(crate) fn read(&self) -> usize {
        self.read
    }

    /// The next line that holds more than white space.
    pub(crate) fn next_filled(&mut self) -> Option<(usize, &'a [u8])> {
        self.find(|(_, line)| !line.trim_ascii().is_empty())
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = (usize, &'a [u8]);

    fn next(&mut self) -> Option<Self::Item> {
        let rest = self.bytes.get(self.at..).filter(|rest| !rest.is_empty())?;
        let length = rest.iter().position(|b| *b == self.end).unwrap_or(rest.len());
        let line = rest.get(..length).unwrap_or(rest);
        self.at += (length + 1).min(rest.len());
        self.read += 1;
        Some((self.read, line.strip_suffix(b"\r").unwrap_or(line)))
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

    #[test]
    fn lines_keep_count_of_blanks_and_offsets() {
        let mut lines = Lines::new(b"a\r\n\n b\nc", 0, 0);
        assert_eq!(lines.next(), Some((1, &b"a"[..])));
        assert_eq!(lines.offset(), 3);
        assert_eq!(lines.next_filled(), Some((3, &b" b"[..])));
        assert_eq!(lines.next(), Some((4, &b"c"[..])));
        assert_eq!((lines.next(), lines.offset(), lines.read()), (None, 8, 4));
        assert_eq!(Lines::of_text(b"1\r2").map(|(_, line)| line).collect::<Vec<_>>(), [b"1", b"2"]);
    }

    #[test]
    fn messages_are_short_and_readable() {
        assert_eq!(shown(b"\xff\n"), "\u{fffd}\\n");
        assert_eq!(shown(&[b'a'; 1000]).len(), 63);
    }
}
