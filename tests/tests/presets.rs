//! `--preset`: which options go with which, and what `planes.json` tells of the way planes were found.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

use std::path::Path;

use serde_json::{Value, json};
use tempfile::TempDir;
use terrace_tests::{Run, labels, terrace};

struct Table(TempDir);

impl Table {
    fn new() -> Self {
        let table = Self(tempfile::tempdir().unwrap());
        let synth = ["synth", "table", "--points", "12000", "--seed", "5", "--out", &table.path("truth")];
        let _ = terrace(synth).ended_with(0);
        table
    }

    fn path(&self, name: &str) -> String {
        self.0.path().join(name).to_str().unwrap().to_owned()
    }

    fn run(&self, arguments: &[&str]) -> Run {
        let (cloud, out) = (self.path("truth/points.ply"), self.path("out"));
        terrace(["extract", &cloud, "--out", &out].iter().chain(arguments))
    }

    fn json(&self, arguments: &[&str]) -> Value {
        let _ = self.run(arguments).ended_with(0);
        serde_json::from_slice(&std::fs::read(Path::new(&self.path("out")).join("planes.json")).unwrap())
            .unwrap()
    }

    /// Refused with these words, and nothing is written.
    fn refuses(&self, arguments: &[&str], words: &[&str]) {
        let run = self.run(arguments).ended_with(2);
        for word in words {
            assert!(run.stderr.contains(word), "{arguments:?} without '{word}': {}", run.stderr);
        }
        assert!(!Path::new(&self.path("out")).exists(), "{arguments:?} wrote");
    }
}

#[test]
fn options_about_clusters_are_refused_where_regions_are_grown() {
    let table = Table::new();
    let about_clusters: [&[&str]; 8] = [
        &["--phi", "0.2"],
        &["--omega", "0.3"],
        &["--depth", "2"],
        &["--cost", "sum"],
        &["--search", "random"],
        &["--evaluations", "100"],
        &["--no-optimise"],
        &["--min-cells", "3"],
    ];
    for option in about_clusters {
        table.refuses(option, &[option[0], "--preset clusters"]);
        table.refuses(&[option, &["--preset", "default"]].concat(), &[option[0], "--preset clusters"]);
    }
    for option in about_clusters {
        let _ = table.run(&[option, &["--preset", "clusters", "--no-points"]].concat()).ended_with(0);
    }
}

#[test]
fn options_about_regions_are_refused_where_cells_are_clustered() {
    let table = Table::new();
    let about_regions: [[&str; 2]; 5] = [
        ["--join", "touching"],
        ["--min-points", "100"],
        ["--min-area", "0.1"],
        ["--max-tilt", "0.02"],
        ["--reach", "3"],
    ];
    for preset in ["clusters", "paper"] {
        for [option, value] in about_regions {
            let told = format!("--preset {preset}");
            table.refuses(&[option, value, "--preset", preset], &[option, "about regions", &told]);
        }
    }
    let _ = table.run(&about_regions.concat()).ended_with(0);
}

#[test]
fn planes_json_tells_what_regions_were_grown_with() {
    let table = Table::new();
    let file = table.json(&["--no-points"]);
    let parameters = &file["parameters"];
    let regions = &parameters["regions"];
    assert_eq!((&parameters["preset"], &regions["join"]), (&json!("default"), &json!("touching")));
    for name in ["tilt", "reach", "turn", "min_points", "min_area", "noise_scale"] {
        assert!(regions[name].as_f64().unwrap() > 0.0, "{name}: {regions}");
    }
    assert_eq!(regions["noise_scale"], json!(1.0), "the errors stated are those that were drawn");
    assert!(file["timings_seconds"]["grow"].as_f64().unwrap() > 0.0);
    for plane in file["planes"].as_array().unwrap() {
        assert!(plane.get("phi").is_none() && plane.get("phi_interval").is_none(), "{plane}");
        assert!(plane["normal_uncertainty"].is_array() && plane["covariance"].is_array(), "{plane}");
    }

    let given = [
        "--join",
        "coplanar",
        "--min-points",
        "500",
        "--min-area",
        "0.25",
        "--max-tilt",
        "0.02",
        "--reach",
        "2.5",
    ];
    let regions = table.json(&given)["parameters"]["regions"].clone();
    assert_eq!(regions["join"], json!("coplanar"));
    let told = ["min_points", "min_area", "tilt", "reach"].map(|name| regions[name].as_f64().unwrap());
    for (told, given) in told.into_iter().zip([500.0, 0.25, 0.02, 2.5]) {
        assert!((told - given).abs() < 1e-12, "{regions}");
    }

    for preset in ["clusters", "paper"] {
        let file = table.json(&["--preset", preset, "--no-points"]);
        let parameters = &file["parameters"];
        assert_eq!((&parameters["preset"], &parameters["regions"]), (&json!(preset), &Value::Null));
        assert!(file["timings_seconds"].get("grow").is_none());
        assert!(parameters["cells_clustered"].as_u64().unwrap() > 0);
        assert!(file["planes"].as_array().unwrap().iter().all(|plane| plane["phi"].is_f64()));
    }
}

/// A floor of two parts with a metre between, as text.
fn parted_floor() -> String {
    let lines = (0..20_000_u32).map(|k| {
        let (part, u, v) = (k % 2, k / 2 % 100, k / 200);
        // Rough by a few millimetres, the same pattern nowhere.
        let z = f64::from(k.wrapping_mul(2_654_435_761) >> 16) / 65_536.0 * 0.01;
        format!("{} {} {z}\n", f64::from(part) * 3.0 + f64::from(u) * 0.02, f64::from(v) * 0.02)
    });
    lines.collect()
}

#[test]
fn coplanar_planes_are_one_when_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let [cloud, out] = ["floor.xyz", "out"].map(|name| folder.path().join(name).to_str().unwrap().to_owned());
    std::fs::write(&cloud, parted_floor()).unwrap();
    let largest = |which: &str| {
        let _ =
            terrace(["extract", &cloud, "--out", &out, "--sigma", "0.003", "--join", which]).ended_with(0);
        let labels = labels(Path::new(&out));
        assert_eq!(labels.len(), 20_000);
        assert!(labels.iter().filter(|label| **label == 0).count() < 200);
        labels.into_iter().max().unwrap()
    };
    assert_eq!((largest("touching"), largest("coplanar")), (2, 1));
}
