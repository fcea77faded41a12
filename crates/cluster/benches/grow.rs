//! Clustering the cells of a room: a grid of nodes with eight neighbours each, folded twice.

// A bench has no caller to report to, and its numbers are small.
#![allow(clippy::unwrap_used, clippy::cast_possible_truncation)]

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use terrace_cluster::{Grower, SeedOrder, Subgraph};
use terrace_stats::UncertainVector;

const SIDE: usize = 100;

/// Two walls and a floor in a row, with noisy normals.
fn normals() -> Vec<Option<UncertainVector>> {
    let mut rng = ChaCha8Rng::seed_from_u64(0);
    let mut normal = |node: usize| {
        let mut v = [0.0; 3].map(|_: f64| rng.random_range(-0.1..0.1));
        v[3 * (node % SIDE) / SIDE] += 1.0;
        let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
        Some(UncertainVector::isotropic(v.map(|x| x / length), rng.random_range(0.01..0.1)))
    };
    (0..SIDE * SIDE).map(&mut normal).collect()
}

fn edges() -> Vec<Vec<u32>> {
    let around = |node: usize| {
        let (row, column) = (node / SIDE, node % SIDE);
        let rows = row.saturating_sub(1)..=(row + 1).min(SIDE - 1);
        let columns = column.saturating_sub(1)..=(column + 1).min(SIDE - 1);
        let all = rows.flat_map(move |r| columns.clone().map(move |c| r * SIDE + c));
        all.filter(|other| *other != node).map(|other| other as u32).collect()
    };
    (0..SIDE * SIDE).map(around).collect()
}

fn grow(c: &mut Criterion) {
    let (normals, edges) = (normals(), edges());
    let mut group = c.benchmark_group("10000 nodes");
    group.throughput(Throughput::Elements(normals.len() as u64));
    for seeds in [SeedOrder::MostCertain, SeedOrder::Random { seed: 1 }] {
        let name = if seeds == SeedOrder::MostCertain { "most certain first" } else { "random" };
        group.bench_function(format!("prepare, {name}"), |b| {
            b.iter(|| Grower::new(black_box(&normals), |n| &edges[n][..], 0.4, seeds).unwrap().candidates());
        });
    }
    // Few large clusters, and many small ones.
    for phi in [0.3, 0.01] {
        let mut grower = Grower::new(&normals, |n| &edges[n][..], 0.4, SeedOrder::MostCertain).unwrap();
        let clusters = grower.grow(phi).unwrap().len();
        group.bench_function(format!("grow at {phi} into {clusters} clusters"), |b| {
            b.iter(|| grower.grow(black_box(phi)).unwrap().len());
        });
    }
    let half: Vec<u32> = (0..normals.len() as u32).filter(|node| node % 2 == 0).collect();
    group.bench_function("part of every second node", |b| {
        b.iter(|| Subgraph::induced(black_box(&half), |n| &edges[n][..]));
    });
    group.finish();
}

criterion_group!(benches, grow);
criterion_main!(benches);
