//! A million points read from memory.

#![allow(clippy::cast_possible_truncation)]

use std::hint::black_box;
use std::time::Duration;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use terrace_io::{FieldChoice, pcd, ply};

const POINTS: usize = 1_000_000;

/// x, y, z in single precision along a curve.
fn coordinates() -> Vec<u8> {
    let values = (0..3 * POINTS).map(|i| (i as f32 * 1e-3).sin());
    values.flat_map(f32::to_le_bytes).collect()
}

fn ply_file(body: &[u8]) -> Vec<u8> {
    let header = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {POINTS}\nproperty float x\nproperty float y\n\
         property float z\nend_header\n"
    );
    [header.as_bytes(), body].concat()
}

fn pcd_file(data: &str, body: &[u8]) -> Vec<u8> {
    let header = format!(
        "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH {POINTS}\nHEIGHT 1\nPOINTS {POINTS}\n\
         DATA {data}\n"
    );
    [header.as_bytes(), body].concat()
}

/// Stored as literals: the least that unpacking can cost.
fn stored(body: &[u8]) -> Vec<u8> {
    let stream: Vec<u8> =
        body.chunks(32).flat_map(|piece| [&[(piece.len() - 1) as u8], piece].concat()).collect();
    [&(stream.len() as u32).to_le_bytes()[..], &(body.len() as u32).to_le_bytes(), &stream].concat()
}

fn read(c: &mut Criterion) {
    let body = coordinates();
    let choice = FieldChoice::Automatic;
    let mut group = c.benchmark_group("read a million points");
    group
        .sample_size(20)
        .measurement_time(Duration::from_secs(3))
        .throughput(Throughput::Elements(POINTS as u64));
    let file = ply_file(&body);
    group.bench_function("PLY binary", |b| b.iter(|| ply::read(black_box(&file), &choice)));
    let file = pcd_file("binary", &body);
    group.bench_function("PCD binary", |b| b.iter(|| pcd::read(black_box(&file), &choice)));
    let file = pcd_file("binary_compressed", &stored(&body));
    group.bench_function("PCD binary_compressed", |b| b.iter(|| pcd::read(black_box(&file), &choice)));
    group.finish();
}

criterion_group!(benches, read);
criterion_main!(benches);
