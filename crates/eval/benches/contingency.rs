//! Counting a million points, and what is made of the counts.

// A bench has no caller to report to.
#![allow(clippy::unwrap_used)]

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use terrace_eval::Contingency;
use terrace_types::PlaneId;

const POINTS: u32 = 1_000_000;

/// Labels of 200 planes in runs of `run` points, from a fixed sequence.
fn labels(run: u32, turn: u32) -> Vec<Option<PlaneId>> {
    (0..POINTS).map(|i| PlaneId::new((i / run).wrapping_mul(2_654_435_761).rotate_left(turn) % 201)).collect()
}

fn contingency(c: &mut Criterion) {
    for run in [1, 20] {
        let (truth, found) = (labels(run, 3), labels(run, 9));
        c.bench_function(&format!("count/1M points in runs of {run}"), |b| {
            b.iter(|| Contingency::new(black_box(&truth), black_box(&found)).unwrap());
        });
    }
    let both = Contingency::new(&labels(1, 3), &labels(1, 9)).unwrap();
    c.bench_function("weighted cover/200 by 200 planes", |b| b.iter(|| black_box(&both).weighted_cover()));
}

criterion_group!(benches, contingency);
criterion_main!(benches);
