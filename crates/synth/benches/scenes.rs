//! Time to scan each scene, per point.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;
use terrace_synth::{Params, Scene, SceneKind};

fn scenes(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("scan");
    let points = 100_000;
    group.throughput(Throughput::Elements(points as u64));
    for kind in SceneKind::ALL {
        let scene = Scene::new(kind);
        let params = Params { points: Some(points), ..Params::default() };
        group.bench_function(BenchmarkId::from_parameter(kind), |b| {
            b.iter(|| {
                let chunks = scene.chunks(black_box(&params), 8_192).into_iter().flatten();
                chunks.map(|chunk| chunk.scan.labels.len()).sum::<usize>()
            });
        });
    }
    group.finish();
}

criterion_group!(benches, scenes);
criterion_main!(benches);
