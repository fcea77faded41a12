//! `terrace eval` on files: formats, folders, planes, tables, JSON, exit codes, and the numbers of another program.
#![allow(clippy::unwrap_used, clippy::indexing_slicing, clippy::float_cmp, reason = "tests")]

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;
use tempfile::TempDir;

struct Run {
    code: Option<i32>,
    stdout: String,
    stderr: String,
}

struct Files(TempDir);

impl Files {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, bytes).unwrap();
        path
    }

    fn npy(&self, name: &str, labels: &[i32]) -> PathBuf {
        self.write(name, npy(labels, "<i4", |label| label.to_le_bytes().to_vec()))
    }

    /// Runs `eval` in the folder of the files.
    fn eval(&self, arguments: &[&str]) -> Run {
        let output = Command::new(env!("CARGO_BIN_EXE_terrace"))
            .arg("eval")
            .args(arguments)
            .current_dir(self.0.path())
            .output()
            .unwrap();
        let text = |bytes| String::from_utf8(bytes).unwrap();
        Run { code: output.status.code(), stdout: text(output.stdout), stderr: text(output.stderr) }
    }

    fn json(&self, arguments: &[&str]) -> Value {
        let run = self.eval(&[arguments, &["--json", "-"]].concat());
        assert_eq!(run.code, Some(0), "{}", run.stderr);
        serde_json::from_str(&run.stdout).unwrap()
    }
}

fn npy(labels: &[i32], descr: &str, bytes: impl Fn(i32) -> Vec<u8>) -> Vec<u8> {
    let mut header = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': ({},)}}", labels.len());
    header += &" ".repeat(118 - header.len() % 64);
    let mut file = b"\x93NUMPY\x01\x00".to_vec();
    file.extend(u16::try_from(header.len()).unwrap().to_le_bytes());
    file.extend(header.bytes());
    file.extend(labels.iter().flat_map(|label| bytes(*label)));
    file
}

const TRUTH: [i32; 8] = [1, 1, 1, 1, 2, 2, 0, -1];
const FOUND: [i32; 8] = [7, 7, 7, 0, 3, 3, 3, 3];

#[track_caller]
fn assert_measures(pair: &Value) {
    let measures = &pair["measures"];
    assert_eq!(pair["points"], 7);
    assert_eq!((&measures["matched_50"], &measures["matched_80"]), (&2.into(), &0.into()));
    assert_eq!(measures["mean_iou"].as_f64(), Some(f64::midpoint(0.75, 2.0 / 3.0)));
    assert_eq!(measures["non_planar_claimed"].as_f64(), Some(1.0));
    assert_eq!(measures["point_accuracy"].as_f64(), Some(5.0 / 6.0));
}

