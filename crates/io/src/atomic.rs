//! Output files that are there whole or not at all.

use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use crate::unfinished::Unfinished;

/// Bytes gathered before they are handed to the system.
const BUFFER: usize = 1 << 16;

/// Why a file could not be written. Nothing is left behind: an older file of that name stands as it was.
#[derive(Debug, thiserror::Error)]
#[error("{}: {kind}", path.display())]
pub struct WriteError {
    /// The file that was to be written.
    pub path: PathBuf,
    /// What went wrong.
    pub kind: WriteErrorKind,
}

/// What went wrong in writing.
#[derive(Debug, thiserror::Error)]
pub enum WriteErrorKind {
    /// The operating system refused.
    #[error("cannot be written: {0}")]
    Io(#[from] io::Error),
    /// There were more or fewer records than the header of the file was told.
    #[error("{found} records were given where {expected} were announced")]
    Count {
        /// Number announced.
        expected: u64,
        /// Number given; one more than announced when there were too many.
        found: u64,
    },
    /// A number that must be finite is not.
    #[error("{what} holds {value}, which is not finite")]
    NotFinite {
        /// Which number, such as `planes[3].rms`.
        what: String,
        /// The value.
        value: f64,
    },
}

/// Writes a file aside, in the same folder, and renames it into place when it is complete and on disk. Missing folders
/// are made.
///
/// ```
/// use terrace_io::write_atomically;
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("new/note.txt");
/// write_atomically(&path, |out| Ok(out.write_all(b"flat ground")?))?;
/// assert_eq!(std::fs::read(&path)?, b"flat ground");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`WriteError`] with what `write` returned, or when the folder cannot be made or the file not be written or renamed.
pub fn write_atomically(
    path: &Path,
    write: impl FnOnce(&mut (dyn Write + Send)) -> Result<(), WriteErrorKind>,
) -> Result<(), WriteError> {
    write_aside(path, write).map_err(|kind| WriteError { path: path.to_owned(), kind })
}

fn write_aside(
    path: &Path,
    write: impl FnOnce(&mut (dyn Write + Send)) -> Result<(), WriteErrorKind>,
) -> Result<(), WriteErrorKind> {
    let mut file = FileAside::create(path)?;
    write(&mut file)?;
    file.finish()
}

/// A file that is written aside and gets its name when it is finished. One that is dropped before is removed.
#[derive(Debug)]
pub(crate) struct FileAside {
    path: PathBuf,
    out: BufWriter<Unfinished>,
}

impl FileAside {
    /// Makes missing folders and a file beside `path`.
    pub(crate) fn create(path: &Path) -> Result<Self, WriteErrorKind> {
        // A bare file name has the empty path as its parent.
        let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        std::fs::create_dir_all(folder)?;
        let mut builder = tempfile::Builder::new();
        // Temporary files are private by default; an output is as readable as any file the user makes.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        builder.prefix(".terrace-").suffix(".part");
        let file = Unfinished::create(|| builder.tempfile_in(folder))?;
        Ok(Self { path: path.to_owned(), out: BufWriter::with_capacity(BUFFER, file) })
    }

    /// Puts the file on disk and renames it into place.
    pub(crate) fn finish(self) -> Result<(), WriteErrorKind> {
        let file = self.out.into_inner().map_err(io::IntoInnerError::into_error)?;
        Ok(file.persist(&self.path)?)
    }

    /// The name that the file will have.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }
}

impl Write for FileAside {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.out.write(bytes)
    }

    fn write_all(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.out.write_all(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}
