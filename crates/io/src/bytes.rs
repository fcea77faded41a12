//! Bytes of a file by their place: held in memory, or read piece by piece.

use std::borrow::Cow;
use std::convert::Infallible;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};

/// Bytes read from a file at a time. Larger pieces leave the cache before they are decoded.
pub(crate) const PIECE: usize = 1 << 18;

/// The longest piece that is read from a file at once, such as a line.
const LONGEST_PIECE: usize = 1 << 30;

/// What the readers of point files read from.
pub(crate) trait Bytes {
    /// Why bytes could not be had.
    type Error;

    /// How many there are.
    fn length(&self) -> u64;

    /// `size` bytes from `at` on, or as many as there are.
    fn window(&mut self, at: u64, size: usize) -> Result<&[u8], Self::Error>;

    /// As [`window`](Self::window), for what can only be used as a whole.
    fn whole(&mut self, at: u64, size: usize) -> Result<Cow<'_, [u8]>, Self::Error>;

    /// How many there are from `at` on; as many as this machine can count when there are more.
    fn left(&self, at: u64) -> usize {
        usize::try_from(self.length().saturating_sub(at)).unwrap_or(usize::MAX)
    }
}

/// Why a reader ended: by what the bytes are, or because they could not be had.
#[derive(Debug)]
pub(crate) enum Failure<E, I> {
    Content(E),
    Input(I),
}

/// What a reader of bytes `B` returns.
pub(crate) type Outcome<T, E, B> = Result<T, Failure<E, <B as Bytes>::Error>>;

impl<E, I> From<E> for Failure<E, I> {
    fn from(content: E) -> Self {
        Self::Content(content)
    }
}

impl<E> Failure<E, Infallible> {
    /// What is wrong with bytes in memory.
    pub(crate) fn content(self) -> E {
        match self {
            Self::Content(error) => error,
            Self::Input(never) => match never {},
        }
    }
}

/// A place in a file as errors tell it.
pub(crate) fn place(at: u64) -> usize {
    usize::try_from(at).unwrap_or(usize::MAX)
}

impl Bytes for &[u8] {
    type Error = Infallible;

    fn length(&self) -> u64 {
        self.len() as u64
    }

    fn window(&mut self, at: u64, size: usize) -> Result<&[u8], Infallible> {
        let rest = usize::try_from(at).ok().and_then(|at| self.get(at..)).unwrap_or_default();
        Ok(rest.get(..size).unwrap_or(rest))
    }

    fn whole(&mut self, at: u64, size: usize) -> Result<Cow<'_, [u8]>, Infallible> {
        self.window(at, size).map(Cow::Borrowed)
    }
}

/// A file of which a piece is held in memory.
#[derive(Debug)]
pub(crate) struct FileBytes {
    /// Stands behind the last byte of the buffer.
    file: File,
    length: u64,
    buffer: Vec<u8>,
    /// How much of the buffer holds bytes of the file, and the place of the first.
    filled: usize,
    from: u64,
}

impl FileBytes {
    /// A file of `length` bytes that was just opened.
    pub(crate) fn new(file: File, length: u64) -> Self {
        Self { file, length, buffer: Vec::new(), filled: 0, from: 0 }
    }

    /// About how many of the bytes were read so far.
    pub(crate) fn reached(&self) -> u64 {
        self.from.saturating_add(self.filled as u64).min(self.length)
    }

    /// Makes the buffer start at `at` and hold `size` bytes at least.
    fn fill(&mut self, at: u64, size: usize) -> io::Result<()> {
        let held = at.checked_sub(self.from).and_then(|skip| usize::try_from(skip).ok());
        if let Some(skip) = held.filter(|skip| *skip <= self.filled) {
            self.buffer.copy_within(skip..self.filled, 0);
            self.filled -= skip;
        } else {
            self.filled = 0;
            self.file.seek(SeekFrom::Start(at))?;
        }
        self.from = at;
        if self.buffer.len() < size.max(PIECE) {
            self.buffer.resize(size.max(PIECE), 0);
        }
        while self.filled < size {
            let room = self.buffer.get_mut(self.filled..).unwrap_or_default();
            match self.file.read(room) {
                Ok(0) => return Err(shorter(self.length)),
                Ok(read) => self.filled += read,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }
}

fn shorter(length: u64) -> io::Error {
    let message = format!("the file had {length} bytes when it was opened, and has fewer now");
    io::Error::new(io::ErrorKind::UnexpectedEof, message)
}

impl Bytes for FileBytes {
    type Error = io::Error;

    fn length(&self) -> u64 {
        self.length
    }

    fn window(&mut self, at: u64, size: usize) -> io::Result<&[u8]> {
        let size = size.min(self.left(at));
        if size > LONGEST_PIECE {
            let message = format!("from byte {at} on a line or record is longer than {LONGEST_PIECE} bytes");
            return Err(io::Error::new(io::ErrorKind::InvalidData, message));
        }
        let held = at.checked_sub(self.from).and_then(|skip| usize::try_from(skip).ok());
        let start = if let Some(skip) = held.filter(|skip| skip.saturating_add(size) <= self.filled) {
            skip
        } else {
            self.fill(at, size)?;
            0
        };
        Ok(self.buffer.get(start..start + size).unwrap_or_default())
    }

    fn whole(&mut self, at: u64, size: usize) -> io::Result<Cow<'_, [u8]>> {
        let size = size.min(self.left(at));
        // The buffer no longer tells where the file stands.
        self.filled = 0;
        self.from = u64::MAX;
        self.file.seek(SeekFrom::Start(at))?;
        let mut bytes = vec![0; size];
        self.file.read_exact(&mut bytes).map_err(|error| match error.kind() {
            io::ErrorKind::UnexpectedEof => shorter(self.length),
            _ => error,
        })?;
        Ok(Cow::Owned(bytes))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::io::Write;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn windows_of_a_file_are_those_of_its_bytes(
            length in 0..3 * PIECE,
            windows in prop::collection::vec((any::<prop::sample::Index>(), 0..2 * PIECE, any::<bool>()), 1..20),
        ) {
            let all: Vec<u8> = (0_u32..).map(|i| i.wrapping_mul(2_654_435_761).to_le_bytes()[3]).take(length).collect();
            let mut file = tempfile::tempfile().unwrap();
            file.write_all(&all).unwrap();
            file.rewind().unwrap();
            let (mut in_file, mut in_memory) = (FileBytes::new(file, length as u64), &all[..]);
            let mut at = 0;
            for (index, size, whole) in windows {
                // Every other window follows the one before.
                at = if size % 2 == 0 { index.index(length + 10) as u64 } else { at };
                if whole {
                    prop_assert!(in_file.whole(at, size).unwrap() == in_memory.whole(at, size).unwrap());
                } else {
                    prop_assert!(in_file.window(at, size).unwrap() == in_memory.window(at, size).unwrap());
                }
                at += size as u64 / 2;
            }
        }
    }

    #[test]
    fn a_file_that_shrinks_is_told() {
        let mut file = tempfile::tempfile().unwrap();
        file.write_all(b"12345").unwrap();
        file.rewind().unwrap();
        let mut bytes = FileBytes::new(file, 9);
        assert_eq!(bytes.window(0, 5).unwrap(), b"12345");
        assert!(bytes.window(2, 7).unwrap_err().to_string().contains("9 bytes"));
        assert!(bytes.whole(2, 7).unwrap_err().to_string().contains("9 bytes"));
    }
}
