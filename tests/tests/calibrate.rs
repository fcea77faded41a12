//! `calibrate`: what it prints and writes for each of its three ways, and what it refuses.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

use std::path::Path;

use serde_json::Value;
use tempfile::TempDir;
use terrace_io::write_labels_npy;
use terrace_synth::{Params, Scene};
use terrace_tests::{Run, real, terrace};
use terrace_types::PlaneId;

fn calibrate(arguments: &[&str], out: &Path) -> Run {
    terrace([&["calibrate", "--out", out.to_str().unwrap()], arguments].concat())
}

fn json(out: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(out.join("calibrate.json")).unwrap()).unwrap()
}

fn nees(calibration: &Value) -> f64 {
    calibration["nees"].as_f64().unwrap()
}

/// Views of a room as text of points in the world, exact, with their labels.
fn room(folder: &Path) -> Vec<String> {
    let params = Params { points: Some(120_000), sigma: Some(0.0), seed: 2 };
    let views = Scene::room().generate(&params).unwrap().scans;
    let written = views.iter().enumerate().map(|(number, view)| {
        let lines = view.scan.world_points().map(|point| {
            let [x, y, z] = point.unwrap().position;
            format!("{x} {y} {z}\n")
        });
        let file = folder.join(format!("view{number}.xyz"));
        std::fs::write(&file, lines.collect::<String>()).unwrap();
        let labels = folder.join(format!("view{number}.labels.npy"));
        write_labels_npy(&labels, view.labels.iter().copied(), view.labels.len() as u64).unwrap();
        file.to_str().unwrap().to_owned()
    });
    written.collect()
}

#[test]
fn a_scene_is_calibrated_and_all_is_written() {
    let folder = TempDir::new().unwrap();
    let scene = ["--scene", "table", "--points", "8000", "--copies", "6"];
    let run = calibrate(&scene, folder.path()).ended_with(0);
    assert!(run.stderr.is_empty(), "{}", run.stderr);
    for text in ["NEES/D", "planes", "mixed", "cells", "side_x", "min-max exceeded", "6 copies"] {
        assert!(run.stdout.contains(text), "{text}: {}", run.stdout);
    }
    let file = json(folder.path());
    assert_eq!((&file["format"], &file["version"]), (&"terrace-calibrate".into(), &1.into()));
    assert_eq!((&file["kind"], &file["copies"]), (&"scene".into(), &6.into()));
    assert!((0.4..2.0).contains(&nees(&file["planes"])), "{}", file["planes"]);
    assert_eq!(file["planes"]["coverage"].as_array().unwrap().len(), 4);
    assert_eq!(file["by_plane"].as_array().unwrap().len(), 3);
    assert!(file["min_max_exceeded"]["cells"]["of"].as_u64().unwrap() > 0);
    assert_eq!(&std::fs::read(folder.path().join("qq.png")).unwrap()[1..4], b"PNG");
    assert!(std::fs::read_to_string(folder.path().join("qq.svg")).unwrap().contains("planes"));

    // Elsewhere the noise is the same.
    let far = TempDir::new().unwrap();
    let moved = [&scene[..], &["--offset", "-1e6,1e6,0", "--no-cells", "--quiet"]].concat();
    let run = calibrate(&moved, far.path()).ended_with(0);
    assert!(run.stdout.is_empty());
    let there = json(far.path());
    assert_eq!(there["cells"], Value::Null);
    assert!((0.4..2.0).contains(&nees(&there["planes"])), "{}", there["planes"]);
}

#[test]
fn the_same_seed_gives_the_same_bytes_on_any_number_of_threads() {
    let files = ["1", "2"].map(|threads| {
        let folder = TempDir::new().unwrap();
        let arguments = ["--scene", "strip", "--points", "3000", "--copies", "4", "--threads", threads];
        let _ = calibrate(&arguments, folder.path()).ended_with(0);
        ["calibrate.json", "qq.png", "qq.svg"].map(|name| std::fs::read(folder.path().join(name)).unwrap())
    });
    assert!(files[0] == files[1]);
}

#[test]
fn what_the_extraction_is_not_told_is_seen() {
    let scene = ["--scene", "room", "--points", "60000", "--copies", "2", "--no-cells"];
    let pose = ["--pose-sigma", "0.02,0.3deg"];
    let run = |more: &[&str]| {
        let folder = TempDir::new().unwrap();
        let _ = calibrate(&[&scene[..], &pose, more].concat(), folder.path()).ended_with(0);
        json(folder.path())
    };
    let (told, untold) = (run(&[]), run(&["--pose-unstated"]));
    assert!(nees(&untold["planes"]) > 4.0 * nees(&told["planes"]));
    assert_eq!(
        (&told["parameters"]["noise"], &untold["parameters"]["pose_stated"]),
        (&"kinect".into(), &false.into())
    );
    let unstated = run(&["--unstated"]);
    assert_eq!(unstated["parameters"]["stated"], false);
}

