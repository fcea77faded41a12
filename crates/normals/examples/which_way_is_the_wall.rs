//! How sure is one of the direction of a wall?
//!
//! A depth camera sees a wall of 2 m, turned by 30 degrees. Its noise grows with the square of the distance, so the
//! near end is known better than the far one. Points are summed into cells of 10 cm; each patch of three by three cells
//! gives a normal, and how far it may be off.

use std::error::Error;

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use terrace_normals::{FitTo, estimate, towards};
use terrace_stats::{Stats, UncertainVector};

const CELL: f64 = 0.1;
const POINTS_PER_CELL: usize = 40;
const CAMERA: [f64; 3] = [0.0, 0.0, 1.0];

/// A place on the wall, `along` it and `up`.
fn wall(along: f64, up: f64) -> [f64; 3] {
    let (sin, cos) = 30f64.to_radians().sin_cos();
    [1.0 + along * cos, 1.0 - along * sin, up]
}

/// Standard error of the camera at a distance, in metres.
fn sigma(distance: f64) -> f64 {
    0.001 + 0.002 * distance * distance
}

fn cell(column: usize, row: usize, rng: &mut ChaCha8Rng) -> Stats {
    let corner = [CELL * column as f64, CELL * row as f64];
    let mut cell = Stats::new(wall(corner[0], corner[1]));
    for _ in 0..POINTS_PER_CELL {
        let [along, up] = corner.map(|c| c + rng.random_range(0.0..CELL));
        let p = wall(along, up);
        let sigma = sigma(p[0].hypot(p[1]));
        // A uniform error with that standard deviation.
        let noisy = p.map(|x| x + sigma * 3f64.sqrt() * rng.random_range(-1.0..1.0));
        cell.push(&UncertainVector::isotropic(noisy, sigma));
    }
    cell
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let truth = [30f64.to_radians().sin(), 30f64.to_radians().cos(), 0.0].map(|x| -x);
    println!("patch at   normal (x, y, z)          may be off by (x, y, z)   is off by   points are off by");
    for patch in 0..6 {
        let cells: Vec<Stats> = (0..9).map(|i| cell(3 * patch + i % 3, i / 3, &mut rng)).collect();
        let found = estimate(&cells, FitTo::Points)?;
        let [x, y, z] = towards(found.fit.normal, found.fit.centroid, CAMERA);
        let [sx, sy, sz] = found.uncertainty;
        let cosine = x * truth[0] + y * truth[1] + z * truth[2];
        println!(
            "{:6.2} m   ({x:6.3}, {y:6.3}, {z:6.3})   ({sx:.3}, {sy:.3}, {sz:.3})     {:5.2} deg      {:4.1} mm",
            found.fit.centroid[0].hypot(found.fit.centroid[1]),
            cosine.min(1.0).acos().to_degrees(),
            1000.0 * found.fit.rms()
        );
    }
    println!(
        "\nThree cells in a row: {}",
        match estimate(&row(&mut rng), FitTo::Points) {
            Ok(found) => format!("normal {:?}", found.fit.normal),
            Err(reason) => reason.to_string(),
        }
    );
    Ok(())
}

fn row(rng: &mut ChaCha8Rng) -> [Stats; 3] {
    // Of single points on a line, as a pole would give.
    std::array::from_fn(|i| {
        let place = [1.0, 2.0, CELL * i as f64];
        let mut cell = Stats::new(place);
        let noise = rng.random_range(-1e-4..1e-4);
        cell.push(&UncertainVector::isotropic([place[0] + noise, place[1], place[2]], 1e-4));
        cell
    })
}
