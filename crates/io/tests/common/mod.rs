//! What the tests of this crate share.
#![allow(dead_code, missing_docs, clippy::missing_panics_doc)]

use std::path::{Path, PathBuf};

use png::{BitDepth, ColorType};
use proptest::prelude::*;
use terrace_types::Pose;

/// A PNG of raw channel bytes.
pub fn png(width: u32, height: u32, colour: ColorType, bits: BitDepth, data: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(colour);
    encoder.set_depth(bits);
    if colour == ColorType::Indexed {
        encoder.set_palette(vec![0; 768]);
    }
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(data).unwrap();
    writer.finish().unwrap();
    bytes
}

/// A depth PNG.
pub fn depth_png(width: u32, raw: &[u16]) -> Vec<u8> {
    let data: Vec<u8> = raw.iter().flat_map(|r| r.to_be_bytes()).collect();
    png(width, raw.len() as u32 / width, ColorType::Grayscale, BitDepth::Sixteen, &data)
}

pub fn write(path: &Path, bytes: impl AsRef<[u8]>) {
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(path, bytes).unwrap();
}

/// A pose whose rotation is any.
pub fn poses() -> impl Strategy<Value = ([f64; 3], [f64; 4])> {
    let quaternion = prop::array::uniform4(-1.0..1.0_f64)
        .prop_filter("a direction", |q| q.iter().map(|x| x * x).sum::<f64>() > 0.01);
    (prop::array::uniform3(-1000.0..1000.0_f64), quaternion)
}

pub fn matrix(pose: &Pose) -> [[f64; 4]; 4] {
    let (r, t) = (pose.rotation(), pose.translation());
    let row = |i: usize| [r[i][0], r[i][1], r[i][2], t[i]];
    [row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]]
}

/// Largest difference between the entries of two poses.
pub fn difference(a: &Pose, b: &Pose) -> f64 {
    let (a, b) = (matrix(a), matrix(b));
    a.iter().flatten().zip(b.iter().flatten()).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
}

/// A file or folder of the development scans, which do not come with the repository: `TERRACE_DATA`, or `shared/data`
/// beside the repository. `None`, with a message, when it is not there.
pub fn data(name: &str) -> Option<PathBuf> {
    let root = std::env::var_os("TERRACE_DATA")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"), PathBuf::from);
    let path = root.join(name);
    if path.exists() {
        Some(path)
    } else {
        eprintln!("skipped: no {name} in the folder of scans (set TERRACE_DATA)");
        None
    }
}
