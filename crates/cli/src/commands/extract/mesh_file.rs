//! Files of meshes, whose format is told by how the name ends.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use terrace_extent::Mesh;
use terrace_io::{WriteError, write_atomically};

/// A file that a mesh is written to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MeshFile {
    path: PathBuf,
    format: Format,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Format {
    Ply,
    Obj,
    Glb,
}

/// Why a name is none of a mesh.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum MeshNameError {
    /// There is no ending.
    #[error("the name must tell the format: .ply, .obj or .glb")]
    NoEnding,
    /// No format has this ending.
    #[error("'.{0}' is no format of meshes; .ply, .obj and .glb are")]
    Ending(String),
}

impl MeshFile {
    /// The file at `path`, in the format that its ending names.
    ///
    /// # Errors
    /// [`MeshNameError`] when it names none.
    pub fn new(path: PathBuf) -> Result<Self, MeshNameError> {
        let ending = path.extension().ok_or(MeshNameError::NoEnding)?.to_string_lossy().into_owned();
        let format = match ending.to_ascii_lowercase().as_str() {
            "ply" => Format::Ply,
            "obj" => Format::Obj,
            "glb" => Format::Glb,
            _ => return Err(MeshNameError::Ending(ending)),
        };
        Ok(Self { path, format })
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes the mesh; a damaged file is never left behind.
    ///
    /// # Errors
    /// [`WriteError`] when it cannot be written, or a GLB would have more than 4 GiB.
    pub fn write(&self, mesh: &Mesh) -> Result<(), WriteError> {
        let write = |out: &mut dyn Write| -> io::Result<()> {
            match self.format {
                Format::Ply => mesh.write_ply(out),
                Format::Obj => mesh.write_obj(out),
                Format::Glb => mesh.write_glb(out),
            }
        };
        write_atomically(&self.path, |out| Ok(write(out)?))
    }
}
