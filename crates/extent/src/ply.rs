//! Meshes as PLY.

use std::io::{self, Write};

use crate::Mesh;

impl Mesh {
    /// Writes the mesh as binary little-endian PLY: `double x y z` in metres, `float nx ny nz`, `uchar red green blue`, and
    /// faces of three `vertex_indices` each. Many small writes: give it a buffered writer.
    ///
    /// # Errors
    /// What `out` answers.
    pub fn write_ply(&self, out: &mut dyn Write) -> io::Result<()> {
        write!(
            out,
            "ply\nformat binary_little_endian 1.0\ncomment terrace: lengths in metres\n\
             element vertex {}\n\
             property double x\nproperty double y\nproperty double z\n\
             property float nx\nproperty float ny\nproperty float nz\n\
             property uchar red\nproperty uchar green\nproperty uchar blue\n\
             element face {}\nproperty list uchar int vertex_indices\nend_header\n",
            self.positions.len(),
            self.triangles.len()
        )?;
        let mut record = Vec::with_capacity(39);
        for (position, (colour, normal)) in self.positions.iter().zip(self.attributes()) {
            record.clear();
            record.extend(position.iter().flat_map(|x| x.to_le_bytes()));
            record.extend(normal.iter().flat_map(|x| single(*x).to_le_bytes()));
            record.extend(colour);
            out.write_all(&record)?;
        }
        for triangle in &self.triangles {
            record.clear();
            record.push(3);
            record.extend(triangle.iter().flat_map(|k| k.to_le_bytes()));
            out.write_all(&record)?;
        }
        Ok(())
    }
}

#[expect(clippy::cast_possible_truncation, reason = "single precision is what the file holds")]
pub(crate) fn single(value: f64) -> f32 {
    value as f32
}