/// The shown decimals of the goldens of `terrace-eval`; their test tells where they are from.
#[test]
fn the_program_shows_what_the_script_shows() {
    let files = Files::new();
    let (mut goldens, mut labels) = (Vec::<Vec<(&str, f64)>>::new(), Vec::<[Vec<i32>; 2]>::new());
    for line in include_str!("../../eval/tests/data/goldens.txt").lines() {
        match line.split_once(' ') {
            Some(("pair", _)) => {
                goldens.push(Vec::new());
                labels.push([Vec::new(), Vec::new()]);
            }
            Some(("golden", golden)) => {
                let (name, value) = golden.split_once(' ').unwrap();
                goldens.last_mut().unwrap().push((name, value.parse().unwrap()));
            }
            Some(("counts", groups)) => {
                for group in groups.split(',') {
                    let group: Vec<i32> = group.split_whitespace().map(|x| x.parse().unwrap()).collect();
                    for (labels, label) in labels.last_mut().unwrap().iter_mut().zip(&group) {
                        labels.extend(std::iter::repeat_n(*label, usize::try_from(group[2]).unwrap()));
                    }
                }
            }
            _ => {}
        }
    }
    let mut arguments = Vec::new();
    for (number, [truth, found]) in labels.iter().enumerate() {
        arguments.extend([format!("{number}/found.npy"), format!("{number}/truth.npy")]);
        let wide = npy(truth, "<i8", |label| i64::from(label).to_le_bytes().to_vec());
        let _ = files.write(&arguments[2 * number + 1], wide);
        let narrow = npy(found, ">i2", |label| i16::try_from(label).unwrap().to_be_bytes().to_vec());
        let _ = files.write(&arguments[2 * number], narrow);
    }
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let json = files.json(&arguments);
    let same = [
        ("precision@0.5", "precision_50"),
        ("recall@0.8", "recall_80"),
        ("f1@0.5", "f1_50"),
        ("f1@0.8", "f1_80"),
        ("wcov", "weighted_cover"),
        ("cov", "cover"),
        ("miou_matched", "mean_iou"),
        ("miou_all", "mean_iou_all"),
        ("dice_matched", "mean_dice"),
        ("point_accuracy", "point_accuracy"),
        ("nonplanar_claimed", "non_planar_claimed"),
        ("correct", "correct"),
        ("over", "over"),
        ("under", "under"),
        ("missed", "missed"),
        ("noise", "noise"),
    ];
    assert_eq!(json["pairs"].as_array().unwrap().len(), 11);
    for (pair, goldens) in json["pairs"].as_array().unwrap().iter().zip(goldens) {
        for (golden, name) in same {
            let (_, expected) = goldens.iter().find(|(name, _)| *name == golden).unwrap();
            // The script shows 0 where there is no value.
            let value = pair["measures"][name].as_f64().unwrap_or(0.0);
            assert_eq!(format!("{value:.4}"), format!("{expected:.4}"), "{}: {name}", pair["pred"]);
        }
    }
}

#[test]
fn labels_are_read_from_npy_ply_pcd_and_folders() {
    let files = Files::new();
    let (_, _) = (files.npy("truth.npy", &TRUTH), files.npy("result/labels.npy", &FOUND));
    let lines = |labels: &[i32]| labels.iter().map(|label| format!("1 2 3 {label}\n")).collect::<String>();
    let ply = "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n\
               property int label\nend_header\n";
    let pcd = "VERSION .7\nFIELDS x y z label\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\nWIDTH 8\nHEIGHT 1\n\
               POINTS 8\nDATA ascii\n";
    let _ = files.write("truth.ply", ply.to_owned() + &lines(&TRUTH));
    let _ = files.write("found.pcd", pcd.replace("label", "plane") + &lines(&FOUND));
    let _ = files.write("truth.pcd", pcd.replace("label", "plane") + &lines(&TRUTH));
    for arguments in [&["result", "truth.npy"][..], &["result", "truth.ply"]] {
        assert_measures(&files.json(arguments)["pairs"][0]);
    }
    assert_measures(&files.json(&["found.pcd", "truth.pcd", "--field", "plane"])["pairs"][0]);
    let run = files.eval(&["found.pcd", "truth.pcd"]);
    assert_eq!(run.code, Some(1));
    assert!(run.stderr.contains("found.pcd") && run.stderr.contains("label"), "{}", run.stderr);
}

#[test]
fn angles_come_from_planes_beside_the_labels_or_given() {
    let files = Files::new();
    let _ = (files.npy("a/labels.npy", &FOUND), files.npy("truth.npy", &TRUTH));
    // Turned by 0.01 about the x axis, and 2 mm up.
    let (sin, cos) = 0.01_f64.sin_cos();
    let found = format!(
        r#"{{"format": "terrace-planes", "version": 1, "planes": [
        {{"id": 7, "coefficients": [0, {sin}, {cos}, {}], "centroid": [5, 0, 1.002], "points": 3}}]}}"#,
        -1.002 * cos
    );
    let _ = files.write("a/planes.json", found);
    let truth = files.write("t.json", r#"{"1": {"name": "floor", "normal": [0, 0, -2], "offset": -2}}"#);
    let json = files.json(&["a", "truth.npy", "--truth-planes", truth.to_str().unwrap()]);
    let (pair, plane) = (&json["pairs"][0], &json["pairs"][0]["planes"][0]);
    assert_eq!((&plane["name"], &plane["found"]), (&"floor".into(), &7.into()));
    assert!((plane["angle_degrees"].as_f64().unwrap() - 0.01_f64.to_degrees()).abs() < 1e-9);
    assert!((plane["offset"].as_f64().unwrap() - 0.002).abs() < 1e-9);
    assert_eq!(plane["angle_degrees"], pair["measures"]["angle_degrees_max"]);
    assert_eq!(pair["planes"][1]["angle_degrees"], Value::Null);

    let run = files.eval(&["a", "truth.npy", "--truth-planes", "t.json", "--per-plane"]);
    assert!(run.stdout.contains("floor") && run.stdout.contains("2.00"), "{}", run.stdout);
    // What is beside may be of something else, what is given may not.
    let _ = files.write("a/planes.json", "[1, 2]");
    let run = files.eval(&["a", "truth.npy"]);
    assert_eq!(run.code, Some(0));
    assert!(run.stderr.contains("no angles"), "{}", run.stderr);
    let run = files.eval(&["a", "truth.npy", "--pred-planes", "a/planes.json"]);
    assert_eq!(run.code, Some(1));
}

