//! A room that is scanned over and over by a poor sensor. After each tour of fourteen scans the planes are asked for: points
//! gather in the cells, the normals of the cells become more certain, down to what they differ by where surfaces meet others;
//! and the standard error of the orientation of planes falls with the root of their points.
//!
//! `cargo run --release -p terrace --example growing_room`

use terrace::{ExtractedPlane, Mapper, Params, PlaneMap};
use terrace_synth::Scene;

const TOURS: u64 = 8;
const POINTS: usize = 14_000;
/// As bad as that of an old depth camera at four metres, so that a few points in a cell are not enough.
const SIGMA: f64 = 0.03;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let room = Scene::room();
    let floor = room.planes().iter().find(|p| p.name == "floor").map(|p| p.plane.coefficients());
    let mut mapper = Mapper::new(Params { cell_size: Some(0.15), ..Params::default() })?;
    println!("                                    | the floor:");
    println!(" scans    points  on planes  planes |   points   s_x    s_y    s_z    rms m  tilt mrad");
    for seed in 0..TOURS {
        let tour = terrace_synth::Params { points: Some(POINTS), sigma: Some(SIGMA), seed };
        for scan in room.generate(&tour)?.scans {
            mapper.insert(&scan.scan)?;
        }
        let map = mapper.extract()?;
        let summary = map.summary();
        print!("{:6} {:9} {:10} {:7} |", 14 * (seed + 1), summary.points, summary.labelled, summary.planes);
        let found = floor.and_then(|plane| find(&map, plane));
        if let Some((found, [x, y, z])) = found.and_then(|plane| Some((plane, plane.normal_uncertainty?))) {
            print!(" {:8}  {x:.3}  {y:.3}  {z:.3}  {:.4}", found.points, found.rms);
            if let Some(estimate) = found.estimate {
                print!("  {:9.3}", 1e3 * estimate.largest_tilt());
            }
        }
        println!();
    }
    Ok(())
}

/// The largest plane within five degrees and five centimetres of the true one.
fn find(map: &PlaneMap, [a, b, c, d]: [f64; 4]) -> Option<&ExtractedPlane> {
    map.planes.iter().find(|plane| {
        let ([x, y, z], [p, q, r]) = (plane.plane.normal(), plane.centroid);
        a * x + b * y + c * z > 5.0_f64.to_radians().cos() && (a * p + b * q + c * r + d).abs() < 0.05
    })
}
