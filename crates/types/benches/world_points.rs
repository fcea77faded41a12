//! Points of a posed scan in world coordinates.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use terrace_types::{Frame, Pose, Scan, Sigma};

fn world_points(c: &mut Criterion) {
    let points: Vec<[f64; 3]> =
        (0..100_000).map(|i| [f64::from(i % 317) * 0.01, f64::from(i / 317) * 0.01, 2.0]).collect();
    let Ok(pose) = Pose::from_quaternion([1.0, 2.0, 3.0], [0.1, 0.2, 0.3, 0.9]) else { return };
    let per_axis = Sigma::PerAxis(vec![[0.001, 0.001, 0.004]; points.len()]);
    for (name, sigma) in [("one sigma", Sigma::Uniform(0.002)), ("sigma per axis", per_axis)] {
        let Ok(scan) = Scan::new(points.clone(), sigma, Frame::Sensor { pose }) else { return };
        c.bench_function(&format!("100 000 points, {name}"), |b| {
            b.iter(|| black_box(&scan).world_points().flatten().map(|p| p.position[2]).sum::<f64>());
        });
    }
}

criterion_group!(benches, world_points);
criterion_main!(benches);
