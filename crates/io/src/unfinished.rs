//! Output files that have no name yet, and how a program that is interrupted removes them.

use std::collections::BTreeSet;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::NamedTempFile;

/// All files of this process that are being written.
static ALL: Mutex<Register> = Mutex::new(Register { paths: BTreeSet::new(), abandoned: false });

struct Register {
    paths: BTreeSet<PathBuf>,
    /// Whether no file may get a name any more.
    abandoned: bool,
}

fn all() -> MutexGuard<'static, Register> {
    // Nothing panics while it holds the register, and a set of paths would be whole even then.
    ALL.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes all output files that this process has begun and not finished, wherever they are. From then on no output of
/// this crate can be begun or finished: those that try fail with [`WriteErrorKind::Io`](crate::WriteErrorKind::Io). Files
/// that are finished stay.
///
/// For a program that is about to end without unwinding, because the user interrupts it, say: writers that are merely
/// dropped remove their files themselves. It may be called from any thread, but not from within a signal handler, where
/// no lock may be taken; the `ctrlc` crate calls from a thread.
pub fn abandon_outputs() {
    let mut all = all();
    all.abandoned = true;
    for path in std::mem::take(&mut all.paths) {
        // One that cannot be removed must not keep the others.
        let _ = std::fs::remove_file(path);
    }
}

/// A file without its name. Dropped, it is removed.
#[derive(Debug)]
pub(crate) struct Unfinished {
    file: Option<NamedTempFile>,
    path: PathBuf,
}

impl Unfinished {
    pub(crate) fn create(make: impl FnOnce() -> io::Result<NamedTempFile>) -> io::Result<Self> {
        // Held until the path is in the register, so that no file escapes between the two.
        let mut all = all();
        if all.abandoned {
            return Err(interrupted());
        }
        let file = make()?;
        // Absolute, for the program may go to another folder.
        let path = std::path::absolute(file.path())?;
        all.paths.insert(path.clone());
        Ok(Self { file: Some(file), path })
    }

    /// Puts the file on disk and renames it.
    pub(crate) fn persist(mut self, to: &Path) -> io::Result<()> {
        let Some(file) = self.file.take() else { return Err(interrupted()) };
        file.as_file().sync_all()?;
        let all = all();
        if all.abandoned {
            return Err(interrupted());
        }
        file.persist(to).map_err(|error| error.error)?;
        Ok(())
    }
}

impl Write for Unfinished {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.as_mut().ok_or_else(interrupted)?.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.as_mut().ok_or_else(interrupted)?.flush()
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        // The file goes before its path leaves the register, and neither without the other.
        let mut all = all();
        self.file = None;
        all.paths.remove(&self.path);
    }
}

fn interrupted() -> io::Error {
    io::Error::other("the program was interrupted")
}
