//! Memory asked for by files whose headers promise too much. A binary of its own, because the peak is that of the
//! process; one test in it, because tests run side by side.

#![allow(clippy::unwrap_used, clippy::panic, clippy::float_cmp)]
#![allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]

mod formats_support;

use std::path::Path;

use formats_support::memory::{bombs, close_to_the_peak, multiplied, peak};
use formats_support::{Format, good_files, npy_bytes};
use terrace_io::{ReadOptions, ScanReader, Source, npy};

/// Reads a file in chunks; the number of points, if nothing is wrong with it.
fn read_in_chunks(path: &Path, size: usize) -> Option<usize> {
    let mut reader = ScanReader::open(&Source::new(path), &ReadOptions::default(), size).ok()?;
    let mut points = 0;
    while let Some(scan) = reader.next_chunk().ok()? {
        points += scan.len();
        reader.recycle(scan);
    }
    Some(points)
}

#[test]
fn promises_are_not_believed() {
    const POINTS: usize = 3000;
    const MOST: u64 = 16 << 20;
    let files = good_files(POINTS);
    let mut damaged = Vec::new();
    for good in &files {
        assert_eq!(good.format.read(&good.bytes).unwrap().points.len(), POINTS, "{}", good.name);
        damaged.extend(multiplied(&good.bytes, good.body).into_iter().map(|b| (good, b)));
        if good.name == "PCD Compressed" {
            damaged.extend(bombs(&good.bytes, good.body, POINTS).into_iter().map(|b| (good, b)));
        }
    }
    for shape in ["(0, 99999999999999999, 3)", "(99999999999999999, 0, 3)", "(99999999999999999, 0)"] {
        let file = npy_bytes("<f4", true, shape, &[]);
        assert!(npy::read(&file).map_or(true, |cloud| cloud.points.is_empty()));
        assert!(npy::read_scalars(&file).map_or(true, |scalars| scalars.is_empty()));
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scan.xyz");
    let Some((before, _filler)) = close_to_the_peak() else {
        eprintln!("skipped: no /proc/self/status");
        return;
    };
    let mut errors = 0;
    for (good, bytes) in &damaged {
        let read = good.format.read(bytes);
        if good.format == Format::Npy {
            let _ = (npy::read_labels(bytes), npy::read_scalars(bytes));
        }
        errors += usize::from(read.is_err());
        // Version numbers and viewpoints may change freely, but points never come from nothing.
        assert!(read.is_err() || read.unwrap().points.len() <= POINTS, "{}", good.name);
        std::fs::write(&path, bytes).unwrap();
        assert!(read_in_chunks(&path, usize::MAX / 2).is_none_or(|points| points <= POINTS), "{}", good.name);
        let asked = peak().unwrap() - before;
        assert!(
            asked < MOST,
            "{}: {asked} bytes for {:?}",
            good.name,
            String::from_utf8_lossy(&bytes[..good.body])
        );
    }
    assert!(errors > damaged.len() / 2, "{errors} errors of {}", damaged.len());

    // The measure itself: memory that is asked for and never touched counts.
    let room: Vec<u8> = Vec::with_capacity(MOST as usize + (1 << 20));
    std::hint::black_box(&room);
    assert!(peak().unwrap() - before >= MOST, "the peak does not count untouched memory");
}
