//! Noise models of sensors and noise of poses on the command line: what is recorded, and what is refused.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

use std::path::Path;

use serde_json::json;
use tempfile::TempDir;
use terrace_tests::{Run, planes, terrace};

/// Three scans of a wall from one place each, as PCD with its place, and their poses.
struct Files {
    folder: TempDir,
}

impl Files {
    fn new() -> Self {
        let files = Self { folder: tempfile::tempdir().unwrap() };
        let point = |i: u32| format!("{} 4 {}\n", f64::from(i % 80) * 0.02, f64::from(i / 80) * 0.02);
        let points: String = (0..4000).map(point).collect();
        for scan in ["scan0", "scan1", "scan2"] {
            std::fs::write(files.path(&format!("{scan}.xyz")), &points).unwrap();
        }
        let pcd = format!(
            "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 4001\nHEIGHT 1\n\
             VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 4001\nDATA ascii\n{points}0 0 0\n"
        );
        std::fs::write(files.path("placed.pcd"), pcd).unwrap();
        let pose = |x: u32| format!("1 0 0 {x} 0 1 0 0 0 0 1 0\n");
        std::fs::write(files.path("poses.txt"), (0..3).map(pose).collect::<String>()).unwrap();
        files
    }

    fn path(&self, name: &str) -> String {
        self.folder.path().join(name).to_str().unwrap().to_owned()
    }

    fn out(&self) -> String {
        self.path("out")
    }

    /// `extract` of the scans with their poses.
    fn posed(&self, arguments: &[&str]) -> Run {
        let (scans, poses, out) = (self.path("scan*.xyz"), self.path("poses.txt"), self.out());
        let base = ["extract", &scans, "--poses", &poses, "--out", &out, "--no-points"];
        terrace(base.iter().chain(arguments))
    }

    /// `extract` of one file without poses.
    fn alone(&self, name: &str, arguments: &[&str]) -> Run {
        let (scan, out) = (self.path(name), self.out());
        terrace(["extract", &scan, "--out", &out, "--no-points"].iter().chain(arguments))
    }

    fn parameter(&self, name: &str) -> serde_json::Value {
        planes(Path::new(&self.out())).parameters[name].clone()
    }
}

#[test]
fn every_model_is_taken_and_recorded() {
    let files = Files::new();
    for (given, recorded) in [
        ("kinect", "kinect"),
        ("kinect:focal=525", "kinect:focal=525"),
        ("stereo:fb=80,disparity=0.2,focal=700", "stereo:fb=80,disparity=0.2,focal=700"),
        ("lidar: angle=2mrad, range=0.02", "lidar:range=0.02,angle=0.002rad"),
        ("uniform:0.01", "uniform:0.01"),
        ("axes:0.01,0.01,0.02", "axes:0.01,0.01,0.02"),
    ] {
        let run = files.posed(&["--sensor", given]).ended_with(0);
        assert!(!run.stdout.contains("unknown"), "{given}: {}", run.stdout);
        assert_eq!(files.parameter("errors"), json!({ "sensor": recorded }));
        assert_eq!(planes(Path::new(&files.out())).planes.len(), 1, "{given}");
    }
    assert_eq!(files.parameter("pose_sigma"), json!(null));
    assert_eq!(files.parameter("pose_covariances"), json!(null));
}

#[test]
fn a_point_at_the_sensor_is_told_and_has_no_label() {
    let files = Files::new();
    let run = files.alone("placed.pcd", &["--sensor", "kinect"]).ended_with(0);
    assert!(run.stderr.contains("1 points are no measurements"), "{}", run.stderr);
    assert_eq!(planes(Path::new(&files.out())).summary.unwrap().labelled, 4000);
    let run = files.alone("placed.pcd", &["--sigma", "0.01"]).ended_with(0);
    assert!(!run.stderr.contains("no measurements"), "{}", run.stderr);
}

#[test]
fn wrong_sensors_end_with_2_for_every_command() {
    let files = Files::new();
    let (scan, out) = (files.path("scan0.xyz"), files.out());
    for (spec, told) in [
        ("radar", "there is no sensor 'radar'"),
        ("kinect:focus=1", "kinect has no key 'focus'; allowed are focal"),
        ("lidar:range=0.02", "lidar needs the key 'angle'"),
        ("uniform:-1", "uniform is -1"),
        ("axes:1,2", "axes takes 3 value(s)"),
        ("stereo:fb=0,disparity=1,focal=1", "fb is 0"),
    ] {
        for command in
            [&["extract", &scan, "--out", &out][..], &["tune", &scan, "--out", &out], &["info", &scan]]
        {
            let run = terrace(command.iter().chain(&["--sensor", spec])).ended_with(2);
            assert!(run.stderr.contains(told) && run.stderr.contains("--sensor"), "{spec}: {}", run.stderr);
        }
    }
    let both = files.alone("scan0.xyz", &["--sensor", "kinect", "--sigma", "0.01"]).ended_with(2);
    assert!(both.stderr.contains("--sigma"), "{}", both.stderr);
}

