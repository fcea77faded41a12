//! Insertion of a hundred thousand points of a room, extraction of its planes, labels of points that were not kept, and the choice of a
//! cell size.
#![allow(clippy::unwrap_used, reason = "a bench has no caller to report to")]

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use terrace::{Mapper, Params, Scan, choose_cell_size};
use terrace_synth::Scene;

fn room() -> Vec<Scan> {
    let params = terrace_synth::Params { points: Some(100_000), ..Default::default() };
    Scene::room().generate(&params).unwrap().scans.into_iter().map(|s| s.scan).collect()
}

fn inserted(scans: &[Scan], params: Params) -> Mapper {
    let mut mapper = Mapper::new(params).unwrap();
    for scan in scans {
        mapper.insert(scan).unwrap();
    }
    mapper
}

fn benches(c: &mut Criterion) {
    let scans = room();
    c.bench_function("choose_cell_size/7143 points", |b| b.iter(|| choose_cell_size(black_box(&scans[0]))));
    for (name, preset) in
        [("default", Params::default()), ("clusters", Params::clusters()), ("paper", Params::paper())]
    {
        c.bench_function(&format!("insert/100000 points/{name}"), |b| {
            b.iter(|| inserted(black_box(&scans), preset).len());
        });
        let mapper = inserted(&scans, preset);
        c.bench_function(&format!("extract/100000 points/{name}"), |b| {
            b.iter(|| black_box(&mapper).extract().unwrap().planes.len());
        });
    }
    let mut mapper = Mapper::streaming(Params::default()).unwrap();
    for scan in &scans {
        mapper.insert(scan).unwrap();
    }
    c.bench_function("label again/100000 points/default", |b| {
        let (_, mut labels) = mapper.extract_streamed(|_| {}).unwrap();
        let mut of_scan = Vec::new();
        b.iter(|| {
            for (view, scan) in scans.iter().enumerate() {
                labels.label(view, black_box(scan), &mut of_scan);
            }
        });
    });
}

criterion_group! {
    name = extract;
    config = Criterion::default().sample_size(10);
    targets = benches
}
criterion_main!(extract);