#[test]
fn labelled_scans_are_calibrated_with_one_file_each_or_one_for_all() {
    let folder = TempDir::new().unwrap();
    let views = &room(folder.path())[..3];
    let labels: Vec<String> = views.iter().map(|view| view.replace(".xyz", ".labels.npy")).collect();
    let mut arguments: Vec<&str> = views.iter().map(String::as_str).collect();
    arguments.extend(["--sigma", "0.004", "--copies", "3", "--no-cells", "--labels"]);
    arguments.extend(labels.iter().map(String::as_str));
    let _ = calibrate(&arguments, folder.path()).ended_with(0);
    let file = json(folder.path());
    assert_eq!(file["kind"], "labelled");
    assert!((0.3..4.0).contains(&nees(&file["planes"])), "{}", file["planes"]);
    assert_eq!(file["by_plane"][0]["name"], "plane 1");

    let all: Vec<Option<PlaneId>> = labels
        .iter()
        .flat_map(|file| terrace_io::npy::read_labels(&std::fs::read(file).unwrap()).unwrap())
        .map(|number| PlaneId::new(number.cast_unsigned()))
        .collect();
    let together = folder.path().join("all.npy");
    write_labels_npy(&together, all.iter().copied(), all.len() as u64).unwrap();
    let mut for_all = arguments[..arguments.len() - labels.len()].to_vec();
    for_all.push(together.to_str().unwrap());
    let other = TempDir::new().unwrap();
    let _ = calibrate(&for_all, other.path()).ended_with(0);
    assert_eq!(json(other.path())["planes"], file["planes"]);
    let too_many = calibrate(&for_all[1..], other.path()).ended_with(1);
    assert!(
        too_many.stderr.contains("--labels") && too_many.stderr.contains("all.npy"),
        "{}",
        too_many.stderr
    );

    let too_few = calibrate(&arguments[..arguments.len() - 1], folder.path()).ended_with(2);
    assert!(too_few.stderr.contains("2 files for 3 inputs"), "{}", too_few.stderr);
    let silent = calibrate(&[views[0].as_str(), "--labels", &labels[0]], folder.path()).ended_with(2);
    assert!(silent.stderr.contains("name a sensor"), "{}", silent.stderr);
}

#[test]
fn scans_are_held_against_each_other() {
    let folder = TempDir::new().unwrap();
    let views = room(folder.path());
    std::fs::write(folder.path().join("broken.ply"), "ply\n").unwrap();
    let broken = folder.path().join("broken.ply").to_str().unwrap().to_owned();
    let mut arguments: Vec<&str> = views.iter().map(String::as_str).collect();
    arguments.extend([&broken, "--sigma", "0.002", "--cell", "0.1", "--views", "3", "--floor", "0.01"]);
    let run = calibrate(&arguments, folder.path()).ended_with(0);
    assert!(run.stderr.contains("left out") && run.stderr.contains("broken.ply"), "{}", run.stderr);
    for text in ["without floor", "floor 0.01 m", "by median", "14 of 15 inputs used"] {
        assert!(run.stdout.contains(text), "{text}: {}", run.stdout);
    }
    let file = json(folder.path());
    let runs = file["runs"].as_array().unwrap();
    assert_eq!((runs.len(), &file["kind"]), (2, &"scans".into()));
    // The points are exact: errors are far below what is claimed.
    assert!(runs.iter().all(|run| run["ratio_median"].as_f64().unwrap() < 0.1), "{}", run.stdout);
    let plane = &runs[0]["by_plane"][0];
    assert_eq!(plane["coefficients"].as_array().unwrap().len(), 4);
    assert!(plane["residuals"].as_array().unwrap().len() >= 3);
    assert_eq!(file["parameters"]["inputs_skipped"].as_array().unwrap().len(), 1);
}

#[test]
fn arguments_that_do_not_fit_are_refused() {
    let folder = TempDir::new().unwrap();
    for (arguments, text) in [
        (&[][..], "required"),
        (&["--scene", "table", "a.ply"], "cannot be used with"),
        (&["--scene", "table", "--labels", "a.npy"], "cannot be used with"),
        (&["--scene", "table", "--views", "3"], "--views"),
        (&["--scene", "table", "--intrinsics", "1,1,1,1"], "--intrinsics"),
        (&["--scene", "table", "--copies", "0"], "--copies"),
        (&["--scene", "table", "--offset", "1,2"], "three numbers"),
        (&["--scene", "table", "--points", "0"], "0 points"),
        (&["--scene", "table", "--floor", "-1"], "floor"),
        (&["--scene", "table", "--pose-unstated"], "--pose-sigma"),
        (&["--scene", "table", "--pose-sigma", "0.01,0.1deg"], "world frame"),
        (&["--scene", "table", "--phi", "0.2"], "--clusters"),
        (&["--scene", "table", "--depth", "2"], "--clusters"),
        (&["--scene", "table", "--min-cells", "9"], "--clusters"),
        (&["--scene", "table", "--clusters", "--phi", "2"], "phi is 2"),
        (&["a.ply", "--copies", "3"], "--copies"),
        (&["a.ply", "--unstated"], "--unstated"),
        (&["a.ply", "--points", "3"], "--scene"),
    ] {
        let run = calibrate(arguments, folder.path());
        assert!(run.code == 1 || run.code == 2, "{arguments:?}: {run:?}");
        assert!(run.stderr.contains(text), "{arguments:?}: {}", run.stderr);
        assert!(!run.stderr.contains("panicked"));
    }
    let missing = calibrate(&["nowhere.ply"], folder.path());
    assert!(missing.code != 0 && missing.stderr.contains("nowhere.ply"), "{}", missing.stderr);
    assert!(!folder.path().join("calibrate.json").exists());
}

#[test]
fn a_hall_of_a_real_lidar_is_read() {
    let Some(hall) = real("balm_real") else { return };
    let folder = TempDir::new().unwrap();
    let (scans, poses) = (hall.join("full*.pcd"), hall.join("alidarPose.csv"));
    let arguments = [
        scans.to_str().unwrap(),
        "--poses",
        poses.to_str().unwrap(),
        "--sensor",
        "lidar:range=0.02,angle=0.05deg",
        "--cell",
        "0.4",
    ];
    let run = calibrate(&arguments, folder.path()).ended_with(0);
    assert!(run.stdout.contains("inputs used"), "{}", run.stdout);
    assert!(json(folder.path())["runs"][0]["count"].as_u64().unwrap() > 5);
}
