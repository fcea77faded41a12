//! Inserting a scan by either rule, in scan order and shuffled; finding its cells again; cells of twice the edge; the graph of dense cells;
//! walking neighbourhoods; merging.

// A bench has no caller to report to.
#![allow(clippy::unwrap_used)]

use std::hint::black_box;

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use terrace_grid::{Assignment, Connectivity, VoxelGrid, Walk};
use terrace_stats::UncertainVector;

const CELL: f64 = 0.06;
const WIDTH: u32 = 320;
const HEIGHT: u32 = 240;

/// A depth image of the corner of a room, pixel by pixel: the nearest of floor, back wall and side wall.
fn scan() -> Vec<UncertainVector> {
    let pixels = (0..HEIGHT).flat_map(|v| (0..WIDTH).map(move |u| (u, v)));
    pixels
        .map(|(u, v)| {
            let x = (f64::from(u) - 0.5 * f64::from(WIDTH)) / 290.0;
            let y = (f64::from(v) - 0.5 * f64::from(HEIGHT)) / 290.0;
            let side = if x > 0.0 { 1.2 / x } else { f64::INFINITY };
            let floor = if y > 0.0 { 0.9 / y } else { f64::INFINITY };
            let depth = side.min(floor).min(3.5);
            // Noise of a centimetre without a generator: the golden ratio spreads the pixels evenly.
            let noise = 0.02 * ((f64::from(v * WIDTH + u) * 0.618_033_988_75).fract() - 0.5);
            let z = depth + noise;
            UncertainVector::isotropic([x * z, y * z, z], 0.01)
        })
        .collect()
}

/// Every point once, far from the one before: a step that has no divisor in common with the count.
fn shuffled(points: &[UncertainVector]) -> Vec<UncertainVector> {
    (0..points.len()).map(|i| points[i * 48_271 % points.len()]).collect()
}

fn grid_of(points: &[UncertainVector], assignment: Assignment) -> VoxelGrid {
    let mut grid = VoxelGrid::new(CELL, assignment).unwrap();
    for point in points {
        grid.insert(point).unwrap();
    }
    grid
}

fn insert(c: &mut Criterion) {
    let ordered = scan();
    let shuffled = shuffled(&ordered);
    let mut group = c.benchmark_group("insert");
    group.throughput(Throughput::Elements(u64::from(WIDTH * HEIGHT)));
    for (rule, assignment) in
        [("voxel", Assignment::Voxel), ("expected distance", Assignment::ExpectedDistance)]
    {
        for (order, points) in [("scan order", &ordered), ("shuffled", &shuffled)] {
            group.bench_function(format!("{rule}, {order}"), |b| {
                b.iter(|| grid_of(black_box(points), assignment));
            });
        }
    }
    group.finish();
}

fn find(c: &mut Criterion) {
    let mut group = c.benchmark_group("find all");
    let ordered = scan();
    group.throughput(Throughput::Elements(u64::from(WIDTH * HEIGHT)));
    for (order, points) in [("scan order", &ordered), ("shuffled", &shuffled(&ordered))] {
        let grid = grid_of(points, Assignment::Voxel);
        let points: Vec<[f64; 3]> = points.iter().map(|point| point.value).collect();
        group.bench_function(order, |b| {
            b.iter(|| {
                let (mut cells, mut places) = (Vec::new(), Vec::new());
                grid.find_all(black_box(&points), &mut cells, &mut places);
                (cells, places)
            });
        });
    }
    group.finish();
}

fn graph(c: &mut Criterion) {
    let grid = grid_of(&scan(), Assignment::Voxel);
    let dense = grid.dense(5, Connectivity::Corners);

    let mut group = c.benchmark_group("cells");
    group.throughput(Throughput::Elements(grid.len() as u64));
    group.bench_function("dense", |b| b.iter(|| black_box(&grid).dense(5, Connectivity::Corners)));
    let mut halves = VoxelGrid::of_halves(2.0 * CELL).unwrap();
    for point in &scan() {
        halves.insert(point).unwrap();
    }
    group.bench_function("of twice the edge", |b| b.iter(|| black_box(&halves).halved().unwrap()));
    group.bench_function("iterate in order", |b| {
        b.iter(|| black_box(&grid).iter().map(|c| c.density()).sum::<u64>());
    });
    group.bench_function("merge with itself", |b| {
        b.iter_batched_ref(
            || grid.clone(),
            |sum| sum.merge(black_box(&grid)).unwrap(),
            BatchSize::SmallInput,
        );
    });
    group.finish();

    let mut group = c.benchmark_group("neighbourhoods");
    group.throughput(Throughput::Elements(dense.len() as u64));
    for depth in [1, 2, 3] {
        group.bench_function(format!("depth {depth}"), |b| {
            let mut walk = Walk::default();
            b.iter(|| {
                (0..dense.len()).map(|n| walk.neighbourhood(black_box(&dense), n, depth).len()).sum::<usize>()
            });
        });
    }
    group.finish();
}

criterion_group!(benches, insert, find, graph);
criterion_main!(benches);
