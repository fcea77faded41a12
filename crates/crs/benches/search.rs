//! Looking up known steps, and a search of a staircase with a thousand of them.

// A bench has no caller to report to, and its places are small and not negative.
#![allow(clippy::unwrap_used, clippy::cast_possible_truncation, clippy::cast_sign_loss)]

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use terrace_crs::{Bounds, ControlledRandomSearch, Cost, Evaluation, Step, Steps, from_fn, from_stairs};

const STEPS: usize = 1000;

/// A cost on `[0, STEPS)` whose step of whole number `i` has the value `heights[i]`.
fn staircase(heights: &[f64]) -> impl Cost {
    from_stairs(|x| {
        let lo = x.floor();
        (heights[(lo as usize).min(heights.len() - 1)], lo..lo + 1.0)
    })
}

fn heights() -> Vec<f64> {
    let mut rng = ChaCha8Rng::seed_from_u64(0);
    let mut height = 0.0;
    (0..STEPS)
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

fn search(c: &mut Criterion) {
    let heights = heights();
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

criterion_group!(benches, find, search);
criterion_main!(benches);
