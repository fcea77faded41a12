//! The large planes of synthetic scenes come out as planes of their own.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

use std::path::Path;

use terrace_tests::{best_overlap, labels, planes, terrace};

/// With planes as regions, and as clusters.
const PRESETS: [&str; 2] = ["default", "clusters"];

fn found(scene: &str, names: &[&str], at_least: [f64; 2]) {
    let folder = tempfile::tempdir().unwrap();
    let [truth, out] = ["truth", "out"].map(|name| folder.path().join(name).to_str().unwrap().to_owned());
    let _ = terrace(["synth", scene, "--points", "60000", "--seed", "3", "--out", &truth]).ended_with(0);
    for (preset, at_least) in PRESETS.into_iter().zip(at_least) {
        let cloud = format!("{truth}/points.ply");
        let _ = terrace(["extract", &cloud, "--out", &out, "--preset", preset]).ended_with(0);
        let [true_labels, found_labels] = [&truth, &out].map(|folder| labels(Path::new(folder)));
        let true_planes = planes(Path::new(&truth)).planes;
        for name in names {
            let plane = true_planes.iter().find(|p| p.name.as_deref() == Some(*name)).unwrap();
            let overlap = best_overlap(&true_labels, &found_labels, i32::try_from(plane.id).unwrap());
            assert!(overlap > at_least, "{preset}, {scene}, {name}: intersection over union {overlap:.3}");
        }
    }
}

#[test]
fn three_planes_of_the_table() {
    found("table", &["top", "side_x", "side_y"], [0.95, 0.8]);
}

#[test]
fn floor_walls_and_table_of_the_room() {
    found("room", &["floor", "wall_x0", "wall_x5", "wall_y0", "wall_y4", "table_1"], [0.9, 0.5]);
}

#[test]
fn floor_and_long_walls_of_the_corridor() {
    found("corridor", &["floor", "ceiling", "wall_y0", "wall_y2", "wall_x13", "wall_x16"], [0.9, 0.5]);
}

#[test]
fn overlap_is_intersection_over_union() {
    let truth = [1, 1, 1, 1, 2, 2, 0, 0];
    let found = [3, 3, 3, 0, 3, 1, 1, 0];
    assert!((best_overlap(&truth, &found, 1) - 0.6).abs() < 1e-12);
    assert!((best_overlap(&truth, &found, 2) - 1.0 / 3.0).abs() < 1e-12);
    assert!(best_overlap(&truth, &found, 5).abs() < 1e-12);
}
