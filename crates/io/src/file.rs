//! Errors of files: which file, and what about it.

use std::io;
use std::path::{Path, PathBuf};

/// What went wrong with a file as a whole: it could not be read, or its content was refused.
#[derive(Debug, thiserror::Error)]
pub enum FileError<E: std::error::Error + 'static> {
    /// The operating system did not hand over the file.
    #[error("{}: {error}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system says.
        error: io::Error,
    },
    /// The file was read, but it does not hold what it should.
    #[error("{}: {error}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// What is wrong with its content.
        error: E,
    },
}

impl<E: std::error::Error + 'static> FileError<E> {
    /// The file.
    pub fn path(&self) -> &Path {
        match self {
            Self::Io { path, .. } | Self::Content { path, .. } => path,
        }
    }
}

/// Reads `path` and gives its bytes to `parse`; whatever fails names the file.
pub(crate) fn open_with<T, E: std::error::Error + 'static>(
    path: &Path,
    parse: impl FnOnce(&[u8]) -> Result<T, E>,
) -> Result<T, FileError<E>> {
    let bytes = std::fs::read(path).map_err(|error| FileError::Io { path: path.to_owned(), error })?;
    parse(&bytes).map_err(|error| FileError::Content { path: path.to_owned(), error })
}
