//! Scans that are read in chunks, so that files may be larger than memory.

use std::collections::VecDeque;

use rayon::prelude::*;
use terrace::{Scan, Sigma};
use terrace_io::{ReadError, ReadErrorKind, ReadOptions, ScanReader, Source};

/// Points that are read at once.
const CHUNK: usize = 1 << 17;

/// How scans are read.
#[derive(Clone, Copy)]
pub struct Reading<'a> {
    pub options: &'a ReadOptions,
    /// Whether points alone are read, without their errors.
    pub bare: bool,
    /// What is made of each chunk that was read.
    pub change: &'a (dyn Fn(&Source, Scan) -> Result<Scan, ReadError> + Sync),
}

impl<'a> Reading<'a> {
    /// As the options say.
    pub fn with(options: &'a ReadOptions) -> Self {
        Self { options, bare: false, change: &|_, scan| Ok(scan) }
    }

    /// The points alone, once more: their labels do not depend on their errors.
    pub fn bare(self) -> Self {
        Self { bare: true, change: &|_, scan| Ok(scan), ..self }
    }

    /// Opens a scan and reads its first chunk, which may be empty.
    pub fn begin(self, source: &'a Source) -> Result<(Chunks<'a>, Scan), ReadError> {
        let open = if self.bare { ScanReader::open_bare } else { ScanReader::open };
        let reader = open(source, self.options, CHUNK)?;
        let mut chunks = Chunks { reading: self, source, reader, held: VecDeque::new() };
        if let Some(first) = chunks.next()? {
            return Ok((chunks, first));
        }
        let refused =
            |error| ReadError { path: source.path.clone(), kind: Box::new(ReadErrorKind::Scan(error)) };
        let empty = Scan::new(Vec::new(), Sigma::Unknown, chunks.reader.frame()).map_err(refused)?;
        Ok((chunks, empty))
    }

    /// [Begins](Self::begin) as many scans at a time as there are threads, and hands them out in order.
    pub fn begin_each<E>(
        self,
        sources: &'a [Source],
        mut each: impl FnMut(&'a Source, Result<(Chunks<'a>, Scan), ReadError>) -> Result<(), E>,
    ) -> Result<(), E> {
        sources.chunks(rayon::current_num_threads()).try_for_each(|batch| {
            let begun: Vec<_> = batch.par_iter().map(|source| self.begin(source)).collect();
            batch.iter().zip(begun).try_for_each(|(source, begun)| each(source, begun))
        })
    }
}

/// A scan that is being read.
pub struct Chunks<'a> {
    reading: Reading<'a>,
    source: &'a Source,
    reader: ScanReader,
    /// What was read already and is given again first.
    held: VecDeque<Scan>,
}

impl Chunks<'_> {
    /// The next chunk; `None` at the end.
    pub fn next(&mut self) -> Result<Option<Scan>, ReadError> {
        if let Some(held) = self.held.pop_front() {
            return Ok(Some(held));
        }
        let chunk = self.reader.next_chunk()?;
        chunk.map(|chunk| (self.reading.change)(self.source, chunk)).transpose()
    }

    /// Gives chunks back, all that were read after the first, to come once more.
    pub fn hold(&mut self, chunks: impl IntoIterator<Item = Scan>) {
        self.held.extend(chunks);
    }

    /// Works on a chunk and reads the next one meanwhile, if another thread has time for it; then gives the memory of the first back. What
    /// is wrong with the next is told by the second that is returned, whatever became of the first.
    pub fn next_beside<T: Send>(
        &mut self,
        chunk: Scan,
        work: impl FnOnce(&Scan) -> T + Send,
    ) -> (T, Result<Option<Scan>, ReadError>) {
        if rayon::current_num_threads() == 1 {
            let done = work(&chunk);
            self.recycle(chunk);
            return (done, self.next());
        }
        let both = self.beside(|| work(&chunk));
        self.recycle(chunk);
        both
    }

    /// Does other work and reads the next chunk meanwhile, as [`next_beside`](Self::next_beside).
    pub fn beside<T: Send>(
        &mut self,
        work: impl FnOnce() -> T + Send,
    ) -> (T, Result<Option<Scan>, ReadError>) {
        rayon::join(work, || self.next())
    }

    /// Gives the memory of a chunk back for one of the next.
    pub fn recycle(&mut self, chunk: Scan) {
        self.reader.recycle(chunk);
    }

    /// Points so far that are no measurements by the noise model.
    pub fn not_measured(&self) -> usize {
        self.reader.not_measured()
    }

    /// About how many bytes of the file were read.
    pub fn bytes_read(&self) -> u64 {
        self.reader.bytes_read()
    }
}

/// Bytes of the files, as far as they are known.
pub fn bytes(sources: &[Source]) -> u64 {
    sources.iter().map(length).sum()
}

/// Bytes of a file, 0 if it cannot be asked.
pub fn length(source: &Source) -> u64 {
    std::fs::metadata(&source.path).map_or(0, |file| file.len())
}
