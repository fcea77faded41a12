//! Images of 640 × 480 pixels to planes and labels: `cargo bench -p terrace-depth`.

#![allow(missing_docs, clippy::unwrap_used)]

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use terrace_depth::{Camera, PlaneFinder, Settings};

const SIZE: [usize; 2] = [640, 480];

/// Boxes before a wall, with errors of a few millimetres, in millimetres.
fn image() -> Vec<u16> {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    (0..SIZE[0] * SIZE[1])
        .map(|at| {
            let (u, v) = (at % SIZE[0], at / SIZE[0]);
            let is_box = u / 80 % 2 == 1 && v / 96 % 2 == 1;
            let depth = if is_box { 1500 + u / 4 } else { 2600 - v / 2 + u / 8 };
            u16::try_from(depth).unwrap() + rng.random_range(0..12) + rng.random_range(0..12)
        })
        .collect()
}

fn frame(c: &mut Criterion) {
    let raw = image();
    let camera = Camera::new(SIZE, [585.0, 585.0], [319.5, 239.5], 1000.0).unwrap();
    let mut group = c.benchmark_group("depth image");
    group.throughput(Throughput::Elements(raw.len() as u64));
    for (name, noise) in [("kinect", Some("kinect".parse().unwrap())), ("errors found", None)] {
        let mut finder = PlaneFinder::new(camera, noise, Settings::default()).unwrap();
        group.bench_function(name, |b| b.iter(|| finder.find(&raw).unwrap()));
    }
    group.finish();
}

criterion_group!(benches, frame);
criterion_main!(benches);
