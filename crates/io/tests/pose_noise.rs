//! The noise of poses: its file, and which scan each row belongs to.
#![allow(
    clippy::unwrap_used,
    clippy::cast_possible_truncation,
    clippy::float_cmp,
    reason = "a test may fail, and compares exactly"
)]

mod common;

use std::path::{Path, PathBuf};

use common::write;
use proptest::prelude::*;
use terrace_io::pose_noise::{self, PoseNoiseTextError};
use terrace_io::{Source, SourceError, find_sources, find_uncertain_sources};
use terrace_noise::PoseNoise;

/// A diagonal covariance with 1 to 6 times `unit`.
fn row(unit: f64, separator: &str) -> String {
    let entry = |i: usize| if i.is_multiple_of(7) { (i / 7 + 1) as f64 * unit } else { 0.0 };
    (0..36).map(|i| entry(i).to_string()).collect::<Vec<_>>().join(separator)
}

#[test]
fn rows_of_two_and_of_thirty_six() {
    let two = pose_noise::read(b"\xef\xbb\xbf# t r\r\n0.02,0.001\r\n\r\n0.05 0.002 # later\n0,0,\n").unwrap();
    let expected = [(0.02, 0.001), (0.05, 0.002), (0.0, 0.0)];
    assert_eq!(two, expected.map(|(t, r)| PoseNoise::from_radians(t, r).unwrap()));
    for separator in [" ", ",", " , ", "\t"] {
        let text = format!("{}\n{}", row(1e-4, separator), row(2e-4, separator));
        let noise = pose_noise::read(text.as_bytes()).unwrap();
        assert_eq!(noise.len(), 2);
        for (i, (first, second)) in
            noise[0].covariance().as_flattened().iter().zip(noise[1].covariance().as_flattened()).enumerate()
        {
            let expected = if i % 7 == 0 { (i / 7 + 1) as f64 * 1e-4 } else { 0.0 };
            assert!((first - expected).abs() < 1e-18 && (second - 2.0 * expected).abs() < 1e-18);
        }
    }
}

#[test]
fn what_is_wrong_is_told_with_line_and_value() {
    let told = |text: &str| pose_noise::read(text.as_bytes()).unwrap_err().to_string();
    let whole = row(1.0, " ");
    let cases = [
        ("# only a comment\n".to_owned(), vec!["no row"]),
        ("0.1 0.2\n\n0.1 wide\n".to_owned(), vec!["line 3, value 2", "'wide'"]),
        ("0.1,,0.2\n".to_owned(), vec!["line 1, value 2", "''"]),
        ("1 0 0 0 0 0\n0 1 0 0 0 0\n".to_owned(), vec!["line 1 has 6 values", "36", "2"]),
        (format!("{whole}\n0.1 0.2\n"), vec!["line 2 has 2 values where 36"]),
        (format!("{whole} 7 8 9\n"), vec!["line 1 has 37 values"]),
        ("0.1 -0.2\n".to_owned(), vec!["line 1", "rotation is -0.2"]),
        ("0.1 0.2\nnan 0.2\n".to_owned(), vec!["line 2", "translation is NaN"]),
        (whole.replacen('1', "-1", 1), vec!["line 1", "variance 0", "-1"]),
        (whole.replacen("1 0", "1 0.5", 1), vec!["line 1", "not symmetric", "0.5"]),
        (whole.replacen('6', "inf", 1), vec!["line 1", "row 5, column 5", "inf"]),
    ];
    for (text, words) in cases {
        for word in words {
            assert!(told(&text).contains(word), "{text}: '{word}' not in: {}", told(&text));
        }
    }
    assert_eq!(pose_noise::read(b"0.1 \xff\n"), Err(PoseNoiseTextError::NotText { line: 1 }));
}

proptest! {
    #[test]
    fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let _ = pose_noise::read(&bytes);
    }

    #[test]
    fn any_numbers_are_read_or_refused(
        rows in prop::collection::vec(prop::collection::vec(any::<f64>(), 0..40), 0..4),
    ) {
        let line = |row: &Vec<f64>| row.iter().map(f64::to_string).collect::<Vec<_>>().join(" ");
        let _ = pose_noise::read(rows.iter().map(line).collect::<Vec<_>>().join("\n").as_bytes());
    }
}

/// Scans with the numbers 1, 3 and 5, and a file of `rows` rows of 1 m, 2 m and so on.
struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        for number in [1, 3, 5] {
            write(&folder.path(&format!("scan{number}.xyz")), "0 0 0\n1 1 1\n");
        }
        folder
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn poses(&self, count: usize) -> PathBuf {
        let path = self.path("poses.txt");
        let line = |i| format!("1 0 0 {i} 0 1 0 0 0 0 1 0\n");
        write(&path, (0..count).map(line).collect::<String>());
        path
    }

    fn rows(&self, count: usize) -> PathBuf {
        let path = self.path("pose_noise.txt");
        write(&path, (1..=count).map(|i| format!("{i} 0\n")).collect::<String>());
        path
    }

    fn find(&self, poses: Option<&Path>, rows: usize) -> Result<Vec<Source>, SourceError> {
        find_uncertain_sources(&[self.path("scan*.xyz")], poses, &self.rows(rows))
    }
}

/// The standard deviations of the translations, which are the numbers of the rows.
fn numbers(sources: &[Source]) -> Vec<f64> {
    sources.iter().map(|s| s.pose_noise.unwrap().covariance()[0][0].sqrt()).collect()
}

#[test]
fn as_many_rows_as_scans_are_in_order() {
    let folder = Folder::new();
    assert_eq!(numbers(&folder.find(None, 3).unwrap()), [1.0, 2.0, 3.0]);
    assert_eq!(numbers(&folder.find(Some(&folder.poses(3)), 3).unwrap()), [1.0, 2.0, 3.0]);
    // Poses by the number of the scan, rows in the order of the scans.
    assert_eq!(numbers(&folder.find(Some(&folder.poses(7)), 3).unwrap()), [1.0, 2.0, 3.0]);
}

#[test]
fn as_many_rows_as_poses_belong_to_these() {
    let folder = Folder::new();
    let sources = folder.find(Some(&folder.poses(7)), 7).unwrap();
    assert_eq!(numbers(&sources), [2.0, 4.0, 6.0]);
    let places: Vec<_> = sources.iter().map(|s| s.pose.unwrap().translation()[0]).collect();
    assert_eq!(places, [1.0, 3.0, 5.0]);
}

#[test]
fn other_numbers_of_rows_are_told() {
    let folder = Folder::new();
    let told = folder.find(Some(&folder.poses(7)), 4).unwrap_err().to_string();
    for word in ["pose_noise.txt", "4 rows", "3 scans", "7 poses"] {
        assert!(told.contains(word), "{told}");
    }
    let told = folder.find(None, 2).unwrap_err().to_string();
    assert!(told.contains("2 rows for 3 scans: ") && !told.contains("poses"), "{told}");
}

#[test]
fn damaged_and_missing_files_are_named() {
    let folder = Folder::new();
    let scans = [folder.path("scan*.xyz")];
    write(&folder.path("bad.txt"), "0.1 -2\n");
    let told = find_uncertain_sources(&scans, None, &folder.path("bad.txt")).unwrap_err().to_string();
    assert!(told.contains("bad.txt: line 1: rotation is -2"), "{told}");
    let told = find_uncertain_sources(&scans, None, &folder.path("none.txt")).unwrap_err().to_string();
    assert!(told.contains("none.txt"), "{told}");
    assert!(find_sources(&scans, None).unwrap().iter().all(|s| s.pose_noise.is_none()));
}
