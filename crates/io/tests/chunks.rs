//! Files read in chunks: the same points, errors and complaints as files read as a whole, whatever the chunk size.

#![allow(clippy::unwrap_used, clippy::panic, clippy::float_cmp)]
#![allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]

mod common;
mod formats_support;

use std::path::{Path, PathBuf};

use common::depth_png;
use formats_support::{
    Damage, Format, PCD_DATA, PLY_ENCODINGS, PlyExtras, apply, columns, damage, good_files, npy_bytes,
    pcd_bytes, ply_bytes, rows, same,
};
use proptest::prelude::*;
use tempfile::TempDir;
use terrace_io::{
    ErrorSource, FieldChoice, ReadErrorKind, ReadOptions, ScanReader, Source, read_counted, read_scan,
};
use terrace_types::{Frame, Pose, Scan, Sigma};

/// A file that is written anew for every case.
struct Place(TempDir);

impl Place {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn file(&self, format: Format, bytes: &[u8]) -> PathBuf {
        let extension = match format {
            Format::Ply => "ply",
            Format::Pcd => "pcd",
            Format::Text => "xyz",
            Format::Npy => "npy",
        };
        let path = self.0.path().join("scan").with_extension(extension);
        // Some file systems flush a file that is truncated, but not a new one.
        let _ = std::fs::remove_file(&path);
        std::fs::write(&path, bytes).unwrap();
        path
    }
}

/// What came of reading a file: points, one row of errors for each that has any, and the frame; or the complaint, and
/// whether it is about values that a scan may not have.
#[derive(Debug)]
struct Outcome {
    points: Vec<[f64; 3]>,
    errors: Vec<Option<[f64; 3]>>,
    frame: Option<Frame>,
    end: Result<usize, (String, bool)>,
}

impl Outcome {
    fn add(&mut self, scan: &Scan) {
        self.points.extend(scan.points());
        self.errors.extend((0..scan.len()).map(|i| scan.sigma().of(i)));
        self.frame = Some(scan.frame());
    }

    fn whole(source: &Source, options: &ReadOptions) -> Self {
        let mut outcome = Self { points: Vec::new(), errors: Vec::new(), frame: None, end: Ok(0) };
        match read_counted(source, options) {
            Ok(counted) => {
                outcome.add(&counted.scan);
                outcome.end = Ok(counted.not_measured);
            }
            Err(error) => {
                outcome.end = Err((error.to_string(), matches!(*error.kind, ReadErrorKind::Scan(_))));
            }
        }
        outcome
    }

    /// In chunks, some of whose memory is given back.
    fn chunked(source: &Source, options: &ReadOptions, size: usize) -> Self {
        let mut outcome = Self { points: Vec::new(), errors: Vec::new(), frame: None, end: Ok(0) };
        let mut read = || {
            let mut reader = ScanReader::open(source, options, size)?;
            let mut last = size;
            let mut chunks = 0;
            while let Some(scan) = reader.next_chunk()? {
                assert!(last == size && scan.len() <= size && !scan.is_empty(), "{} points", scan.len());
                last = scan.len();
                outcome.add(&scan);
                assert_eq!(scan.frame(), reader.frame());
                chunks += 1;
                if chunks % 3 != 0 {
                    reader.recycle(scan);
                }
            }
            assert!(reader.next_chunk()?.is_none());
            let promised = reader.points();
            assert!(promised.is_none_or(|promised| promised == outcome.points.len() as u64));
            Ok(reader.not_measured())
        };
        outcome.end = read().map_err(|error: terrace_io::ReadError| {
            (error.to_string(), matches!(*error.kind, ReadErrorKind::Scan(_)))
        });
        outcome
    }

    /// The same in the end, and no other points before a complaint than those of `whole`, if it has any.
    fn agrees_with(&self, whole: &Self) -> bool {
        let same_errors = |a: &[Option<[f64; 3]>], b: &[Option<[f64; 3]>]| {
            let rows = |errors: &[Option<[f64; 3]>]| {
                errors.iter().map(|e| e.unwrap_or([-1.0; 3])).collect::<Vec<_>>()
            };
            same(&rows(a), &rows(b))
        };
        match (&self.end, &whole.end) {
            (Ok(absent), Ok(expected)) => {
                absent == expected
                    && same(&self.points, &whole.points)
                    && same_errors(&self.errors, &whole.errors)
                    && (self.frame == whole.frame || self.points.is_empty())
            }
            // A value that a scan may not have may come in a chunk before other damage.
            (Err((message, of_values)), Err((expected, _))) => message == expected || *of_values,
            _ => false,
        }
    }
}

