//! Meshes as Wavefront OBJ.

use std::io::{self, Write};

use crate::Mesh;

impl Mesh {
    /// Writes the mesh as Wavefront OBJ: an object `plane_1`, `plane_2` … for each plane added, by its number, with its normal.
    /// Positions are in metres with all their digits, and the colour follows them as red, green and blue from 0 to 1, which most
    /// programs read (`v x y z r g b`). Many small writes: give it a buffered writer.
    ///
    /// # Errors
    /// What `out` answers.
    pub fn write_obj(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(out, "# terrace: lengths in metres, colours after positions")?;
        let (mut positions, mut triangles) = (self.positions.iter(), self.triangles.iter());
        for (place, part) in (1..).zip(&self.parts) {
            writeln!(out, "o plane_{}", part.number)?;
            let [red, green, blue] = part.colour.map(|c| f64::from(c) / 255.0);
            for [x, y, z] in positions.by_ref().take(part.vertices) {
                writeln!(out, "v {x} {y} {z} {red:.4} {green:.4} {blue:.4}")?;
            }
            let [x, y, z] = part.normal;
            writeln!(out, "vn {x} {y} {z}")?;
            for corners in triangles.by_ref().take(part.triangles) {
                // Indices start at 1.
                let [a, b, c] = corners.map(|k| u64::from(k) + 1);
                writeln!(out, "f {a}//{place} {b}//{place} {c}//{place}")?;
            }
        }
        Ok(())
    }
}
