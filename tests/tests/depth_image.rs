//! A single depth image goes by tiles of pixels, and as a cloud of points where that is asked for.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

use std::path::{Path, PathBuf};

use terrace_io::planes_json::PlanesFile;
use terrace_tests::{labels, planes, terrace};

fn data() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("data")
}

fn extract(image: &Path, more: &[&str]) -> (PlanesFile, Vec<i32>) {
    let out = tempfile::tempdir().unwrap();
    let always = ["--intrinsics", "525,525,319.5,239.5", "--sensor", "kinect", "--no-points", "--out"];
    let arguments = [Path::new("extract"), image].into_iter().chain(always.map(Path::new));
    let _ = terrace(arguments.chain([out.path()]).chain(more.iter().map(Path::new))).ended_with(0);
    (planes(out.path()), labels(out.path()))
}

fn dot(a: [f64; 4], b: [f64; 4]) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

#[test]
fn it_has_planes_labels_and_covariances_without_cells() {
    let (file, labels) = extract(&data().join("rgbd/00000.png"), &[]);
    assert!(file.parameters["image"]["tile"] == 8 && !file.parameters.contains_key("cell_size"));
    assert_eq!(labels.len(), 640 * 480);
    assert!(file.planes.len() >= 3);
    for plane in &file.planes {
        let count = labels.iter().filter(|label| i64::from(**label) == i64::from(plane.id)).count();
        assert_eq!(count as u64, plane.points);
        let covariance = plane.tilt_offset_covariance.as_ref().expect("a covariance");
        assert!(covariance.largest_tilt() > 0.0 && plane.coefficients[3] > 0.0, "{plane:?}");
    }
    let (without, _) = extract(&data().join("rgbd/00000.png"), &["--no-covariance"]);
    assert!(without.planes.iter().all(|plane| plane.covariance.is_none()));
}

#[test]
fn both_ways_find_the_large_planes_in_the_world() {
    let poses = data().join("trajectory.log");
    let image = data().join("rgbd/00003.png");
    let poses = ["--poses", poses.to_str().unwrap()];
    let (by_tiles, _) = extract(&image, &poses);
    let (by_cells, _) = extract(&image, &[poses[0], poses[1], "--cell", "0.06"]);
    assert!(by_tiles.parameters.contains_key("image") && !by_cells.parameters.contains_key("image"));
    for plane in by_tiles.planes.iter().take(2) {
        let same = by_cells.planes.iter().any(|other| {
            let at = plane.centroid.expect("a centroid");
            let off: f64 = (0..3).map(|i| other.coefficients[i] * at[i]).sum::<f64>() + other.coefficients[3];
            dot(plane.coefficients, other.coefficients) > 0.999 && off.abs() < 0.01
        });
        assert!(same, "{plane:?}");
    }
}

#[test]
fn a_damaged_image_is_told_as_before() {
    let folder = tempfile::tempdir().unwrap();
    let (image, out) = (folder.path().join("cut.png"), folder.path().join("out"));
    let whole = std::fs::read(data().join("rgbd/00000.png")).unwrap();
    std::fs::write(&image, &whole[..whole.len() / 2]).unwrap();
    let arguments = ["--intrinsics", "525,525,319.5,239.5", "--out"];
    let run = terrace(
        [Path::new("extract"), &image].into_iter().chain(arguments.map(Path::new)).chain([out.as_path()]),
    )
    .ended_with(1);
    assert!(run.stderr.contains("cut.png"), "{}", run.stderr);
}
