//! Labels and planes from files.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Deserialize;
use terrace_eval::PlaneAt;
use terrace_io::planes_json::PlanesFile;
use terrace_io::{FieldChoice, npy, pcd, ply};
use terrace_types::{Plane, PlaneId, Sigma};

use crate::commands::eval::error::FileKind;

/// A plane with its name, where it has one.
#[derive(Debug, Clone)]
pub struct NamedPlane {
    pub at: PlaneAt,
    pub name: Option<String>,
}

pub type Planes = BTreeMap<PlaneId, NamedPlane>;

/// Reads one label per point.
pub fn labels(path: &Path, field: &str) -> Result<Vec<i32>, FileKind> {
    let bytes = bytes(path)?;
    let extension = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
    let named = FieldChoice::Named(field.to_owned());
    let cloud = match extension.as_deref() {
        _ if bytes.starts_with(b"\x93NUMPY") => return Ok(npy::read_labels(&bytes)?),
        Some("npy") => return Ok(npy::read_labels(&bytes)?),
        Some("pcd") => pcd::read(&bytes, &named)?,
        Some("ply") => ply::read(&bytes, &named)?,
        _ if bytes.starts_with(b"ply") => ply::read(&bytes, &named)?,
        _ if bytes.starts_with(b"# .PCD") => pcd::read(&bytes, &named)?,
        _ => return Err(FileKind::Format),
    };
    // The readers give the field that is asked for by name as standard errors.
    let Sigma::PerPoint(values) = cloud.sigma else { return Err(FileKind::Format) };
    values
        .into_iter()
        .enumerate()
        .map(|(point, value)| whole(value).ok_or(FileKind::NotWhole { point, value }))
        .collect()
}

fn whole(value: f64) -> Option<i32> {
    let fits = value.fract() == 0.0 && (f64::from(i32::MIN)..=f64::from(i32::MAX)).contains(&value);
    #[expect(clippy::cast_possible_truncation, reason = "whole and in range")]
    fits.then_some(value as i32)
}

/// A plane `normal . x = offset`, as other programs write it under its number.
#[derive(Deserialize)]
struct ByNumber {
    name: Option<String>,
    normal: [f64; 3],
    offset: f64,
    centroid: Option<[f64; 3]>,
}

/// Reads planes: `planes.json` of terrace, or an object of planes by number.
pub fn planes(path: &Path) -> Result<Planes, FileKind> {
    let bytes = bytes(path)?;
    if let Ok(by_number) = serde_json::from_slice::<BTreeMap<u32, ByNumber>>(&bytes) {
        let planes = by_number.into_iter().map(|(id, p)| named(id, p.normal, p.offset, p.centroid, p.name));
        return Ok(planes.collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect());
    }
    let planes = PlanesFile::from_json(&bytes)?.planes.into_iter().map(|p| {
        let [a, b, c, d] = p.coefficients;
        named(p.id, [a, b, c], -d, p.centroid, p.name)
    });
    Ok(planes.collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect())
}

/// `None` for a number that is no label of a plane.
fn named(
    id: u32,
    normal: [f64; 3],
    offset: f64,
    centre: Option<[f64; 3]>,
    name: Option<String>,
) -> Result<Option<(PlaneId, NamedPlane)>, FileKind> {
    let length_squared: f64 = normal.iter().map(|x| x * x).sum();
    let plane = Plane::through(normal.map(|x| x * offset / length_squared), normal)
        .map_err(|error| FileKind::Plane { id, error })?;
    Ok(PlaneId::new(id).map(|id| (id, NamedPlane { at: PlaneAt { plane, centre }, name })))
}

fn bytes(path: &Path) -> Result<Vec<u8>, FileKind> {
    // Reading a device or a pipe might never end.
    if !std::fs::metadata(path)?.is_file() {
        return Err(FileKind::NotAFile);
    }
    Ok(std::fs::read(path)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_are_whole_numbers_of_32_bits() {
        assert_eq!([0.0, -1.0, 7.0, -0.0].map(whole), [Some(0), Some(-1), Some(7), Some(0)]);
        assert_eq!([0.5, f64::NAN, f64::INFINITY, 2_147_483_648.0].map(whole), [None; 4]);
        assert_eq!(whole(-2_147_483_648.0), Some(i32::MIN));
    }
}
