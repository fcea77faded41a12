//! Ten million points of a hall into cells of 0.1 m: at once and one by one, in scan order and shuffled.
//!
//! Times of one thread are those it ran on a CPU, where the system tells (Linux), for others may use the machine too; those
//! of two threads are of the clock.

// A bench has no caller to report to.
#![allow(clippy::unwrap_used)]

use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use rayon::{ThreadPool, ThreadPoolBuilder};
use terrace_grid::{Assignment, PointErrors, VoxelGrid};
use terrace_stats::UncertainVector;

const POINTS: usize = 10_000_000;
const CELL: f64 = 0.1;
const SIGMA: f64 = 0.005;
/// Where floor and walls begin, and where they end. Points of the ceiling alone are on both sides of the face of a voxel.
const HALL: [[f64; 3]; 2] = [[0.03, 0.05, 0.06], [30.06, 16.05, 5.0]];
const IMAGE: [u32; 2] = [640, 480];

/// Depth images from a walk through the hall, pixel by pixel.
fn scans() -> Vec<[f64; 3]> {
    let mut points = Vec::with_capacity(POINTS);
    for image in 0.. {
        let along = f64::from(image) * 0.618_033_988_75 % 1.0;
        let camera = [3.0 + 24.0 * along, 4.0 + 8.0 * (7.0 * along % 1.0), 1.6];
        let (yaw, pitch) = (2.4 * f64::from(image), 0.4 * (3.1 * f64::from(image)).sin());
        let ahead = [yaw.cos() * pitch.cos(), yaw.sin() * pitch.cos(), pitch.sin()];
        let left = [-yaw.sin(), yaw.cos(), 0.0];
        let up = [-yaw.cos() * pitch.sin(), -yaw.sin() * pitch.sin(), pitch.cos()];
        for pixel in 0..IMAGE[0] * IMAGE[1] {
            if points.len() == POINTS {
                return points;
            }
            let x = (f64::from(pixel % IMAGE[0]) - 0.5 * f64::from(IMAGE[0])) / 525.0;
            let y = (f64::from(pixel / IMAGE[0]) - 0.5 * f64::from(IMAGE[1])) / 525.0;
            let ray = [0, 1, 2].map(|i| ahead[i] - x * left[i] - y * up[i]);
            let to_wall = |i: usize| (HALL[usize::from(ray[i] > 0.0)][i] - camera[i]) / ray[i];
            let depth = to_wall(0).min(to_wall(1)).min(to_wall(2));
            // Two centimetres without a generator: the golden ratio spreads the pixels evenly.
            let noise = 4.0 * SIGMA * ((f64::from(pixel) * 0.618_033_988_75).fract() - 0.5);
            points.push([0, 1, 2].map(|i| camera[i] + (depth + noise) * ray[i]));
        }
    }
    points
}

/// Every point once, far from the one before: a step that has no divisor in common with the count.
fn shuffled(points: &[[f64; 3]]) -> Vec<[f64; 3]> {
    (0..points.len()).map(|i| points[i * 7_368_787 % points.len()]).collect()
}

fn at_once(pool: &ThreadPool, points: &[[f64; 3]], with_places: bool) -> VoxelGrid {
    let mut grid = VoxelGrid::new(CELL, Assignment::Voxel).unwrap();
    let (mut cells, mut places) = (Vec::new(), Vec::new());
    let places = with_places.then_some(&mut places);
    pool.install(|| grid.insert_all(points, PointErrors::Same(SIGMA), &mut cells, places)).unwrap();
    black_box(&cells);
    grid
}

fn one_by_one(points: &[[f64; 3]]) -> VoxelGrid {
    let mut grid = VoxelGrid::new(CELL, Assignment::Voxel).unwrap();
    let insert = |point: &[f64; 3]| grid.insert(&UncertainVector::isotropic(*point, SIGMA)).ok();
    black_box(points.iter().map(insert).collect::<Vec<_>>());
    grid
}

/// What all threads ran on a CPU so far, as the scheduler counts.
fn cpu_time() -> Option<Duration> {
    let threads = std::fs::read_dir("/proc/self/task").ok()?;
    let ran = threads.map(|thread| {
        let counts = std::fs::read_to_string(thread.ok()?.path().join("schedstat")).ok()?;
        counts.split_whitespace().next()?.parse().ok().map(Duration::from_nanos)
    });
    ran.sum()
}

/// Times what is done so often, by the CPU or by the clock.
fn time<T>(by_cpu: bool, times: u64, mut done: impl FnMut() -> T) -> Duration {
    let (ran, start) = (cpu_time(), Instant::now());
    for _ in 0..times {
        black_box(done());
    }
    let by_clock = start.elapsed();
    let ran = ran.zip(cpu_time()).map(|(before, after)| after.saturating_sub(before));
    ran.filter(|_| by_cpu).unwrap_or(by_clock)
}

fn insert(c: &mut Criterion) {
    let ordered = scans();
    let shuffled = shuffled(&ordered);
    let pools = [1, 2].map(|threads| ThreadPoolBuilder::new().num_threads(threads).build().unwrap());
    let timed =
        [(&pools[0], "1 thread, CPU"), (&pools[0], "1 thread, clock"), (&pools[1], "2 threads, clock")];
    let mut group = c.benchmark_group("ten million points");
    group.sample_size(10).warm_up_time(Duration::from_secs(1)).measurement_time(Duration::from_secs(4));
    group.throughput(Throughput::Elements(POINTS as u64));
    for (order, points) in [("scan order", &ordered), ("shuffled", &shuffled)] {
        for (pool, threads) in timed {
            for (what, with_places) in [("at once", false), ("at once, with places", true)] {
                group.bench_function(format!("{order}, {what}, {threads}"), |b| {
                    b.iter_custom(|times| {
                        time(threads.ends_with("CPU"), times, || {
                            at_once(pool, black_box(points), with_places)
                        })
                    });
                });
            }
        }
        group.bench_function(format!("{order}, one by one, 1 thread, CPU"), |b| {
            b.iter_custom(|times| time(true, times, || one_by_one(black_box(points))));
        });
    }
    group.finish();
}

criterion_group!(benches, insert);
criterion_main!(benches);
