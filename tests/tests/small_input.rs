//! Inputs of no, few, equal and absent points end in words, not in a panic.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

use std::path::Path;

use terrace_tests::{Run, labels, planes, terrace};

/// Runs `extract` on a text file of these lines. With exit code 0 there are as many labels as points and no planes.
fn extract(lines: &str, arguments: &[&str], code: i32) -> Run {
    let folder = tempfile::tempdir().unwrap();
    let [input, out] = ["small.xyz", "out"].map(|name| folder.path().join(name).to_str().unwrap().to_owned());
    std::fs::write(&input, lines).unwrap();
    let run = terrace(["extract", &input, "--out", &out].iter().chain(arguments)).ended_with(code);
    if code == 0 {
        assert_eq!(labels(Path::new(&out)), vec![0; lines.lines().count()]);
        assert!(planes(Path::new(&out)).planes.is_empty());
        assert!(Path::new(&out).join("points.ply").is_file());
    } else {
        assert!(!Path::new(&out).exists());
        assert!(run.stderr.contains("terrace: "), "{}", run.stderr);
    }
    run
}

const CELL: [&str; 2] = ["--cell", "0.1"];
const PICTURE: [&str; 3] = ["--cell", "0.1", "--picture"];

#[test]
fn no_points() {
    for lines in ["", "\n", "# only words\n"] {
        let _ = extract(lines, &[], 1);
        let _ = extract(lines, &CELL, 1);
    }
}

#[test]
fn few_points_need_a_cell_size() {
    for lines in ["1 2 3\n", "1 2 3\n4 5 6\n", "0 0 0\n1 0 0\n0 1 0\n"] {
        let run = extract(lines, &[], 1);
        assert!(run.stderr.contains("cell size"), "{}", run.stderr);
        for preset in ["default", "clusters", "paper"] {
            let _ = extract(lines, &["--preset", preset], 1);
            let _ = extract(lines, &["--preset", preset, "--cell", "0.1"], 0);
        }
        let _ = extract(lines, &PICTURE, 0);
    }
}

#[test]
fn equal_points_span_no_plane() {
    for count in [3, 6, 1000] {
        let lines = "1.5 -2.25 3\n".repeat(count);
        let _ = extract(&lines, &[], 1);
        let _ = extract(&lines, &CELL, 0);
        let _ = extract(&lines, &PICTURE, 0);
        let all = ["--cell", "0.1", "--tau", "1", "--sigma", "0.01"];
        let _ = extract(&lines, &[&all[..], &["--min-points", "1", "--min-area", "0"]].concat(), 0);
        let clusters = ["--preset", "clusters", "--min-cells", "1"];
        let _ = extract(&lines, &[&all[..], &clusters].concat(), 0);
    }
}

#[test]
fn absent_points_alone_are_nothing_usable() {
    let lines = "nan nan nan\n".repeat(20);
    let _ = extract(&lines, &[], 1);
    let _ = extract(&lines, &CELL, 1);
}

#[test]
fn points_on_one_line_span_no_plane() {
    let lines: String = (0..500).map(|i| format!("{} 0 0\n", f64::from(i) * 0.01)).collect();
    for preset in ["default", "clusters", "paper"] {
        let _ = extract(&lines, &["--cell", "0.1", "--preset", preset], 0);
    }
}
