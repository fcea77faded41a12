//! The whole staircase of a wavy surface, from φ = 0 to the last step: by fresh runs, by repairs, and by repairs that
//! give up where the cost `Σ n s / n + 10⁻³ N` cannot be the least.

// A bench has no caller to report to, and its numbers are small.
#![allow(clippy::unwrap_used, clippy::cast_possible_truncation)]

use std::hint::black_box;
use std::time::Duration;

use criterion::{Criterion, criterion_group, criterion_main};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use terrace_cluster::{Grower, Outcome, SeedOrder, Stair, Staircase};
use terrace_stats::UncertainVector;

const SIDE: usize = 39;
const OMEGA: f64 = 0.4;

/// Normals of `z = sin x + cos y / 2`, with noise about as large as the errors they state.
fn normals() -> Vec<Option<UncertainVector>> {
    let mut rng = ChaCha8Rng::seed_from_u64(0);
    let mut normal = |node: usize| {
        let [x, y] = [node / SIDE, node % SIDE].map(|i| 9.0 * i as f64 / SIDE as f64);
        let error = rng.random_range(0.01..0.05);
        let v = [-x.cos(), 0.5 * y.sin(), 1.0];
        let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let v = v.map(|x| x / length + rng.random_range(-error..error));
        let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
        Some(UncertainVector::isotropic(v.map(|x| x / length), error))
    };
    (0..SIDE * SIDE).map(&mut normal).collect()
}

/// Eight neighbours each.
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

fn cost(stair: &Stair) -> f64 {
    stair.weighted_uncertainty / (SIDE * SIDE) as f64 + 1e-3 * stair.clusters as f64
}

/// The steps, and the distances compared.
type Work = (usize, u64);

fn fresh<'g>(
    normals: &[Option<UncertainVector>],
    edges: impl Fn(usize) -> &'g [u32],
    seeds: SeedOrder,
) -> Work {
    let mut grower = Grower::new(normals, edges, OMEGA, seeds).unwrap();
    let (mut phi, mut work) = (Some(0.0), (0, 0));
    while let Some(at) = phi {
        let result = grower.grow(at).unwrap();
        work = (work.0 + 1, work.1 + result.tests());
        phi = result.interval().hi;
    }
    work
}

fn repaired<'g>(
    normals: &[Option<UncertainVector>],
    edges: impl Fn(usize) -> &'g [u32],
    seeds: SeedOrder,
    give_up: bool,
) -> Work {
    let mut staircase = Staircase::new(normals, edges, OMEGA, seeds).unwrap();
    let (mut phi, mut best, mut steps) = (Some(0.0), f64::INFINITY, 0);
    while let Some(at) = phi {
        steps += 1;
        phi = match staircase.at_while(at, |least| !give_up || cost(least) < best).unwrap() {
            Outcome::Complete(stair) => {
                best = best.min(cost(&stair));
                stair.interval.hi
            }
            Outcome::GivenUp(least) => least.interval.hi,
        };
    }
    (steps, staircase.tests())
}

fn walk(c: &mut Criterion) {
    let (normals, edges) = (normals(), edges());
    let around = |node: usize| &edges[node][..];
    let mut group = c.benchmark_group("1521 nodes");
    group.sample_size(10).warm_up_time(Duration::from_millis(500)).measurement_time(Duration::from_secs(3));
    for (order, seeds) in
        [("most certain", SeedOrder::MostCertain), ("random", SeedOrder::Random { seed: 1 })]
    {
        group.bench_function(format!("{order}: prepare"), |b| {
            b.iter(|| Staircase::new(black_box(&normals), around, OMEGA, seeds).unwrap().candidates());
        });
        group.bench_function(format!("{order}: prepare and first step"), |b| {
            b.iter(|| Staircase::new(black_box(&normals), around, OMEGA, seeds).unwrap().at(0.05));
        });
        let (steps, tests) = fresh(&normals, around, seeds);
        println!("{order}: {steps} steps by fresh runs compare {tests} distances");
        group.bench_function(format!("{order}: fresh runs"), |b| {
            b.iter(|| fresh(black_box(&normals), around, seeds));
        });
        for (name, give_up) in [("repaired", false), ("repaired, giving up", true)] {
            let (steps, tests) = repaired(&normals, around, seeds, give_up);
            println!("{order}: {steps} steps {name} compare {tests} distances");
            group.bench_function(format!("{order}: {name}"), |b| {
                b.iter(|| repaired(black_box(&normals), around, seeds, give_up));
            });
        }
    }
    group.finish();
}

criterion_group!(benches, walk);
criterion_main!(benches);
