//! A hundred thousand points added, outlined and cut into triangles.

// A bench has no caller to report to.
#![allow(clippy::unwrap_used)]

use std::hint::black_box;

use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use terrace_extent::{Footprint, Mesh, OutlineOptions, PlaneExtent, PlaneFrame};
use terrace_types::Plane;

/// A plate of 6.3 × 6.3 m with 25 round holes, points 2 cm apart, turned.
fn points(frame: &PlaneFrame) -> Vec<[f64; 3]> {
    let (sin, cos) = 0.3_f64.sin_cos();
    let mut points = Vec::new();
    for i in 0..316 {
        for j in 0..316 {
            let [x, y] = [i, j].map(|k| f64::from(k) * 0.02);
            if (x % 1.26 - 0.63).hypot(y % 1.26 - 0.63) > 0.2 {
                points.push(frame.to_world([cos * x - sin * y, sin * x + cos * y]));
            }
        }
    }
    points
}

fn extent(c: &mut Criterion) {
    let wall = Plane::through([0.0, 3.0, 0.0], [0.1, -1.0, 0.0]).unwrap();
    let frame = PlaneFrame::new(&wall, [0.0, 3.0, 0.0]).unwrap();
    let points = points(&frame);
    let add = || {
        let mut footprint = Footprint::new(frame, 0.03).unwrap();
        for point in &points {
            footprint.add(black_box(*point)).unwrap();
        }
        footprint
    };
    let (footprint, options) = (add(), OutlineOptions::closing(0.06));
    let extent = PlaneExtent::of(&footprint, &options).unwrap();
    let mut group = c.benchmark_group("100k points");
    group.sample_size(20);
    group.bench_function("add", |b| b.iter(add));
    group.bench_function("outline", |b| b.iter(|| footprint.outline(black_box(&options))));
    group.bench_function("triangles", |b| {
        b.iter_batched(
            Mesh::new,
            |mut mesh| mesh.add(&extent, [9, 9, 9]).map(|()| mesh),
            BatchSize::SmallInput,
        );
    });
    group.finish();
}

criterion_group!(benches, extent);
criterion_main!(benches);
