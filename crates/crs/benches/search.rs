//! Looking up known steps, and searches of staircases.

// A bench has no caller to report to, and its places are small and not negative.
#![allow(clippy::unwrap_used, clippy::cast_possible_truncation, clippy::cast_sign_loss)]

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use rand::rngs::ChaCha8Rng;
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use terrace_crs::{
    Bounds, CertifiedSearch, ControlledRandomSearch, Cost, Evaluation, Step, Steps, Sweep, from_fn,
    from_stairs,
};

const STEPS: usize = 1000;

/// A cost on `[0, STEPS)` whose step of whole number `i` has the value `heights[i]`.
fn staircase(heights: &[f64]) -> impl Cost {
    from_stairs(|x| {
        let lo = x.floor();
        (heights[(lo as usize).min(heights.len() - 1)], lo..lo + 1.0)
    })
}

fn heights(steps: usize) -> Vec<f64> {
    let mut rng = ChaCha8Rng::seed_from_u64(0);
    let mut height = 0.0;
    (0..steps)
        .map(|_| {
            height += rng.random_range(-1.0..1.0);
            height
        })
        .collect()
}

fn places(count: usize, axes: usize, width: f64) -> Vec<Vec<f64>> {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    (0..count).map(|_| (0..axes).map(|_| rng.random_range(0.0..width)).collect()).collect()
}

fn find(c: &mut Criterion) {
    let width = STEPS as f64;
    let mut line = Steps::new(&Bounds::interval(0.0, width).unwrap());
    for i in 0..STEPS {
        let lo = i as f64;
        line.insert(&[lo], &Evaluation::interval(lo, lo..lo + 1.0)).unwrap();
    }
    let asked = places(1000, 1, width);
    c.bench_function("find/1000 look-ups among 1000 intervals", |b| {
        b.iter(|| asked.iter().filter_map(|x| line.find(black_box(x))).sum::<f64>());
    });

    let mut plane = Steps::new(&Bounds::new([(0.0, 40.0), (0.0, 25.0)]).unwrap());
    for i in 0..STEPS {
        let lo = vec![(i % 40) as f64, (i / 40) as f64];
        let hi = lo.iter().map(|v| v + 1.0).collect();
        plane.insert(&lo.clone(), &Evaluation { value: i as f64, step: Step::Box { lo, hi } }).unwrap();
    }
    let asked = places(1000, 2, 25.0);
    c.bench_function("find/1000 look-ups among 1000 boxes", |b| {
        b.iter(|| asked.iter().filter_map(|x| plane.find(black_box(x))).sum::<f64>());
    });
}

/// All cells of a raster, as a search meets them: in no order.
fn raster(side: usize, axes: u32) -> Vec<(Vec<f64>, Evaluation)> {
    let mut cells: Vec<usize> = (0..side.pow(axes)).collect();
    cells.shuffle(&mut ChaCha8Rng::seed_from_u64(3));
    let cell = |number: &usize| {
        let lo: Vec<f64> = (0..axes).map(|axis| (number / side.pow(axis) % side) as f64).collect();
        let hi = lo.iter().map(|v| v + 1.0).collect();
        (lo.clone(), Evaluation { value: *number as f64, step: Step::Box { lo, hi } })
    };
    cells.iter().map(cell).collect()
}

fn many(c: &mut Criterion) {
    for (side, axes) in [(180, 2), (32, 3)] {
        let cells = raster(side, axes);
        let bounds = Bounds::new(vec![(0.0, side as f64); axes as usize]).unwrap();
        let fill = || {
            let mut steps = Steps::new(&bounds);
            for (x, evaluation) in &cells {
                steps.insert(x, evaluation).unwrap();
            }
            steps
        };
        let steps = fill();
        let asked = places(1000, axes as usize, side as f64);
        let name = format!("{} boxes in {axes} axes", cells.len());
        c.bench_function(&format!("find/1000 look-ups among {name}"), |b| {
            b.iter(|| asked.iter().filter_map(|x| steps.find(black_box(x))).sum::<f64>());
        });
        let mut group = c.benchmark_group("insert");
        group.sample_size(10);
        group.bench_function(name, |b| b.iter(|| fill().len()));
        group.finish();
    }
}

fn exact(c: &mut Criterion) {
    for steps in [1000, 50_000] {
        let heights = heights(steps);
        let bounds = Bounds::interval(0.0, steps as f64).unwrap();
        let mut group = c.benchmark_group("exact");
        group.sample_size(10);
        group.bench_function(format!("sweep of {steps} steps"), |b| {
            b.iter(|| Sweep::default().minimise(&mut staircase(&heights), &bounds).unwrap().value);
        });
        group.bench_function(format!("certified search of {steps} steps"), |b| {
            b.iter(|| CertifiedSearch::default().minimise(&mut staircase(&heights), &bounds).unwrap().value);
        });
        group.finish();
    }
    let side = 100.0;
    let bounds = Bounds::new([(0.0, side); 2]).unwrap();
    let mut cells = from_cells(|lo| (lo[0] - 30.0).abs() + (lo[1] - 70.0).abs() + (lo[0] * lo[1]).sin());
    let mut group = c.benchmark_group("exact");
    group.sample_size(10);
    group.bench_function("certified search of 10000 boxes", |b| {
        b.iter(|| CertifiedSearch::default().minimise(&mut cells, &bounds).unwrap().value);
    });
    group.finish();
}

/// A cost whose steps are the cells of the whole numbers.
fn from_cells(value: impl Fn(&[f64]) -> f64) -> impl Cost {
    struct Cells<F>(F);
    impl<F: Fn(&[f64]) -> f64> Cost for Cells<F> {
        fn evaluate(&mut self, x: &[f64]) -> Evaluation {
            let lo: Vec<f64> = x.iter().map(|v| v.floor()).collect();
            let hi = lo.iter().map(|v| v + 1.0).collect();
            Evaluation { value: (self.0)(&lo), step: Step::Box { lo, hi } }
        }
    }
    Cells(value)
}

fn search(c: &mut Criterion) {
    let heights = heights(STEPS);
    let bounds = Bounds::interval(0.0, STEPS as f64).unwrap();
    let method = ControlledRandomSearch::default();
    c.bench_function("search/1000 steps, known", |b| {
        b.iter(|| {
            let mut rng = ChaCha8Rng::seed_from_u64(2);
            method.minimise(&mut staircase(&heights), &bounds, &mut rng).unwrap().value
        });
    });
    c.bench_function("search/1000 steps, unknown", |b| {
        b.iter(|| {
            let mut rng = ChaCha8Rng::seed_from_u64(2);
            let mut cost = from_fn(|x| heights[(x[0] as usize).min(STEPS - 1)]);
            method.minimise(&mut cost, &bounds, &mut rng).unwrap().value
        });
    });
}

criterion_group!(benches, find, many, search, exact);
criterion_main!(benches);