#[test]
fn a_model_that_needs_the_sensor_says_so() {
    let files = Files::new();
    let run = files.alone("scan0.xyz", &["--sensor", "lidar:range=0.02,angle=1mrad"]).ended_with(1);
    for word in ["scan0.xyz", "lidar:range=0.02", "pose"] {
        assert!(run.stderr.contains(word), "{}", run.stderr);
    }
}

#[test]
fn info_tells_the_model_given() {
    let files = Files::new();
    let run = terrace(["info", &files.path("scan0.xyz"), "--sensor", "kinect"]).ended_with(0);
    assert!(run.stdout.contains("sigma      by kinect, as given"), "{}", run.stdout);
    let run = terrace(["info", &files.path("scan0.xyz"), "--sigma", "0.01"]).ended_with(0);
    assert!(run.stdout.contains("sigma      0.01 m, as given"), "{}", run.stdout);
}

#[test]
fn tune_repeats_the_sensor() {
    let files = Files::new();
    let (scan, poses, out) = (files.path("scan0.xyz"), files.path("poses.txt"), files.out());
    std::fs::write(&poses, "1 0 0 0 0 1 0 0 0 0 1 0\n").unwrap();
    let arguments = ["--poses", &poses, "--evaluations", "2", "--sensor", "lidar:range=0.02,angle=1mrad"];
    let run = terrace(["tune", &scan, "--out", &out].iter().chain(&arguments)).ended_with(0);
    assert!(run.stdout.contains("--sensor lidar:range=0.02,angle=0.001rad"), "{}", run.stdout);
}

#[test]
fn the_noise_of_poses_is_recorded() {
    let files = Files::new();
    let _ = files.posed(&["--sigma", "0.01", "--pose-sigma", "0.02,5mrad"]).ended_with(0);
    assert_eq!(files.parameter("pose_sigma"), json!({ "translation": 0.02, "rotation": 0.005 }));
    assert_eq!(files.parameter("pose_covariances"), json!(null));

    let rows = files.path("rows.csv");
    std::fs::write(&rows, "# m, rad\n0.01,0.001\n0.02,0.001\n0.03,0.001\n").unwrap();
    let _ = files.posed(&["--sigma", "0.01", "--pose-covariances", &rows]).ended_with(0);
    assert_eq!(files.parameter("pose_sigma"), json!(null));
    assert_eq!(files.parameter("pose_covariances"), json!(rows));
    // The place in a PCD is a pose as well.
    let _ = files.alone("placed.pcd", &["--sigma", "0.01", "--pose-sigma", "0.02,0.3deg"]).ended_with(0);
}

#[test]
fn wrong_noise_of_poses_is_told() {
    let files = Files::new();
    for (value, told) in [
        ("0.02,0.3", "rotation is '0.3'; allowed is a number with deg, mrad or rad"),
        ("0.02", "'0.02' is not T,R"),
        ("-1,0.3deg", "translation is -1"),
        ("0.02,-3deg", "rotation is -3"),
        ("wide,3deg", "translation is 'wide'"),
    ] {
        let run = files.posed(&["--pose-sigma", value]).ended_with(2);
        assert!(run.stderr.contains(told) && run.stderr.contains("--pose-sigma"), "{value}: {}", run.stderr);
    }
    let rows = files.path("rows.csv");
    for (text, told) in [
        ("0.01,0.001\n0.02,0.001\n", "2 rows for 3 scans with 3 poses"),
        ("0.01,0.001\n0.02,-7\n0.03,0\n", "rows.csv: line 2: rotation is -7"),
        ("0.01,0.001,3\n", "line 1 has 3 values"),
        ("", "no row"),
    ] {
        std::fs::write(&rows, text).unwrap();
        let run = files.posed(&["--pose-covariances", &rows]).ended_with(1);
        assert!(run.stderr.contains(told), "{text}: {}", run.stderr);
        let both = files.posed(&["--pose-covariances", &rows, "--pose-sigma", "0,0rad"]).ended_with(2);
        assert!(both.stderr.contains("--pose-sigma"), "{}", both.stderr);
    }
    assert!(!Path::new(&files.out()).exists());
}

#[test]
fn noise_of_a_pose_that_is_not_known_is_refused() {
    let files = Files::new();
    let run = files.alone("scan0.xyz", &["--pose-sigma", "0.02,0.3deg"]).ended_with(1);
    assert!(run.stderr.contains("scan0.xyz") && run.stderr.contains("--poses"), "{}", run.stderr);
    assert!(!Path::new(&files.out()).exists());
}
