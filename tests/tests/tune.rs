//! `tune`: the settings it finds are no worse than those in use, and what it writes and prints can be used.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

use std::path::Path;

use serde_json::Value;
use tempfile::TempDir;
use terrace_tests::{Run, labels, planes, terrace};

/// A synthetic table with its true labels, and a folder for results.
struct Table {
    folder: TempDir,
}

impl Table {
    fn new() -> Self {
        let table = Self { folder: tempfile::tempdir().unwrap() };
        let synth = ["synth", "table", "--points", "6000", "--seed", "5", "--out", &table.path("table")];
        let _ = terrace(synth).ended_with(0);
        table
    }

    fn path(&self, name: &str) -> String {
        self.folder.path().join(name).to_str().unwrap().to_owned()
    }

    /// Tunes the table into this folder.
    fn tune(&self, out: &str, more: &[&str]) -> Run {
        let (points, out) = (self.path("table/points.ply"), self.path(out));
        terrace([&["tune", &points, "--out", &out, "--evaluations", "40"], more].concat())
    }

    fn truth(&self) -> String {
        self.path("table/labels.npy")
    }

    fn tune_json(&self, out: &str) -> Value {
        let bytes = std::fs::read(Path::new(&self.path(out)).join("tune.json")).unwrap();
        serde_json::from_slice(&bytes).unwrap()
    }
}

fn cost(settings: &Value) -> f64 {
    settings["cost"].as_f64().unwrap()
}

#[test]
fn tuned_settings_are_no_worse_than_those_in_use() {
    let table = Table::new();
    let truth = table.truth();
    let by = [&[][..], &["--labels", &truth], &["--labels", &truth, "--quality", "f1"]];
    for (number, more) in by.into_iter().enumerate() {
        let out = format!("out{number}");
        let run = table.tune(&out, more).ended_with(0);
        let file = table.tune_json(&out);
        assert_eq!((&file["format"], &file["version"]), (&Value::from("terrace-tune"), &Value::from(1)));
        let (before, best) = (cost(&file["before"]), cost(&file["best"]));
        assert!(best <= before, "{best} after {before}");
        let trials = file["trials"].as_array().unwrap();
        assert!(trials.iter().all(|trial| cost(trial) >= best));
        assert_eq!(file["evaluations"], 40);
        let certified = file["certified"].as_f64().unwrap();
        assert!(certified > 0.0 && certified < 1.0);
        assert!(run.stdout.contains(&format!("{best:.6}")), "{}", run.stdout);
        assert!(run.stderr.is_empty(), "no bar in a pipe: {}", run.stderr);
        for axis in ["cell_size", "depth", "tau", "omega", "phi"] {
            assert!(!file["slices"][axis].as_array().unwrap().is_empty(), "{axis}");
        }
        let picture = std::fs::read(Path::new(&table.path(&out)).join("landscape.png")).unwrap();
        assert_eq!(&picture[1..4], b"PNG");
    }
}

#[test]
fn the_printed_command_gives_the_result_that_was_judged() {
    let table = Table::new();
    let run = table.tune("out", &["--labels", &table.truth(), "--min-cells", "4"]).ended_with(0);
    let line = run.stdout.lines().find(|line| line.starts_with("terrace extract ")).unwrap();
    let _ = terrace(line.split(' ').skip(1)).ended_with(0);
    let folder = table.path("out/planes");
    let found = labels(Path::new(&folder));
    assert!(planes(Path::new(&folder)).planes.len() >= 3);

    let truth = labels(Path::new(&table.path("table")));
    let of = |plane: i32| truth.iter().filter(|&&label| label == plane).count() as f64;
    let true_planes: Vec<i32> = (1..=truth.iter().copied().max().unwrap()).collect();
    let size: f64 = true_planes.iter().map(|plane| of(*plane)).sum();
    let cover: f64 =
        true_planes.iter().map(|p| of(*p) * terrace_tests::best_overlap(&truth, &found, *p)).sum::<f64>()
            / size;
    let judged = 1.0 - cost(&table.tune_json("out")["best"]);
    assert!((cover - judged).abs() < 1e-6, "{cover} {judged}");
}

#[test]
fn runs_agree_to_the_byte_on_any_number_of_threads() {
    let table = Table::new();
    let runs = [("a", "1"), ("b", "1"), ("c", "2")].map(|(out, threads)| {
        let _ = table.tune(out, &["--threads", threads, "--preset", "paper", "--seed", "3"]).ended_with(0);
        ["tune.json", "landscape.png"]
            .map(|name| std::fs::read(Path::new(&table.path(out)).join(name)).unwrap())
    });
    assert!(runs[0] == runs[1] && runs[0] == runs[2]);
    let _ = table.tune("d", &["--preset", "paper", "--seed", "4"]).ended_with(0);
    assert!(table.tune_json("a")["trials"] != table.tune_json("d")["trials"], "the seed is used");
}

