//! The planes of a simulated room: four walls, floor, ceiling, a door set back, a table and a pillar. At once, and step by step: samples of
//! cells, planes of cells and samples, labels of points.

// A bench has no caller to report to, and a room is small.
#![allow(clippy::unwrap_used, clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a bench")]

use std::collections::HashMap;
use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use terrace_regions::{Cell, Field, Points, Samples, Settings, find, segment};
use terrace_stats::{Stats, UncertainVector};

const SIGMA: f64 = 0.01;
const EDGE: f64 = 0.04;
/// Of places, of which half an edge has no more than 2¹⁵.
const UNIT: f64 = EDGE / (1 << 16) as f64;

/// Corners and sides.
const FACES: [[[f64; 3]; 3]; 8] = [
    [[0.0, 0.0, 0.0], [5.0, 0.0, 0.0], [0.0, 4.0, 0.0]],
    [[0.0, 0.0, 2.6], [5.0, 0.0, 0.0], [0.0, 4.0, 0.0]],
    [[0.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 2.6]],
    [[5.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 2.6]],
    [[0.0, 0.0, 0.0], [5.0, 0.0, 0.0], [0.0, 0.0, 2.6]],
    [[0.0, 4.0, 0.0], [5.0, 0.0, 0.0], [0.0, 0.0, 2.6]],
    [[3.0, 4.06, 0.0], [0.9, 0.0, 0.0], [0.0, 0.0, 2.0]],
    [[1.0, 1.0, 0.7], [1.6, 0.0, 0.0], [0.0, 0.8, 0.0]],
];

/// Points 2 cm apart on the whole.
fn room() -> Vec<[f64; 3]> {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut points = Vec::new();
    // A sum of twelve uniform numbers has the variance 1.
    let noise = |random: &mut ChaCha8Rng| (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0;
    let mut add = |of: &dyn Fn(f64, f64) -> [f64; 3], area: f64| {
        for _ in 0..(area / 4e-4) as usize {
            let place = of(random.random(), random.random());
            points.push(place.map(|x| x + SIGMA * noise(&mut random)));
        }
    };
    for [corner, u, v] in FACES {
        let length = |side: [f64; 3]| side.iter().map(|x| x * x).sum::<f64>().sqrt();
        let place = |a: f64, b: f64| [0, 1, 2].map(|i| corner[i] + a * u[i] + b * v[i] + 0.013);
        add(&place, length(u) * length(v));
    }
    let pillar = |a: f64, z: f64| {
        let (sin, cos) = (std::f64::consts::TAU * a).sin_cos();
        [4.0 + 0.2 * cos, 1.0 + 0.2 * sin, 2.6 * z]
    };
    add(&pillar, std::f64::consts::TAU * 0.2 * 2.6);
    points
}

fn regions(c: &mut Criterion) {
    let mut cells: Vec<Cell> = Vec::new();
    let mut known: HashMap<[i32; 3], u32> = HashMap::new();
    let (mut cell_of, mut places) = (Vec::new(), Vec::new());
    for point in room() {
        let key = point.map(|x| (x / EDGE).floor() as i32);
        let anchor = key.map(|k| (f64::from(k) + 0.5) * EDGE);
        let cell = *known.entry(key).or_insert_with(|| {
            cells.push(Cell { key, is_wide: false, stats: Stats::new(anchor) });
            cells.len() as u32 - 1
        });
        cells[cell as usize].stats.push(&UncertainVector::isotropic(point, SIGMA));
        cell_of.push(Some(cell));
        places.push([0, 1, 2].map(|i| (point[i] - anchor[i]) as f32));
    }
    let points = Points { cells: &cell_of, places: &places };
    let at_once = |points: Points| segment(&cells, EDGE, points, &Settings::default()).unwrap();
    let found = at_once(points);
    println!("{} points in {} cells: {} planes", places.len(), cells.len(), found.regions.len());

    let field = || Field::of(black_box(&cells), EDGE).unwrap();
    let mut group = c.benchmark_group("room");
    group.sample_size(20);
    group.bench_function("segment", |b| b.iter(|| at_once(black_box(points))));
    group.bench_function("sums around cells", |b| b.iter(|| field().sums_around(|_, sums| *sums)));

    let sampled = || {
        let mut samples = Samples::new(UNIT);
        let mut packed = Vec::with_capacity(places.len());
        samples.pack(&places, &mut packed);
        samples.push_all(|point| cell_of[point], &packed);
        samples
    };
    let samples = sampled();
    let planes = || {
        find(field(), places.len() as u64, |cell| samples.sample(cell as u32), &Settings::default()).unwrap()
    };
    group.bench_function("find", |b| b.iter(planes));
    let labeller = planes().labeller;
    let mut labels = vec![None; places.len()];
    group.throughput(Throughput::Elements(places.len() as u64));
    group.bench_function("samples", |b| b.iter(sampled));
    group.bench_function("labels", |b| {
        b.iter(|| {
            let points = cell_of.iter().zip(black_box(&places)).zip(&mut labels);
            let points = points.map(|((cell, place), to)| (*cell, *place, to));
            labeller.label_all(points, |to, label| *to = label)
        });
    });
    group.finish();
}

criterion_group!(benches, regions);
criterion_main!(benches);
