//! Memory of reading in chunks: it is that of a chunk, however large the file. A binary of its own, because the peak is
//! that of the process; one test in it, because tests run side by side.

#![allow(clippy::unwrap_used, clippy::panic, clippy::float_cmp)]
#![allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]

mod formats_support;

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use formats_support::memory::{close_to_the_peak, peak};
use terrace_io::{ReadOptions, ScanReader, Source};

const POINTS: usize = 500_000;
const CHUNK: usize = 10_000;

/// Writes a header and `count` times a record.
fn repeat(out: &mut dyn Write, header: &str, record: &[u8], count: usize) {
    out.write_all(header.as_bytes()).unwrap();
    for _ in 0..count {
        out.write_all(record).unwrap();
    }
}

fn ply_header(encoding: &str, vertices: &str) -> String {
    format!(
        "ply\nformat {encoding} 1.0\n{vertices}element vertex {POINTS}\nproperty float x\nproperty float y\n\
         property float z\nproperty float sigma\nend_header\n"
    )
}

fn pcd_header(data: &str) -> String {
    format!(
        "VERSION 0.7\nFIELDS x y z sigma\nSIZE 4 4 4 4\nTYPE F F F F\nWIDTH {POINTS}\nHEIGHT 1\nDATA {data}\n"
    )
}

fn npy(out: &mut dyn Write, order: &str) {
    let dictionary = format!("{{'descr': '<f4', 'fortran_order': {order}, 'shape': ({POINTS}, 3)}}\n");
    out.write_all(b"\x93NUMPY\x01\x00").unwrap();
    out.write_all(&u16::try_from(dictionary.len()).unwrap().to_le_bytes()).unwrap();
    repeat(out, &dictionary, &[0; 12], POINTS);
}

type Writer = fn(&mut dyn Write);

const FILES: [(&str, Writer); 10] = [
    ("PLY binary", |out| repeat(out, &ply_header("binary_little_endian", ""), &[0; 16], POINTS)),
    ("PLY binary, the other order, after faces", |out| {
        let faces = format!("element face {POINTS}\nproperty list uchar int corners\n");
        let header = ply_header("binary_big_endian", &faces);
        repeat(out, &header, &[1, 0, 0, 0, 7], POINTS);
        repeat(out, "", &[0; 16], POINTS);
    }),
    ("PLY binary, after a block", |out| {
        let block = format!("element weight {POINTS}\nproperty double w\n");
        repeat(out, &ply_header("binary_little_endian", &block), &[0; 8 + 16], POINTS);
    }),
    ("PLY ascii", |out| repeat(out, &ply_header("ascii", ""), b"1 2 3 0.5\n", POINTS)),
    ("PCD ascii", |out| repeat(out, &pcd_header("ascii"), b"1 2 3 0.5\n", POINTS)),
    ("PCD binary", |out| repeat(out, &pcd_header("binary"), &[0; 16], POINTS)),
    ("NPY", |out| npy(out, "False")),
    ("NPY, column after column", |out| npy(out, "True")),
    ("text", |out| repeat(out, "x,y,z,sigma\n", b"1,2,3,0.5\n", POINTS)),
    ("text of an old machine", |out| repeat(out, "", b"1 2 3\r", POINTS)),
];

fn read(path: &Path) -> usize {
    let mut reader = ScanReader::open(&Source::new(path), &ReadOptions::default(), CHUNK).unwrap();
    let mut points = 0;
    while let Some(scan) = reader.next_chunk().unwrap() {
        points += scan.len();
        reader.recycle(scan);
    }
    points
}

#[test]
fn memory_is_that_of_a_chunk() {
    // Points and errors of a chunk, twice for what a growing vector keeps; a piece of the file; and a mebibyte of slack.
    const MOST: u64 = 2 * 32 * CHUNK as u64 + (1 << 18) + (1 << 20);
    let folder = tempfile::tempdir().unwrap();
    let paths = FILES.map(|(name, write)| {
        let path = folder.path().join(name.replace(' ', "_") + ".xyz");
        let mut out = BufWriter::new(File::create(&path).unwrap());
        write(&mut out);
        out.flush().unwrap();
        path
    });
    let Some((before, _filler)) = close_to_the_peak() else {
        eprintln!("skipped: no /proc/self/status");
        return;
    };
    for ((name, _), path) in FILES.iter().zip(&paths) {
        assert_eq!(read(path), POINTS, "{name}");
        let asked = peak().unwrap() - before;
        assert!(asked < MOST, "{name}: {asked} bytes");
    }
    // The measure itself, and what reading as a whole takes.
    let whole = terrace_io::read_scan(&Source::new(&paths[0]), &ReadOptions::default()).unwrap();
    assert_eq!(whole.len(), POINTS);
    assert!(peak().unwrap() - before > 2 * MOST);
}
