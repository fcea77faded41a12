//! One noisy copy of a small scene: made, mapped and compared.

// A bench has no caller to report to.
#![allow(clippy::unwrap_used)]

use std::hint::black_box;
use std::num::NonZeroU32;

use criterion::{Criterion, criterion_group, criterion_main};
use terrace_synth::Scene;
use terrace_trials::{KnownPlace, Trials};

const POINTS: usize = 10_000;

fn copies(c: &mut Criterion) {
    let place = KnownPlace::Built { scene: Box::new(Scene::table()), points: Some(POINTS) };
    for (name, cells) in [("planes", false), ("planes and cells", true)] {
        let trials = Trials { copies: NonZeroU32::MIN, cells, ..Trials::default() };
        c.bench_function(&format!("copy/{name} of a table, 10 000 points"), |b| {
            b.iter(|| trials.run(black_box(&place), || {}).unwrap());
        });
    }
}

criterion_group!(benches, copies);
criterion_main!(benches);
