//! Areas of known shapes from their points, by sampling, spacing and turn: `accuracy [resolution / spacing]`.

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use terrace_extent::{ExtentError, Footprint, OutlineOptions, PlaneFrame, Polygon};
use terrace_types::Plane;

/// A shape: whether it holds a point, its area in square metres, and how many holes it has.
type Shape = (&'static str, fn([f64; 2]) -> bool, f64, usize);

const SHAPES: [Shape; 4] = [
    ("rectangle 4 x 2.5 m", |[x, y]| x.abs() < 2.0 && y.abs() < 1.25, 10.0, 0),
    ("L of 3 m, 1 m wide", |[x, y]| x.abs() < 1.5 && y.abs() < 1.5 && (x < -0.5 || y < -0.5), 5.0, 0),
    ("disc of 1 m", |[x, y]| x.hypot(y) < 1.0, std::f64::consts::PI, 0),
    (
        "plate 3 x 3 m, 2 holes of 0.5 m",
        |[x, y]| {
            let hole = |at: f64| (x - at).hypot(y - at) < 0.5;
            x.abs() < 1.5 && y.abs() < 1.5 && !hole(-0.7) && !hole(0.7)
        },
        9.0 - std::f64::consts::FRAC_PI_2,
        2,
    ),
];

fn sample(shape: &Shape, spacing: f64, random: bool, turn: f64, rng: &mut ChaCha8Rng) -> Vec<[f64; 3]> {
    let (sin, cos) = turn.sin_cos();
    let steps = (5.0 / spacing).ceil();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some hundreds")]
    let side = steps as u32;
    let mut points = Vec::new();
    let offset = [rng.random::<f64>(), rng.random::<f64>()];
    let at = |k: f64, shift: f64| (k + shift) * spacing - 2.5;
    for i in 0..side {
        for j in 0..side {
            let [x, y] = if random {
                [rng.random::<f64>() * steps * spacing - 2.5, rng.random::<f64>() * steps * spacing - 2.5]
            } else {
                [at(f64::from(i), offset[0]), at(f64::from(j), offset[1])]
            };
            if shape.1([x, y]) {
                points.push([cos * x - sin * y, sin * x + cos * y, 0.0]);
            }
        }
    }
    points
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let ratio: f64 = std::env::args().nth(1).map_or(Ok(1.5), |ratio| ratio.parse())?;
    let frame = PlaneFrame::new(&Plane::through([0.0; 3], [0.0, 0.0, 1.0])?, [0.0; 3])?;
    println!(
        "error of the area in %, mean and worst of 8 turns; border moved outwards in pixels; vertices; wrong holes"
    );
    for shape in &SHAPES {
        for random in [false, true] {
            for spacing in [0.01, 0.02, 0.05] {
                let outline = |turn: u32| -> Result<_, ExtentError> {
                    let mut rng = ChaCha8Rng::seed_from_u64(u64::from(turn));
                    let resolution = spacing * ratio;
                    let mut footprint = Footprint::new(frame, resolution)?;
                    for point in sample(shape, spacing, random, f64::from(turn) * 0.2, &mut rng) {
                        footprint.add(point)?;
                    }
                    let options = OutlineOptions::for_spacing(spacing);
                    let polygons = footprint.outline(&options)?;
                    let area: f64 = polygons.iter().map(Polygon::area).sum();
                    let border: f64 = polygons.iter().map(Polygon::perimeter).sum();
                    let holes: usize = polygons.iter().map(|p| p.holes().len()).sum();
                    let vertices = polygons.iter().flat_map(Polygon::rings).flatten().count();
                    Ok((area, (area - shape.2) / border / resolution, holes, vertices, polygons.len()))
                };
                let outlines = (0..8).map(outline).collect::<Result<Vec<_>, _>>()?;
                let errors: Vec<f64> = outlines.iter().map(|o| (o.0 / shape.2 - 1.0) * 100.0).collect();
                let mean = errors.iter().sum::<f64>() / 8.0;
                let worst =
                    errors.iter().fold(0.0_f64, |worst, e| if e.abs() > worst.abs() { *e } else { worst });
                let moved = outlines.iter().map(|o| o.1).sum::<f64>() / 8.0;
                let vertices = outlines.iter().map(|o| o.3).sum::<usize>() / 8;
                let wrong = outlines.iter().filter(|o| o.2 != shape.3 || o.4 != 1).count();
                let sampling = if random { "random" } else { "grid" };
                println!(
                    "{:32} {sampling:6} {spacing:.2} m  {mean:6.2} {worst:6.2}  {moved:5.2} px  {vertices:4} {wrong}",
                    shape.0
                );
            }
        }
    }
    Ok(())
}
