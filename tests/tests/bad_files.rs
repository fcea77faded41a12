//! Files that cannot be read are named and left out; wrong arguments are told by name and value.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

use std::path::Path;

use tempfile::TempDir;
use terrace_tests::{labels, planes, terrace};

const BAD: [&str; 3] = ["empty.ply", "truncated.ply", "nonsense.txt"];

struct Files {
    folder: TempDir,
}

impl Files {
    /// A good cloud of 5000 points, and three files that are none.
    fn new() -> Self {
        let files = Self { folder: tempfile::tempdir().unwrap() };
        let _ = terrace(["synth", "table", "--points", "5000", "--out", &files.path("good")]).ended_with(0);
        let good = std::fs::read(files.path("good/points.ply")).unwrap();
        std::fs::write(files.path("empty.ply"), b"").unwrap();
        std::fs::write(files.path("truncated.ply"), &good[..good.len() / 2]).unwrap();
        std::fs::write(files.path("nonsense.txt"), "all work and no play\nmakes\n\u{1f600}\n").unwrap();
        files
    }

    fn path(&self, name: &str) -> String {
        self.folder.path().join(name).to_str().unwrap().to_owned()
    }
}

#[test]
fn good_file_among_bad_ones_is_used() {
    let files = Files::new();
    let out = files.path("out");
    let [empty, truncated, nonsense] = BAD.map(|name| files.path(name));
    let run =
        terrace(["extract", &empty, &files.path("good/points.ply"), &truncated, &nonsense, "--out", &out])
            .ended_with(0);
    for name in BAD {
        let told = run.stderr.lines().any(|line| line.starts_with("warning:") && line.contains(name));
        assert!(told, "{name}: {}", run.stderr);
    }
    assert!(!run.stderr.contains("good/points.ply"), "{}", run.stderr);

    let file = planes(Path::new(&out));
    let skipped = file.parameters["inputs_skipped"].as_array().unwrap();
    let skipped: Vec<_> = skipped
        .iter()
        .map(|s| {
            assert!(!s["reason"].as_str().unwrap().is_empty());
            Path::new(s["input"].as_str().unwrap()).file_name().unwrap().to_str().unwrap()
        })
        .collect();
    assert_eq!(skipped, BAD);
    assert_eq!(file.parameters["inputs"], 1);
    assert!(file.planes.len() >= 3);
    assert_eq!(labels(Path::new(&out)).len(), 5000);
}

#[test]
fn bad_files_alone_leave_nothing_written() {
    let files = Files::new();
    let [empty, truncated, nonsense] = BAD.map(|name| files.path(name));
    let out = files.path("out");
    let run = terrace(["extract", &empty, &truncated, &nonsense, "--out", &out]).ended_with(1);
    assert!(run.stderr.contains("none of 3 inputs"), "{}", run.stderr);
    assert!(!Path::new(&out).exists());
}

#[test]
fn missing_file_is_named() {
    let files = Files::new();
    let out = files.path("out");
    for inputs in
        [vec![files.path("nowhere.ply")], vec![files.path("good/points.ply"), files.path("nowhere.ply")]]
    {
        let run =
            terrace(["extract".into(), "--out".into(), out.clone()].into_iter().chain(inputs)).ended_with(1);
        assert!(run.stderr.contains("nowhere.ply"), "{}", run.stderr);
        assert!(!Path::new(&out).exists());
    }
}

#[test]
fn file_without_a_cell_size_is_named() {
    let files = Files::new();
    let lone = files.path("lone.xyz");
    std::fs::write(&lone, "1 2 3\n").unwrap();
    let run = terrace(["extract", &lone, "--out", &files.path("out")]).ended_with(1);
    assert!(run.stderr.contains("lone.xyz"), "{}", run.stderr);
}

#[test]
fn wrong_arguments_end_with_2_and_are_named() {
    let files = Files::new();
    let (good, out) = (files.path("good/points.ply"), files.path("out"));
    let cases: [(&[&str], &[&str]); 18] = [
        (&["--wobble"], &["--wobble"]),
        (&["--preset", "clusters", "--phi", "2"], &["phi", "2"]),
        (&["--preset", "clusters", "--phi", "-0.5"], &["phi", "-0.5"]),
        (&["--max-tilt", "-0.5"], &["tilt", "-0.5"]),
        (&["--reach", "0"], &["reach", "0"]),
        (&["--min-area", "-1"], &["min_area", "-1"]),
        (&["--join", "loosely"], &["--join", "loosely"]),
        (&["--cell", "0"], &["cell", "0"]),
        (&["--cell", "-1"], &["cell", "-1"]),
        (&["--cell", "nan"], &["cell", "NaN"]),
        (&["--cell", "wide"], &["--cell", "wide"]),
        (&["--preset", "clusters", "--omega", "-1"], &["omega", "-1"]),
        (&["--tau", "0"], &["tau", "0"]),
        (&["--preset", "paper", "--depth", "0"], &["depth", "0"]),
        (&["--sigma", "-1"], &["sigma", "-1", "metres"]),
        (&["--threads", "0"], &["--threads", "0"]),
        (&["--depth-scale", "-1"], &["--depth-scale", "-1", "above 0"]),
        (&["--up", "0,0,0"], &["--up", "0,0,0"]),
    ];
    for (arguments, told) in cases {
        let base = ["extract", &good, "--out", &out];
        let run = terrace(base.iter().chain(arguments)).ended_with(2);
        for word in told {
            assert!(run.stderr.contains(word), "{arguments:?} without '{word}': {}", run.stderr);
        }
        assert!(
            !run.stderr.contains("unexpected argument") || arguments == ["--wobble"],
            "{arguments:?}: {}",
            run.stderr
        );
        assert!(!Path::new(&out).exists(), "{arguments:?} wrote");
    }
}

#[test]
fn wrong_arguments_of_synth_end_with_2_and_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out").to_str().unwrap().to_owned();
    for (option, value, told) in
        [("--points", "0", "0 points"), ("--sigma", "-1", "standard error -1"), ("--sigma", "nan", "NaN")]
    {
        let run = terrace(["synth", "table", "--out", &out, option, value]).ended_with(2);
        assert!(run.stderr.contains(told), "{option} {value}: {}", run.stderr);
        assert!(!Path::new(&out).exists());
    }
}
