//! A VGA depth image to points, a trajectory, and points to coloured PLY.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use terrace_io::{
    DepthImage, ErrorSource, Intrinsics, LabelledPoint, PlyExtent, ReadOptions, Source, read_scan,
    trajectory, write_labelled_ply,
};
use terrace_types::PlaneId;

const WIDTH: u32 = 640;
const HEIGHT: u32 = 480;

/// A wall seen at a slant, in millimetres, with some pixels lost.
fn depth_image() -> DepthImage {
    let pixel = |i: u32| if i.is_multiple_of(17) { 0 } else { 1000 + (i % WIDTH) * 3 + i / WIDTH };
    let raw = (0..WIDTH * HEIGHT).map(|i| u16::try_from(pixel(i)).unwrap_or(0)).collect();
    DepthImage { width: WIDTH, height: HEIGHT, raw }
}

fn as_png(image: &DepthImage) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, WIDTH, HEIGHT);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Sixteen);
    let data: Vec<u8> = image.raw.iter().flat_map(|r| r.to_be_bytes()).collect();
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&data)?;
    writer.finish()?;
    Ok(bytes)
}

#[allow(clippy::unwrap_used, reason = "a bench may fail")]
fn benches(c: &mut Criterion) {
    let image = depth_image();
    let png = as_png(&image).unwrap();
    let camera = Intrinsics::new(585.0, 585.0, 320.0, 240.0).unwrap();
    let points = image.points(&camera, 1000.0).unwrap();
    let tum =
        (0..10_000).map(|t| format!("{t}.25 1.5 2.5 -0.5 0.1 0.2 0.3 0.9\n")).collect::<Vec<_>>().concat();
    let present = || points.iter().copied().filter(|p| p[2].is_finite());
    let extent = PlyExtent::of(present());
    let labelled = || present().map(|position| LabelledPoint { position, plane: PlaneId::new(1) });
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("points.ply");

    let mut group = c.benchmark_group("io");
    group.throughput(Throughput::Elements(points.len() as u64));
    group.bench_function("depth PNG", |b| b.iter(|| DepthImage::read(black_box(&png)).unwrap()));
    group.bench_function("depth to points", |b| b.iter(|| image.points(black_box(&camera), 1000.0).unwrap()));
    let source = Source::new(folder.path().join("image.png"));
    std::fs::write(&source.path, &png).unwrap();
    let plain = ReadOptions { intrinsics: Some(camera), ..ReadOptions::default() };
    group.bench_function("depth image to scan", |b| b.iter(|| read_scan(&source, &plain).unwrap()));
    for model in ["kinect", "stereo:fb=80,disparity=0.2,focal=700", "lidar:range=0.02,angle=1mrad"] {
        let options = ReadOptions { errors: ErrorSource::Model(model.parse().unwrap()), ..plain.clone() };
        let name = format!("depth image to scan, {model}");
        group.bench_function(&name, |b| b.iter(|| read_scan(&source, &options).unwrap()));
    }
    group.throughput(Throughput::Elements(10_000));
    group.bench_function("TUM poses", |b| b.iter(|| trajectory::read(black_box(tum.as_bytes())).unwrap()));
    group.throughput(Throughput::Elements(extent.points));
    group.bench_function("coloured PLY", |b| {
        b.iter(|| write_labelled_ply(&path, extent, labelled()).unwrap());
    });
    group.finish();
}

criterion_group!(all, benches);
criterion_main!(all);
