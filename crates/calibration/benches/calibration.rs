//! Distances of a thousand errors, and what is made of a hundred thousand.

// A bench has no caller to report to.
#![allow(clippy::unwrap_used)]

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use terrace_calibration::{Calibration, chi_squared_quantile, squared_mahalanobis};

const VALUES: u32 = 100_000;

fn calibration(c: &mut Criterion) {
    let errors: Vec<[f64; 3]> = (0..1000)
        .map(|i| [f64::from(i % 7) * 1e-4, f64::from(i % 11) * 1e-4, f64::from(i % 13) * 1e-3])
        .collect();
    let covariance = [[1e-8, 2e-9, 1e-8], [2e-9, 2e-8, 0.0], [1e-8, 0.0, 1e-6]];
    c.bench_function("squared_mahalanobis/1000 of 3", |b| {
        b.iter(|| {
            let distance = |error: &[f64; 3]| squared_mahalanobis(*error, black_box(covariance)).unwrap();
            black_box(&errors).iter().map(distance).sum::<f64>()
        });
    });
    for freedom in [3.0, 300_000.0] {
        c.bench_function(&format!("chi_squared_quantile/{freedom}"), |b| {
            b.iter(|| chi_squared_quantile(black_box(freedom), black_box(0.975)));
        });
    }

    let mut found = Calibration::new(3).unwrap();
    // Scattered by multiples of the golden ratio, from a fixed sequence.
    found.extend((1..=VALUES).map(|i| -3.0 * (f64::from(i) * 0.618_033_988_749_895).fract().ln()));
    let mut group = c.benchmark_group("100k values");
    group.sample_size(20);
    group.bench_function("nees and band", |b| b.iter(|| (found.nees(), found.nees_band(0.95))));
    group.bench_function("coverage", |b| b.iter(|| found.coverage(black_box(0.95))));
    group.bench_function("quantiles, 300 points", |b| b.iter(|| found.quantiles(300)));
    group.bench_function("kolmogorov_smirnov", |b| b.iter(|| found.kolmogorov_smirnov()));
    group.finish();
}

criterion_group!(benches, calibration);
criterion_main!(benches);
