//! Adding vectors, merging sets, and asking for distances: what a grid does for every point and cell.

// A bench has no caller to report to.
#![allow(clippy::unwrap_used)]

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use terrace_stats::{Moments, Stats, UncertainVector};

const COUNT: u32 = 10_000;

/// Vectors spread evenly over a cube, from the additive recurrence of the plastic number.
fn vectors() -> Vec<UncertainVector> {
    (1..=COUNT)
        .map(|i| {
            let value =
                [0.819_172_513_4, 0.671_043_606_7, 0.549_700_477_9].map(|a| (f64::from(i) * a).fract());
            UncertainVector::isotropic(value, 0.01)
        })
        .collect()
}

fn push(c: &mut Criterion) {
    let vectors = vectors();
    let mut group = c.benchmark_group("push");
    group.throughput(Throughput::Elements(u64::from(COUNT)));
    group.bench_function("moments", |b| {
        b.iter(|| {
            let mut moments = Moments::EMPTY;
            for v in &vectors {
                moments.push(black_box(v));
            }
            moments
        });
    });
    group.bench_function("stats", |b| {
        b.iter(|| {
            let mut stats = Stats::new([0.5; 3]);
            for v in &vectors {
                stats.push(black_box(v));
            }
            stats
        });
    });
    group.bench_function("stats, weighted", |b| {
        b.iter(|| {
            let mut stats = Stats::new([0.5; 3]);
            for v in &vectors {
                stats.push_weighted(black_box(v), 1e4);
            }
            stats
        });
    });
    group.finish();
}

fn merge(c: &mut Criterion) {
    let cells: Vec<_> = vectors()
        .iter()
        .map(|v| {
            let mut cell = Stats::new(v.value.map(f64::round));
            cell.push(v);
            cell
        })
        .collect();
    let mut group = c.benchmark_group("merge");
    group.throughput(Throughput::Elements(u64::from(COUNT)));
    group.bench_function("across anchors", |b| {
        b.iter(|| {
            let mut union = Stats::new([0.5; 3]);
            for cell in &cells {
                union.merge(black_box(cell));
            }
            union
        });
    });
    group.finish();
}

fn ask(c: &mut Criterion) {
    let vectors = vectors();
    let mut stats = Stats::new([0.5; 3]);
    for v in &vectors {
        stats.push(v);
    }
    let mut group = c.benchmark_group("ask");
    group.throughput(Throughput::Elements(u64::from(COUNT)));
    group.bench_function("expected squared distance", |b| {
        b.iter(|| {
            vectors.iter().map(|v| stats.expected_squared_distance(black_box(v)).unwrap()).sum::<f64>()
        });
    });
    group.finish();
    c.bench_function("ask/covariance", |b| b.iter(|| black_box(&stats).covariance().unwrap()));
}

criterion_group!(benches, push, merge, ask);
criterion_main!(benches);