#[test]
fn fixed_settings_stay_fixed() {
    let table = Table::new();
    let fixed = ["--cell", "0.11", "--depth", "2", "--tau", "6", "--omega", "0.3", "--phi", "0.05..0.2"];
    let run = table.tune("out", &fixed).ended_with(0);
    assert!(run.stdout.contains(" --cell 0.11 --depth 2 --tau 6 --omega 0.3 --phi 0."), "{}", run.stdout);
    let file = table.tune_json("out");
    for trial in file["trials"].as_array().unwrap() {
        let [cell, omega, phi] = ["cell_size", "omega", "phi"].map(|name| trial[name].as_f64().unwrap());
        assert!((cell - 0.11).abs() < 1e-15 && (omega - 0.3).abs() < 1e-15);
        assert!((0.05..=0.2).contains(&phi));
        assert_eq!((&trial["depth"], &trial["tau"]), (&Value::from(2), &Value::from(6)));
    }
    assert_eq!(file["slices"].as_object().unwrap().keys().collect::<Vec<_>>(), ["phi"]);

    let all = [&fixed[..8], &["--phi", "0.1"]].concat();
    let run = table.tune("point", &all).ended_with(0);
    assert!(run.stdout.contains("1 evaluations; for 100 %"), "{}", run.stdout);
    assert!(!Path::new(&table.path("point/landscape.png")).exists(), "nothing to draw");
}

#[test]
fn wrong_arguments_are_told_by_option_and_value() {
    let table = Table::new();
    let short = table.path("short");
    let _ = terrace(["synth", "table", "--points", "500", "--out", &short]).ended_with(0);
    let (short, missing) = (format!("{short}/labels.npy"), table.path("missing.npy"));
    let cloud = table.path("table/points.ply");
    let wrong: [(&[&str], i32, &[&str]); 13] = [
        (&["--preset", "default"], 2, &["--preset clusters", "regions need no tuning"]),
        (&["--labels", &short], 2, &["--labels", "500", "6000"]),
        (&["--labels", &missing], 1, &["--labels", "missing.npy"]),
        (&["--labels", &cloud], 1, &["--labels", "points.ply"]),
        (&["--quality", "f1"], 2, &["--labels"]),
        (&["--cell", "0.1,-2"], 2, &["--cell", "-2"]),
        (&["--cell", "0.1,x"], 2, &["--cell", "x"]),
        (&["--tau", "0"], 2, &["--tau", "0"]),
        (&["--depth", "0..2"], 2, &["--depth", "0"]),
        (&["--omega", "0.5..0.1"], 2, &["--omega", "0.5", "0.1"]),
        (&["--phi", "0.5..1.5"], 2, &["--phi", "1.5"]),
        (&["--phi", "0.5-0.7"], 2, &["--phi", "0.5-0.7"]),
        (&["--weight-clusters", "-1"], 2, &["--weight-clusters", "-1"]),
    ];
    for (more, code, named) in wrong {
        let run = table.tune("wrong", more).ended_with(code);
        for name in named {
            assert!(run.stderr.contains(name), "{more:?}: {}", run.stderr);
        }
    }
    let out = table.path("wrong");
    let few = terrace(["tune", &cloud, "--out", &out, "--evaluations", "1"]).ended_with(2);
    assert!(few.stderr.contains("--evaluations") && few.stderr.contains('1'), "{}", few.stderr);
    assert!(!Path::new(&out).exists());
}

#[test]
fn a_bad_file_is_left_out_and_told() {
    let table = Table::new();
    let (bad, good, out) = (table.path("bad.ply"), table.path("table/points.ply"), table.path("out"));
    std::fs::write(&bad, "ply").unwrap();
    let run =
        terrace(["tune", &bad, &good, "--out", &out, "--evaluations", "4", "--phi", "0.1"]).ended_with(0);
    assert!(run.stderr.contains("bad.ply"), "{}", run.stderr);
    let skipped = &table.tune_json("out")["parameters"]["inputs_skipped"];
    assert!(skipped[0]["input"].as_str().unwrap().ends_with("bad.ply"), "{skipped}");
    let run = terrace(["tune", &bad, "--out", &out]).ended_with(1);
    assert!(run.stderr.contains("bad.ply"), "{}", run.stderr);
}