fn model(text: &str) -> ReadOptions {
    ReadOptions { errors: ErrorSource::Model(text.parse().unwrap()), ..ReadOptions::default() }
}

/// With fields for errors, and without looking at them.
fn options() -> [ReadOptions; 2] {
    [
        ReadOptions::default(),
        ReadOptions { errors: ErrorSource::FromFile(FieldChoice::Ignore), ..ReadOptions::default() },
    ]
}

fn check(path: &Path, size: usize, what: &str) {
    let source = Source::new(path);
    for options in options() {
        let (whole, chunked) = (Outcome::whole(&source, &options), Outcome::chunked(&source, &options, size));
        assert!(chunked.agrees_with(&whole), "{what} by {size}: {chunked:?} instead of {whole:?}");
        if options.errors == ErrorSource::FromFile(FieldChoice::Ignore)
            && let Err((message, _)) = &whole.end
        {
            assert!(matches!(&chunked.end, Err((other, _)) if other == message), "{what} by {size}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn any_columns_in_any_chunks(
        columns in columns(),
        size in 1_usize..25,
        faces in (0_usize..4, 0_usize..4, any::<bool>(), any::<bool>()),
    ) {
        let place = Place::new();
        let expected = rows(&columns, ["x", "y", "z"]);
        let extras = PlyExtras { faces_before: faces.0, faces_after: faces.1, list: faces.2, crlf: faces.3 };
        let ply = PLY_ENCODINGS.map(|encoding| (Format::Ply, ply_bytes(&columns, encoding, extras)));
        let pcd = PCD_DATA.map(|data| (Format::Pcd, pcd_bytes(&columns, data)));
        for (format, bytes) in ply.into_iter().chain(pcd) {
            let source = Source::new(place.file(format, &bytes));
            let chunked = Outcome::chunked(&source, &ReadOptions::default(), size);
            prop_assert!(chunked.end.is_ok() && same(&chunked.points, &expected), "{:?}: {:?}", format, chunked);
        }
    }

    #[test]
    fn arrays_in_either_order(
        height in 0_usize..6, width in 1_usize..6, image: bool, fortran: bool, double: bool, size in 1_usize..40
    ) {
        let count = height * width;
        // Every coordinate tells its place.
        let value = |point: usize, axis: usize| (point * 10 + axis) as f64;
        let index = |i: usize| match (fortran, image) {
            (false, _) => (i / 3, i % 3),
            (true, false) => (i % count, i / count),
            (true, true) => ((i % height) * width + i / height % width, i / count),
        };
        let values = (0..3 * count).map(index).map(|(point, axis)| value(point, axis));
        let data: Vec<u8> = if double {
            values.flat_map(f64::to_le_bytes).collect()
        } else {
            values.flat_map(|v| (v as f32).to_le_bytes()).collect()
        };
        let shape = if image { format!("({height}, {width}, 3)") } else { format!("({count}, 3)") };
        let bytes = npy_bytes(if double { "<f8" } else { "<f4" }, fortran, &shape, &data);
        let place = Place::new();
        let source = Source::new(place.file(Format::Npy, &bytes));
        let chunked = Outcome::chunked(&source, &ReadOptions::default(), size);
        let expected: Vec<_> = (0..count).map(|point| [0, 1, 2].map(|axis| value(point, axis))).collect();
        prop_assert!(chunked.end.is_ok());
        prop_assert_eq!(chunked.points, expected);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn damaged_files_in_chunks_complain_alike(
        which in any::<prop::sample::Index>(), all in prop::collection::vec(damage(), 1..4), size in 1_usize..6
    ) {
        let files = good_files(5);
        let good = &files[which.index(files.len())];
        let mut bytes = good.bytes.clone();
        for damage in &all {
            apply(&mut bytes, damage);
        }
        let place = Place::new();
        check(&place.file(good.format, &bytes), size, &good.name);
    }
}

#[test]
fn cut_at_every_byte() {
    let place = Place::new();
    for good in good_files(3) {
        for cut in 0..=good.bytes.len() {
            let path = place.file(good.format, &good.bytes[..cut]);
            for size in [1, 2, 3, 4] {
                check(&path, size, &format!("{} cut at {cut}", good.name));
            }
        }
    }
}

#[test]
fn every_bit_flipped() {
    let place = Place::new();
    for (index, good) in good_files(3).iter().enumerate() {
        for at in 0..good.bytes.len() {
            // Which bits of a byte come with which chunk size goes round from byte to byte.
            for bit in (0..8).filter(|bit| (bit + at + index) % 2 == 0) {
                let mut bytes = good.bytes.clone();
                apply(&mut bytes, &Damage::Set(at, good.bytes[at] ^ 1 << bit));
                check(
                    &place.file(good.format, &bytes),
                    1 + (at + bit) % 3,
                    &format!("{} bit {bit} of {at}", good.name),
                );
            }
        }
    }
}

#[test]
fn chunks_before_the_damage_are_given() {
    let place = Place::new();
    let text = "0 0 0\n1 0 0\n2 0 0\n3 0 0\n4 zero 0\n";
    let source = Source::new(place.file(Format::Text, text.as_bytes()));
    let mut reader = ScanReader::open(&source, &ReadOptions::default(), 2).unwrap();
    for first in [0.0, 2.0] {
        assert_eq!(
            reader.next_chunk().unwrap().unwrap().points(),
            [[first, 0.0, 0.0], [first + 1.0, 0.0, 0.0]]
        );
    }
    let error = reader.next_chunk().unwrap_err().to_string();
    assert!(error.contains("scan.xyz") && error.contains("line 5: `zero`"), "{error}");
    assert!(reader.next_chunk().unwrap().is_none());
}

#[test]
fn a_standard_error_refused_tells_the_point_of_the_file() {
    let place = Place::new();
    let text = "x y z sigma\n".to_owned() + &"0 0 0 1\n".repeat(7) + "0 0 0 -2\n";
    let source = Source::new(place.file(Format::Text, text.as_bytes()));
    let whole = read_scan(&source, &ReadOptions::default()).unwrap_err().to_string();
    assert!(whole.contains("-2 of point 7"), "{whole}");
    let chunked = Outcome::chunked(&source, &ReadOptions::default(), 3);
    assert_eq!(chunked.end, Err((whole, true)));
    assert_eq!(chunked.points.len(), 6);
}

#[test]
fn noise_models_and_poses_hold_for_every_chunk() {
    let place = Place::new();
    // The second and the last point are at the sensor.
    let text = "1 0 0\n0 0 0\n2 0 0\n0 3 0\n0 0 0\n";
    let pose = Pose::from_quaternion([1.0, 2.0, 3.0], [0.0, 0.6, 0.0, 0.8]).unwrap();
    let source = Source { pose: Some(pose), ..Source::new(place.file(Format::Text, text.as_bytes())) };
    for model in ["lidar:range=0.02,angle=0.1deg", "kinect", "uniform:0.01", "axes:0.01,0.02,0.03"].map(model)
    {
        let whole = Outcome::whole(&source, &model);
        for size in 1..7 {
            let chunked = Outcome::chunked(&source, &model, size);
            assert!(chunked.agrees_with(&whole), "{chunked:?} instead of {whole:?}");
            assert_eq!(chunked.frame, Some(Frame::Sensor { pose }));
        }
    }
    let lidar = model("lidar:range=0.02,angle=0.1deg");
    assert_eq!(Outcome::chunked(&source, &lidar, 2).end, Ok(2));
    // Without a pose the model has no sensor, in chunks as in a whole.
    let homeless = Source::new(&source.path);
    assert!(Outcome::chunked(&homeless, &lidar, 2).agrees_with(&Outcome::whole(&homeless, &lidar)));
}

/// All points of a file read without errors, and how many the model left out.
fn bare(source: &Source, options: &ReadOptions, size: usize) -> (Vec<[f64; 3]>, usize) {
    let mut reader = ScanReader::open_bare(source, options, size).unwrap();
    let mut points = Vec::new();
    while let Some(scan) = reader.next_chunk().unwrap() {
        assert_eq!(scan.sigma(), &Sigma::Unknown);
        points.extend(scan.points());
        reader.recycle(scan);
    }
    (points, reader.not_measured())
}

#[test]
fn points_without_their_errors_are_those_with_them() {
    let place = Place::new();
    // The second point is at the sensor, the last behind it.
    let text = "x y z sigma\n1 0 2 0.1\n0 0 0 0.2\nnan 0 1 0.1\n0 3 1 0.1\n0 0 -1 0.1\n";
    let pose = Pose::from_quaternion([1.0, 2.0, 3.0], [0.0, 0.6, 0.0, 0.8]).unwrap();
    let cloud = Source { pose: Some(pose), ..Source::new(place.file(Format::Text, text.as_bytes())) };
    let path = place.0.path().join("scan.png");
    std::fs::write(&path, depth_png(2, &[1400, 0, 65535, 2400])).unwrap();
    let image = Source::new(&path);
    let models =
        ["lidar:range=0.02,angle=0.1deg", "kinect", "uniform:0.01", "axes:0.01,0.02,0.03"].map(model);
    for options in models.into_iter().chain([ReadOptions::default()]) {
        let options = ReadOptions { intrinsics: Some("585,585,0,0".parse().unwrap()), ..options };
        for source in [&cloud, &image] {
            let whole = read_counted(source, &options).unwrap();
            for size in [1, 2, 9] {
                let (points, not_measured) = bare(source, &options, size);
                assert!(same(&points, whole.scan.points()), "{options:?}");
                assert_eq!(not_measured, whole.not_measured, "{options:?}");
            }
        }
    }
    // What is wrong with errors was told when they were read.
    let source = Source::new(place.file(Format::Text, b"x y z sigma\n0 0 0 -2\n"));
    assert!(read_scan(&source, &ReadOptions::default()).is_err());
    assert_eq!(bare(&source, &ReadOptions::default(), 2).0, [[0.0; 3]]);
    let homeless = Source::new(&cloud.path);
    let mut reader = ScanReader::open_bare(&homeless, &model("kinect"), 2).unwrap();
    assert!(matches!(*reader.next_chunk().unwrap_err().kind, ReadErrorKind::NoSensorPosition { .. }));
}

#[test]
fn a_depth_image_is_one_chunk() {
    let place = Place::new();
    let path = place.0.path().join("scan.png");
    std::fs::write(&path, depth_png(2, &[1400, 0, 65535, 2400])).unwrap();
    let options = ReadOptions { intrinsics: Some("585,585,0,0".parse().unwrap()), ..model("kinect") };
    let source = Source::new(&path);
    let mut reader = ScanReader::open(&source, &options, 1).unwrap();
    assert_eq!(reader.points(), Some(4));
    let scan = reader.next_chunk().unwrap().unwrap();
    let whole = read_scan(&source, &options).unwrap();
    assert!(same(scan.points(), whole.points()) && matches!(scan.sigma(), Sigma::Covariance(_)));
    reader.recycle(scan);
    assert!(reader.next_chunk().unwrap().is_none());
}

#[test]
fn files_without_points_have_no_chunk() {
    let place = Place::new();
    for good in good_files(0).iter().filter(|good| good.format != Format::Text) {
        let source = Source::new(place.file(good.format, &good.bytes));
        let mut reader = ScanReader::open(&source, &ReadOptions::default(), 0).unwrap();
        assert_eq!((reader.points(), reader.next_chunk().unwrap()), (Some(0), None), "{}", good.name);
    }
}

#[test]
fn how_far_a_file_was_read_is_told() {
    let place = Place::new();
    let rows: String = (0..40_000).map(|k| format!("{k} 1.5 2.5\n")).collect();
    let path = place.file(Format::Text, rows.as_bytes());
    let mut reader = ScanReader::open(&Source::new(&path), &ReadOptions::default(), 10_000).unwrap();
    let mut told = vec![reader.bytes_read()];
    while reader.next_chunk().unwrap().is_some() {
        told.push(reader.bytes_read());
    }
    assert!(told.is_sorted() && told[1] < rows.len() as u64, "{told:?}");
    assert_eq!(told[4], rows.len() as u64);
}