#[test]
fn several_pairs_have_a_mean_and_failures_are_told() {
    let files = Files::new();
    let _ = (files.npy("f.npy", &FOUND), files.npy("t.npy", &TRUTH), files.npy("short.npy", &[1]));
    let json = files.json(&["f.npy", "t.npy", "t.npy", "t.npy"]);
    assert_eq!(json["mean"]["f1_80"].as_f64(), Some(0.5));
    assert_eq!(json["pairs"][1]["measures"]["weighted_cover"].as_f64(), Some(1.0));
    // No planes are known, of no pair.
    assert_eq!(json["mean"]["angle_degrees_median"], Value::Null);
    assert!(files.eval(&["f.npy", "t.npy", "t.npy", "t.npy"]).stdout.contains("\nmean "));
    assert!(!files.eval(&["f.npy", "t.npy"]).stdout.contains("\nmean "));

    let run = files.eval(&["short.npy", "t.npy", "f.npy", "t.npy", "--json", "out/scores.json", "--quiet"]);
    assert_eq!((run.code, run.stdout.as_str()), (Some(1), ""));
    assert!(run.stderr.contains("8 true labels and 1 found ones"), "{}", run.stderr);
    let scores = std::fs::read(files.0.path().join("out/scores.json")).unwrap();
    let scores: Value = serde_json::from_slice(&scores).unwrap();
    assert_eq!(scores["pairs"].as_array().unwrap().len(), 1);
    assert_eq!(scores["parameters"]["pairs_skipped"][0]["pred"], "short.npy");
}

#[test]
fn wrong_arguments_and_inputs_have_their_exit_codes() {
    let files = Files::new();
    let _ = (files.npy("f.npy", &FOUND), files.npy("t.npy", &TRUTH), files.write("x.txt", "1 2 3\n"));
    for wrong in [
        &["f.npy"][..],
        &["f.npy", "t.npy", "f.npy"],
        &["f.npy", "t.npy", "--pred-planes", "a", "--pred-planes", "b"],
        &["f.npy", "t.npy", "--frobnicate"],
    ] {
        let run = files.eval(wrong);
        assert_eq!((run.code, run.stdout.as_str()), (Some(2), ""), "{wrong:?}: {}", run.stderr);
    }
    for (unusable, said) in [("none.npy", "none.npy"), ("x.txt", "NPY, PLY and PCD"), (".", "labels.npy")] {
        let run = files.eval(&[unusable, "t.npy"]);
        assert_eq!((run.code, run.stdout.as_str()), (Some(1), ""), "{unusable}");
        assert!(run.stderr.contains(said) && !run.stderr.contains("panicked"), "{}", run.stderr);
    }
    let nothing = Path::new("empty.npy");
    let _ = files.npy(nothing.to_str().unwrap(), &[]);
    let json = files.json(&["empty.npy", "empty.npy"]);
    assert_eq!(json["pairs"][0]["measures"]["f1_50"], Value::Null);
    assert_eq!(json["pairs"][0]["measures"]["true_planes"], 0);
}
