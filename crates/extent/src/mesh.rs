//! Planes cut into triangles.

use earcut::Earcut;

use crate::{ExtentError, PlaneExtent, Polygon};

/// Triangles of several planes with a colour for each plane.
///
/// Triangles run counter-clockwise seen from where the normal of their plane points. Planes share no vertices, so that
/// edges between them stay sharp and colours do not run.
///
/// ```
/// use terrace_extent::{Footprint, Mesh, OutlineOptions, PlaneExtent, PlaneFrame};
/// use terrace_types::Plane;
///
/// let wall = Plane::through([1.0, 0.0, 0.0], [1.0, 0.0, 0.0])?;
/// let mut footprint = Footprint::new(PlaneFrame::new(&wall, [0.0; 3])?, 0.1)?;
/// for k in 0..400 {
///     footprint.add([1.0, f64::from(k % 20) * 0.1, f64::from(k / 20) * 0.1])?;
/// }
/// let mut mesh = Mesh::new();
/// mesh.add(&PlaneExtent::of(&footprint, &OutlineOptions::closing(0.2))?, [200, 40, 40])?;
/// assert!((mesh.area() - 4.0).abs() < 1e-9);
/// let mut glb = Vec::new();
/// mesh.write_glb(&mut glb)?;
/// assert!(glb.starts_with(b"glTF"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mesh {
    pub(crate) positions: Vec<[f64; 3]>,
    pub(crate) triangles: Vec<[u32; 3]>,
    pub(crate) parts: Vec<Part>,
}

/// The vertices and triangles of one plane: those from where the part before ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Part {
    pub(crate) number: u32,
    pub(crate) colour: [u8; 3],
    pub(crate) normal: [f64; 3],
    pub(crate) vertices: usize,
    pub(crate) triangles: usize,
}

impl Mesh {
    /// A mesh of nothing.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds the polygons of a plane in this colour: red, green and blue as screens show them (sRGB). Its number is one
    /// more than that of the plane before, from 1.
    ///
    /// # Errors
    /// As [`Mesh::add_numbered`].
    pub fn add(&mut self, plane: &PlaneExtent, colour: [u8; 3]) -> Result<(), ExtentError> {
        let number = self.parts.last().map_or(1, |part| part.number.saturating_add(1));
        self.add_numbered(number, plane, colour)
    }

    /// Adds the polygons of a plane as [`Mesh::add`] does, under a number of your own: it names the plane in OBJ.
    ///
    /// # Errors
    /// [`ExtentError::TooManyVertices`] when indices of 32 bits run out, [`ExtentError::Triangulation`] when a polygon
    /// was not cut into triangles of its area; the mesh stays as it was.
    pub fn add_numbered(
        &mut self,
        number: u32,
        plane: &PlaneExtent,
        colour: [u8; 3],
    ) -> Result<(), ExtentError> {
        let (mut positions, mut triangles) = (Vec::new(), Vec::new());
        for polygon in plane.polygons() {
            let vertices = self.positions.len() + positions.len();
            let first = u32::try_from(vertices).map_err(|_| ExtentError::TooManyVertices { vertices })?;
            let points: Vec<[f64; 2]> = polygon.rings().flatten().copied().collect();
            let vertices = vertices + points.len();
            u32::try_from(vertices).map_err(|_| ExtentError::TooManyVertices { vertices })?;
            triangles.extend(triangulated(polygon, &points)?.into_iter().map(|t| t.map(|k| k + first)));
            positions.extend(points.iter().map(|p| plane.frame().to_world(*p)));
        }
        let normal = plane.frame().normal();
        let (vertices, of_plane) = (positions.len(), triangles.len());
        self.parts.push(Part { number, colour, normal, vertices, triangles: of_plane });
        self.positions.append(&mut positions);
        self.triangles.append(&mut triangles);
        Ok(())
    }

    /// The vertices in the world, in metres.
    pub fn positions(&self) -> &[[f64; 3]] {
        &self.positions
    }

    /// Indices of the corners of each triangle.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Sum of the areas of the triangles, in square metres.
    pub fn area(&self) -> f64 {
        self.triangles.iter().filter_map(|corners| self.corners(*corners)).map(area).sum()
    }

    fn corners(&self, [a, b, c]: [u32; 3]) -> Option<[[f64; 3]; 3]> {
        let at = |k: u32| self.positions.get(usize::try_from(k).ok()?).copied();
        Some([at(a)?, at(b)?, at(c)?])
    }

    /// Colour and unit normal of each vertex.
    pub(crate) fn attributes(&self) -> impl Iterator<Item = ([u8; 3], [f64; 3])> {
        self.parts.iter().flat_map(|part| std::iter::repeat_n((part.colour, part.normal), part.vertices))
    }
}

/// Triangles of a polygon whose rings, one after the other, are `points`.
fn triangulated(polygon: &Polygon, points: &[[f64; 2]]) -> Result<Vec<[u32; 3]>, ExtentError> {
    let mut starts: Vec<u32> = Vec::new();
    let mut vertices = 0;
    for ring in polygon.rings() {
        vertices += ring.len();
        starts.push(u32::try_from(vertices).map_err(|_| ExtentError::TooManyVertices { vertices })?);
    }
    // What is asked for is where each hole starts: where the ring before it ends.
    starts.pop();
    let mut indices: Vec<u32> = Vec::new();
    Earcut::new().earcut_slice(points, &starts, &mut indices);
    let at = |k: u32| usize::try_from(k).ok().and_then(|k| points.get(k)).copied();
    let (mut triangles, mut total) = (Vec::new(), 0.0);
    let (corners, _) = indices.as_chunks::<3>();
    for &[a, b, c] in corners {
        let (Some(p), Some(q), Some(r)) = (at(a), at(b), at(c)) else { continue };
        let twice = (q[0] - p[0]) * (r[1] - p[1]) - (r[0] - p[0]) * (q[1] - p[1]);
        total += twice.abs() / 2.0;
        // No area is no orientation.
        if twice > 0.0 {
            triangles.push([a, b, c]);
        } else if twice < 0.0 {
            triangles.push([a, c, b]);
        }
    }
    let area = polygon.area();
    if (total - area).abs() <= 1e-9 * area {
        Ok(triangles)
    } else {
        Err(ExtentError::Triangulation { polygon: area, triangles: total })
    }
}

fn area([a, b, c]: [[f64; 3]; 3]) -> f64 {
    let [p, q] = [b, c].map(|x| [x[0] - a[0], x[1] - a[1], x[2] - a[2]]);
    let cross = [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
    (cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]).sqrt() / 2.0
}
