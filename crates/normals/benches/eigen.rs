//! The eigen-solver beside faer, plane fits, the normal of a neighbourhood with its uncertainty, and a plane with its covariance.

// A bench has no caller to report to.
#![allow(clippy::unwrap_used)]

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use faer::{Mat, Side};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use terrace_normals::{
    CovariantPlane, FitTo, estimate, fit_centres, fit_plane, symmetric_eigen, symmetric_eigen_batch,
};
use terrace_stats::{Stats, SymmetricMatrix3, UncertainVector};

const MATRICES: usize = 1024;

/// Covariances of points on planes of any direction, a tenth as thick as wide.
fn covariances(rng: &mut ChaCha8Rng) -> Vec<SymmetricMatrix3> {
    let mut covariance = || {
        let axes: [[f64; 3]; 3] =
            std::array::from_fn(|_| std::array::from_fn(|_| rng.random_range(-1.0..1.0)));
        let [a, b, c] = axes.map(SymmetricMatrix3::outer);
        a + b + c * 1e-2
    };
    (0..MATRICES).map(|_| covariance()).collect()
}

/// Three by three cells of a rough floor, with eight points each.
fn neighbourhood(rng: &mut ChaCha8Rng) -> Vec<Stats> {
    let cell = |i: usize, rng: &mut ChaCha8Rng| {
        let corner = [0.1 * (i % 3) as f64, 0.1 * (i / 3) as f64, 0.0];
        let mut cell = Stats::new(corner);
        for _ in 0..8 {
            let p = [0.1, 0.1, 0.01].map(|size| rng.random_range(0.0..size));
            cell.push(&UncertainVector::isotropic([0, 1, 2].map(|k| corner[k] + p[k]), 0.005));
        }
        cell
    };
    (0..9).map(|i| cell(i, rng)).collect()
}

fn eigen(c: &mut Criterion) {
    let matrices = covariances(&mut ChaCha8Rng::seed_from_u64(0));
    let mut group = c.benchmark_group("eigen of 1024 matrices");
    group.throughput(Throughput::Elements(MATRICES as u64));
    group.bench_function("single", |b| {
        b.iter(|| black_box(&matrices).iter().map(|m| symmetric_eigen(m).vectors[0][0]).sum::<f64>());
    });
    group.bench_function("batches of 4", |b| {
        b.iter(|| {
            let (batches, _) = black_box(&matrices).as_chunks::<4>();
            batches.iter().flat_map(symmetric_eigen_batch).map(|e| e.vectors[0][0]).sum::<f64>()
        });
    });
    group.bench_function("faer", |b| {
        b.iter(|| {
            let solve = |m: &SymmetricMatrix3| {
                let rows = m.rows();
                let dense = Mat::from_fn(3, 3, |i, j| rows[i][j]);
                dense.self_adjoint_eigen(Side::Lower).unwrap().U()[(0, 0)]
            };
            black_box(&matrices).iter().map(solve).sum::<f64>()
        });
    });
    group.finish();
}

fn planes(c: &mut Criterion) {
    let cells = neighbourhood(&mut ChaCha8Rng::seed_from_u64(1));
    let centres: Vec<[f64; 3]> = cells.iter().filter_map(Stats::mean).collect();
    c.bench_function("fit_plane", |b| b.iter(|| fit_plane(black_box(&cells[0])).unwrap()));
    c.bench_function("fit_centres of 9", |b| b.iter(|| fit_centres(black_box(&centres)).unwrap()));
    for to in [FitTo::Centres, FitTo::Points] {
        c.bench_function(&format!("estimate of 9 cells, {to:?}"), |b| {
            b.iter(|| estimate(black_box(&cells), to).unwrap());
        });
    }
    c.bench_function("covariant plane of 9 cells", |b| {
        b.iter(|| CovariantPlane::of_cells(black_box(&cells)).unwrap());
    });
}

criterion_group!(benches, eigen, planes);
criterion_main!(benches);
