//! Time to scan each scene, and to copy a scan with noise, per point.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;
use terrace_synth::{Params, Scene, SceneKind, perturbed};
use terrace_types::{Frame, Scan, Sigma};

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

fn copies(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("copy");
    let points = 100_000;
    group.throughput(Throughput::Elements(points as u64));
    let covariance = [5e-4, 1e-4, 0.0, 4e-4, 1e-4, 3e-4];
    for (name, sigma) in [
        ("one_sigma", Sigma::Uniform(0.01)),
        ("per_axis", Sigma::PerAxis(vec![[0.01, 0.02, 0.03]; points])),
        ("covariance", Sigma::Covariance(vec![covariance; points])),
    ] {
        let exact = Scan::new(vec![[1.0, 2.0, 3.0]; points], sigma, Frame::World { sensor: None });
        group.bench_function(name, |b| {
            b.iter(|| exact.as_ref().map(|scan| perturbed(black_box(scan), 7, 0)));
        });
    }
    group.finish();
}

criterion_group!(benches, scenes, copies);
criterion_main!(benches);
