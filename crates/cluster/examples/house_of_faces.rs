//! The sides of a house, from the triangles of its mesh.
//!
//! The mesh is a box with a gable roof: each side is several triangles, and the normals are off by a few degrees, as in a
//! mesh made from a scan. Triangles that share an edge are neighbours. No grid, no voxels: the clustering sees normals and
//! neighbours alone.

use std::error::Error;

use terrace_cluster::{Params, segment};
use terrace_stats::UncertainVector;

/// Corners of the house in metres: the ground, the eaves, the ends of the ridge.
const CORNERS: [[f64; 3]; 10] = [
    [0.0, 0.0, 0.0],
    [10.0, 0.1, 0.0],
    [10.0, 8.0, 0.1],
    [0.1, 8.0, 0.0],
    [0.0, 0.1, 5.0],
    [10.1, 0.0, 5.1],
    [10.0, 8.1, 5.0],
    [0.0, 8.0, 4.9],
    [0.0, 4.1, 8.0],
    [10.0, 4.0, 8.1],
];

/// Corners of each triangle, seen from outside against the clock.
const FACES: [[usize; 3]; 14] = [
    [0, 1, 5],
    [0, 5, 4],
    [2, 3, 7],
    [2, 7, 6],
    [1, 2, 6],
    [1, 6, 5],
    [5, 6, 9],
    [3, 0, 4],
    [3, 4, 7],
    [7, 4, 8],
    [4, 5, 9],
    [4, 9, 8],
    [6, 7, 8],
    [6, 8, 9],
];

/// How sure the normals are, per axis.
const ERROR: f64 = 0.03;

fn normal(face: [usize; 3]) -> [f64; 3] {
    let [a, b, c] = face.map(|corner| CORNERS[corner]);
    let (u, v) = ([0, 1, 2].map(|i| b[i] - a[i]), [0, 1, 2].map(|i| c[i] - a[i]));
    let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let length = n.iter().map(|x| x * x).sum::<f64>().sqrt();
    n.map(|x| x / length)
}

/// The triangles that share two corners with this one.
fn neighbours(face: [usize; 3]) -> Vec<u32> {
    let shared = |other: &[usize; 3]| other.iter().filter(|corner| face.contains(corner)).count();
    (0u32..).zip(&FACES).filter(|(_, other)| shared(other) == 2).map(|(number, _)| number).collect()
}

fn main() -> Result<(), Box<dyn Error>> {
    let normals = FACES.map(|face| Some(UncertainVector::isotropic(normal(face), ERROR)));
    let edges = FACES.map(neighbours);

    for (phi, what) in
        [(0.05, "Walls, gables and roof apart"), (0.4, "A threshold too high: the roof runs into the walls")]
    {
        let result = segment(&normals, |face| &edges[face], &Params { phi, ..Params::default() })?;
        println!("{what}: at phi = {phi}, {} triangles make {} sides.", FACES.len(), result.len());
        for side in result.clusters() {
            let ([x, y, z], [sx, sy, sz]) = (side.mean_normal(), side.uncertainty());
            println!(
                "  {} triangles face ({x:5.2}, {y:5.2}, {z:5.2}), give or take ({sx:.2}, {sy:.2}, {sz:.2})",
                side.nodes().len()
            );
        }
        let interval = result.interval();
        let end = interval.hi.map_or("any above".to_string(), |hi| format!("just below {hi:.3}"));
        println!("  The same holds from phi = {:.3} to {end}.\n", interval.lo);
    }
    Ok(())
}
