//! Files of four million points read in chunks, and labels and coloured points written in chunks. Files are in the cache
//! of the system.

#![allow(clippy::cast_possible_truncation, clippy::unwrap_used, reason = "a bench may fail")]

use std::hint::black_box;
use std::path::PathBuf;
use std::time::Duration;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use terrace_io::{LabelledPoint, LabelsWriter, PlyExtent, PlyWriter, ReadOptions, ScanReader, Source};
use terrace_types::PlaneId;

const POINTS: usize = 4_000_000;
const CHUNK: usize = 1 << 16;

/// Records of x, y and z along a curve with more bytes behind them.
fn records<const N: usize>(encode: impl Fn(f32) -> [u8; N], more: &[u8]) -> Vec<u8> {
    let point = |i: usize| {
        let xyz = [0, 1, 2].map(|axis| encode(((3 * i + axis) as f32 * 1e-3).sin()));
        [xyz.as_flattened(), more].concat()
    };
    (0..POINTS).flat_map(point).collect()
}

fn ply(encoding: &str, more: &str) -> String {
    format!(
        "ply\nformat {encoding} 1.0\nelement vertex {POINTS}\nproperty float x\nproperty float y\nproperty float z\n\
         {more}end_header\n"
    )
}

fn npy(descr: &str, order: &str) -> Vec<u8> {
    let dictionary = format!("{{'descr': '{descr}', 'fortran_order': {order}, 'shape': ({POINTS}, 3)}}\n");
    [b"\x93NUMPY\x01\x00", &(dictionary.len() as u16).to_le_bytes()[..], dictionary.as_bytes()].concat()
}

fn read(path: &PathBuf) -> usize {
    let mut reader = ScanReader::open(&Source::new(path), &ReadOptions::default(), CHUNK).unwrap();
    let mut points = 0;
    while let Some(scan) = reader.next_chunk().unwrap() {
        points += black_box(&scan).len();
        reader.recycle(scan);
    }
    points
}

fn readers(c: &mut Criterion) {
    let colours = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    let pcd = format!(
        "VERSION 0.7\nFIELDS x y z i\nSIZE 4 4 4 4\nTYPE F F F F\nWIDTH {POINTS}\nHEIGHT 1\nDATA binary\n"
    );
    let lines = || {
        let line = |i: usize| {
            let [x, y, z] = [0, 1, 2].map(|axis| ((3 * i + axis) as f32 * 1e-3).sin());
            format!("{x:.4} {y:.4} {z:.4}\n").into_bytes()
        };
        (0..POINTS).flat_map(line).collect::<Vec<u8>>()
    };
    let little = || records(f32::to_le_bytes, &[]);
    let files: [(&str, Vec<u8>); 10] = [
        ("PLY binary", [ply("binary_little_endian", "").as_bytes(), &little()].concat()),
        (
            "PLY binary, big-endian",
            [ply("binary_big_endian", "").as_bytes(), &records(f32::to_be_bytes, &[])].concat(),
        ),
        (
            "PLY binary, colours",
            [ply("binary_little_endian", colours).as_bytes(), &records(f32::to_le_bytes, &[1, 2, 3])]
                .concat(),
        ),
        (
            "PLY binary, sigma",
            [
                ply("binary_little_endian", "property float sigma\n").as_bytes(),
                &records(f32::to_le_bytes, &[0; 4]),
            ]
            .concat(),
        ),
        ("PCD binary, intensities", [pcd.as_bytes(), &records(f32::to_le_bytes, &[0; 4])].concat()),
        ("NPY f4", [npy("<f4", "False"), little()].concat()),
        ("NPY f8", [npy("<f8", "False"), records(|x| f64::from(x).to_le_bytes(), &[])].concat()),
        ("NPY f4, Fortran order", [npy("<f4", "True"), little()].concat()),
        ("PLY ascii", [ply("ascii", "").into_bytes(), lines()].concat()),
        ("text", lines()),
    ];
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scan.xyz");
    let mut group = c.benchmark_group("read in chunks");
    group
        .sample_size(10)
        .measurement_time(Duration::from_secs(2))
        .throughput(Throughput::Elements(POINTS as u64));
    for (name, bytes) in files {
        std::fs::write(&path, bytes).unwrap();
        group.bench_function(name, |b| b.iter(|| assert_eq!(read(&path), POINTS)));
    }
    group.finish();
}

fn writers(c: &mut Criterion) {
    // Planes change along rows of points, as in scans.
    let planes: Vec<_> = (0..CHUNK).map(|i| PlaneId::from_index(i / 50 % 30)).collect();
    let point = |i: usize| LabelledPoint { position: [i as f64 * 1e-3, 1.0, 2.0], plane: planes[i] };
    let points: Vec<_> = (0..CHUNK).map(point).collect();
    let folder = tempfile::tempdir().unwrap();
    let count = (POINTS / CHUNK * CHUNK) as u64;
    let mut group = c.benchmark_group("write in chunks");
    group.sample_size(10).measurement_time(Duration::from_secs(2)).throughput(Throughput::Elements(count));
    let path = folder.path().join("labels.npy");
    // Dropped unfinished: what the disk takes to hold the file for good is not measured.
    group.bench_function("labels", |b| {
        b.iter(|| {
            let mut writer = LabelsWriter::create(&path, count).unwrap();
            (0..POINTS / CHUNK).for_each(|_| writer.push(black_box(&planes).iter().copied()).unwrap());
        });
    });
    for (name, largest) in [("points", 66.0), ("points in double precision", 5000.0)] {
        group.bench_function(name, |b| {
            b.iter(|| {
                let mut writer = PlyWriter::create(&path, PlyExtent { points: count, largest }).unwrap();
                (0..POINTS / CHUNK).for_each(|_| writer.push(black_box(&points).iter().copied()).unwrap());
            });
        });
    }
    group.finish();
}

criterion_group!(benches, readers, writers);
criterion_main!(benches);
