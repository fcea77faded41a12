//! Time to add points to a picture, and to finish a picture.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;
use terrace_draw::{Bounds, CloudPicture, DrawError, View, label_colour};
use terrace_synth::{Params, Scene};

fn cloud(criterion: &mut Criterion) {
    let Ok(room) = Scene::room().generate(&Params::default()) else { return };
    let merged = room.merged();
    let points = merged.scan.points();
    let Some(bounds) = Bounds::of(points.iter().copied()) else { return };
    let empty =
        || -> Result<_, DrawError> { CloudPicture::new(800, 600, View::from_degrees(-60.0, 48.0)?, bounds) };
    let Ok(mut picture) = empty() else { return };

    let mut group = criterion.benchmark_group("cloud");
    group.sample_size(10);
    group.throughput(Throughput::Elements(points.len() as u64));
    group.bench_function("add", |b| {
        b.iter(|| {
            for (point, label) in points.iter().zip(&merged.labels) {
                picture.add(*black_box(point), label_colour(*label));
            }
        });
    });
    group.bench_function("image", |b| b.iter(|| picture.image()));
    group.finish();
}

criterion_group!(benches, cloud);
criterion_main!(benches);
