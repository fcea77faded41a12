//! `info`, `synth` and the help texts tell what is there.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

use std::path::Path;

use terrace_io::{ReadOptions, inspect};
use terrace_tests::{labels, planes, terrace};

#[test]
fn info_tells_format_and_points() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("table").to_str().unwrap().to_owned();
    let _ = terrace(["synth", "table", "--points", "4321", "--out", &out]).ended_with(0);
    let run = terrace(["info", &format!("{out}/points.ply")]).ended_with(0);
    let value = |name: &str| {
        let mut fields = run.stdout.lines().filter_map(|line| line.trim().split_once(' '));
        fields.find(|(field, _)| *field == name).map(|(_, value)| value.trim().to_owned()).unwrap()
    };
    assert_eq!(value("points"), "4321");
    assert_eq!(value("format"), "PLY binary_little_endian");
    assert!(value("absent").starts_with("0 "));
    assert!(value("sigma").starts_with("0.01000 to 0.01000"), "{}", run.stdout);
}

#[test]
fn info_goes_on_after_a_bad_file() {
    let folder = tempfile::tempdir().unwrap();
    let [bad, good] =
        ["bad.xyz", "good.xyz"].map(|name| folder.path().join(name).to_str().unwrap().to_owned());
    std::fs::write(&bad, "").unwrap();
    std::fs::write(&good, "0 0 0\n1 0 0\nnan nan nan\n").unwrap();
    let run = terrace(["info", &bad, &good]).ended_with(1);
    assert!(run.stderr.contains("bad.xyz"), "{}", run.stderr);
    assert!(run.stdout.contains("good.xyz") && run.stdout.contains("points     3"), "{}", run.stdout);
    assert!(run.stdout.contains("absent     1"), "{}", run.stdout);
}

#[test]
fn help_names_every_option() {
    let read = ["--sigma", "--sensor", "--sigma-field", "--intrinsics", "--depth-scale"];
    let extract = [
        "--out",
        "--preset",
        "--cell",
        "--tau",
        "--join",
        "--min-points",
        "--min-area",
        "--max-tilt",
        "--reach",
        "--phi",
        "--omega",
        "--depth",
        "--cost",
        "--search",
        "--evaluations",
        "--no-optimise",
        "--min-cells",
        "--seed",
        "--poses",
        "--pose-sigma",
        "--pose-covariances",
        "--picture",
        "--up",
        "--no-points",
        "--save-map",
        "--threads",
        "--quiet",
    ];
    let tune = [
        "--out",
        "--preset",
        "--cell",
        "--depth",
        "--tau",
        "--omega",
        "--phi",
        "--min-cells",
        "--labels",
        "--quality",
        "--weight-clusters",
        "--evaluations",
        "--seed",
        "--poses",
        "--threads",
        "--quiet",
    ];
    let merge =
        ["--out", "--tau", "--join", "--phi", "--seed", "--floor", "--save-map", "--threads", "--quiet"];
    let commands: [(&str, Vec<&str>); 8] = [
        ("extract", [&extract[..], &read].concat()),
        ("merge", merge.to_vec()),
        ("tune", [&tune[..], &read].concat()),
        ("info", read.to_vec()),
        (
            "synth",
            vec![
                "--out", "--points", "--sigma", "--seed", "--quiet", "table", "desk", "strip", "patch",
                "room", "building", "corridor",
            ],
        ),
        ("eval", vec!["--field", "--pred-planes", "--truth-planes", "--per-plane", "--json", "--quiet"]),
        (
            "calibrate",
            vec![
                "--scene",
                "--labels",
                "--copies",
                "--unstated",
                "--pose-sigma",
                "--views",
                "--clusters",
                "--phi",
                "--depth",
                "--min-cells",
                "--floor",
                "--out",
            ],
        ),
        ("reproduce", vec!["--out", "--data", "--seed", "--seeds", "--intrinsics", "--quiet"]),
    ];
    let overview = terrace(["--help"]).ended_with(0).stdout;
    for (command, options) in commands {
        assert!(overview.contains(command), "{overview}");
        let help = terrace([command, "--help"]).ended_with(0).stdout;
        let words: Vec<_> = help.split(|c: char| !(c.is_ascii_alphanumeric() || c == '-')).collect();
        for option in options {
            assert!(words.contains(&option), "{command} --help without {option}:\n{help}");
        }
    }
    assert!(terrace(["--version"]).ended_with(0).stdout.starts_with("terrace "));
    let _ = terrace(["frobnicate"]).ended_with(2);
}

#[test]
fn synthetic_counts_agree() {
    let folder = tempfile::tempdir().unwrap();
    for scene in ["table", "desk", "strip", "patch", "room", "building", "corridor"] {
        let out = folder.path().join(scene);
        let text = out.to_str().unwrap();
        let run = terrace(["synth", scene, "--points", "9000", "--out", text]).ended_with(0);
        let file = planes(&out);
        let summary = file.summary.unwrap();
        assert!(run.stdout.contains(&format!("{} points of {} planes", summary.points, summary.planes)));
        assert_eq!(summary.points, 9000, "{scene}");
        let labels = labels(&out);
        assert_eq!(labels.len() as u64, summary.points);
        assert_eq!(points(&out), summary.points);
        assert_eq!(labels.iter().filter(|&&x| x > 0).count() as u64, summary.labelled);
        assert_eq!(file.planes.len() as u64, summary.planes);
        for plane in &file.planes {
            let count = labels.iter().filter(|&&x| i64::from(x) == i64::from(plane.id)).count();
            assert_eq!(count as u64, plane.points, "{scene}, {:?}", plane.name);
        }
    }
}

fn points(folder: &Path) -> u64 {
    inspect(&folder.join("points.ply"), &ReadOptions::default()).unwrap().points as u64
}
