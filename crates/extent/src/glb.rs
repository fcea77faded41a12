//! Meshes as binary glTF.

use std::io::{self, Write};

use serde_json::json;

use crate::Mesh;
use crate::ply::single;

/// Numbers of the specification: types of components, targets of buffers.
const FLOAT: u32 = 5126;
const UNSIGNED_BYTE: u32 = 5121;
const UNSIGNED_INT: u32 = 5125;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

impl Mesh {
    /// Writes the mesh as binary glTF 2.0 (GLB), for viewers and browsers.
    ///
    /// Positions are in single precision, from an origin in whole metres near the middle of the mesh; the translation of
    /// the node `planes` takes them to the world, so that large coordinates lose nothing. Its parent, `terrace`, turns the
    /// world's z up into the y up of glTF. Colours are those of the vertices (`COLOR_0`), brought to the linear scale that
    /// glTF asks for; both sides of a triangle are visible. A mesh without triangles is the node `terrace` alone.
    ///
    /// # Errors
    /// What `out` answers, and [`io::ErrorKind::InvalidInput`] when the mesh takes more than the 4 GiB the format can hold.
    pub fn write_glb(&self, out: &mut dyn Write) -> io::Result<()> {
        let (document, buffer) = self.gltf();
        let mut document = document.to_string().into_bytes();
        document.resize(document.len().next_multiple_of(4), b' ');
        let mut chunks = vec![(&document, b"JSON")];
        if !buffer.is_empty() {
            chunks.push((&buffer, b"BIN\0"));
        }
        let total = 12 + chunks.iter().map(|(chunk, _)| 8 + chunk.len()).sum::<usize>();
        out.write_all(b"glTF")?;
        out.write_all(&2_u32.to_le_bytes())?;
        out.write_all(&size(total)?)?;
        for (chunk, kind) in chunks {
            out.write_all(&size(chunk.len())?)?;
            out.write_all(kind)?;
            out.write_all(chunk)?;
        }
        Ok(())
    }

    /// The document, and the buffer: positions, normals, colours and indices one after the other.
    fn gltf(&self) -> (serde_json::Value, Vec<u8>) {
        let asset = json!({"version": "2.0", "generator": "terrace"});
        // Accessors of nothing are not allowed.
        let Some([low, high]) = bounds(&self.positions).filter(|_| !self.triangles.is_empty()) else {
            return (
                json!({"asset": asset, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"name": "terrace"}]}),
                Vec::new(),
            );
        };
        let origin = [0, 1, 2].map(|i| f64::midpoint(low[i], high[i]).round());
        let local = |p: [f64; 3]| [0, 1, 2].map(|i| single(p[i] - origin[i]));

        let mut views = Vec::new();
        let mut buffer: Vec<u8> = Vec::new();
        let mut view = |bytes: &mut dyn Iterator<Item = u8>, target: u32| {
            let offset = buffer.len();
            buffer.extend(bytes);
            let length = buffer.len() - offset;
            views.push(json!({"buffer": 0, "byteOffset": offset, "byteLength": length, "target": target}));
        };
        let floats = |values: [f32; 3]| values.into_iter().flat_map(f32::to_le_bytes);
        view(&mut self.positions.iter().flat_map(|p| floats(local(*p))), ARRAY_BUFFER);
        view(&mut self.attributes().flat_map(|(_, normal)| floats(normal.map(single))), ARRAY_BUFFER);
        // A fourth byte, for each must start at a multiple of four.
        let colours = self.parts.iter().flat_map(|part| {
            let [red, green, blue] = part.colour.map(linear);
            std::iter::repeat_n([red, green, blue, 255], part.vertices)
        });
        view(&mut colours.flatten(), ARRAY_BUFFER);
        view(&mut self.triangles.iter().flatten().flat_map(|k| k.to_le_bytes()), ELEMENT_ARRAY_BUFFER);

        let (vertices, indices) = (self.positions.len(), 3 * self.triangles.len());
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let document = json!({
            "asset": asset,
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": [
                {"name": "terrace", "rotation": [-half, 0.0, 0.0, half], "children": [1]},
                {"name": "planes", "translation": origin, "mesh": 0}
            ],
            "meshes": [{"name": "planes", "primitives": [{
                "attributes": {"POSITION": 0, "NORMAL": 1, "COLOR_0": 2}, "indices": 3, "material": 0
            }]}],
            "materials": [{
                "name": "plane",
                "doubleSided": true,
                "pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 1.0}
            }],
            "accessors": [
                {"bufferView": 0, "componentType": FLOAT, "count": vertices, "type": "VEC3",
                 "min": local(low), "max": local(high)},
                {"bufferView": 1, "componentType": FLOAT, "count": vertices, "type": "VEC3"},
                {"bufferView": 2, "componentType": UNSIGNED_BYTE, "normalized": true, "count": vertices, "type": "VEC4"},
                {"bufferView": 3, "componentType": UNSIGNED_INT, "count": indices, "type": "SCALAR"}
            ],
            "bufferViews": views,
            "buffers": [{"byteLength": buffer.len()}]
        });
        (document, buffer)
    }
}

fn size(bytes: usize) -> io::Result<[u8; 4]> {
    let refused = |_| {
        io::Error::new(
            io::ErrorKind::InvalidInput,
            format!("{bytes} bytes are more than a GLB file can hold"),
        )
    };
    u32::try_from(bytes).map(u32::to_le_bytes).map_err(refused)
}

/// Smallest and largest coordinates.
fn bounds(positions: &[[f64; 3]]) -> Option<[[f64; 3]; 2]> {
    let first = *positions.first()?;
    Some(positions.iter().fold([first, first], |[low, high], p| {
        [[0, 1, 2].map(|i| low[i].min(p[i])), [0, 1, 2].map(|i| high[i].max(p[i]))]
    }))
}

/// A part of a colour from sRGB to the linear scale.
fn linear(value: u8) -> u8 {
    let encoded = f64::from(value) / 255.0;
    let linear = if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) };
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 0 to 255")]
    let byte = (linear * 255.0).round() as u8;
    byte
}
