//! Polygons as values of JSON.

use serde::{Serialize, Serializer, ser::SerializeMap};

use crate::{ExtentError, Footprint, OutlineOptions, PlaneFrame, Polygon};

/// How far a plane reaches: its polygons with the frame they are in.
///
/// Serialises as
///
/// ```json
/// {
///   "frame": {"origin": [0, 0, 1], "axes": [[1, 0, 0], [0, 1, 0]], "normal": [0, 0, 1]},
///   "area": 12.0,
///   "polygons": {"type": "MultiPolygon", "coordinates": [[[[0, 0], [4, 0], [4, 3], [0, 3], [0, 0]]]]},
///   "world": [[[[0, 0, 1], [4, 0, 1], [4, 3, 1], [0, 3, 1], [0, 0, 1]]]]
/// }
/// ```
///
/// Lengths are in metres, `area` in square metres. `polygons` is a geometry of GeoJSON in the frame of the plane, with
/// `world = origin + u · axes[0] + v · axes[1]`; `world` has the same rings in the same order. For each polygon the outer
/// ring comes first, counter-clockwise seen from where the normal points, then its holes, clockwise. Rings are closed:
/// the last point is the first.
#[derive(Debug, Clone, PartialEq)]
pub struct PlaneExtent {
    frame: PlaneFrame,
    polygons: Vec<Polygon>,
}

impl PlaneExtent {
    /// What a footprint covers. See [`Footprint::outline`].
    ///
    /// # Errors
    /// As [`Footprint::outline`].
    pub fn of(footprint: &Footprint, options: &OutlineOptions) -> Result<Self, ExtentError> {
        Ok(Self { frame: *footprint.frame(), polygons: footprint.outline(options)? })
    }

    /// The frame of the plane.
    pub fn frame(&self) -> &PlaneFrame {
        &self.frame
    }

    /// The polygons in that frame, the largest first.
    pub fn polygons(&self) -> &[Polygon] {
        &self.polygons
    }

    /// Area of all polygons in square metres.
    pub fn area(&self) -> f64 {
        self.polygons.iter().map(Polygon::area).sum()
    }

    /// The rings of each polygon with every point as `place` has it, closed.
    fn rings<P: Copy>(&self, place: impl Fn([f64; 2]) -> P) -> Vec<Vec<Vec<P>>> {
        let closed = |ring: &[[f64; 2]]| ring.iter().chain(ring.first()).map(|p| place(*p)).collect();
        self.polygons.iter().map(|polygon| polygon.rings().map(closed).collect()).collect()
    }
}

impl Serialize for PlaneExtent {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct MultiPolygon {
            r#type: &'static str,
            coordinates: Vec<Vec<Vec<[f64; 2]>>>,
        }
        let mut map = serializer.serialize_map(Some(4))?;
        map.serialize_entry("frame", &self.frame)?;
        map.serialize_entry("area", &self.area())?;
        let coordinates = self.rings(|p| p);
        map.serialize_entry("polygons", &MultiPolygon { r#type: "MultiPolygon", coordinates })?;
        map.serialize_entry("world", &self.rings(|p| self.frame.to_world(p)))?;
        map.end()
    }
}
