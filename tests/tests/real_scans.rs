//! Real scans of a table top, a kitchen and a hall. Skipped, with a message, where the scans are not there.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

use std::path::Path;

use terrace_tests::{labels, planes, real, terrace};

#[test]
fn table_top_of_a_kinect_is_one_plane() {
    let Some(scan) = real("pcl_data/milk_cartoon_all_small_clorox.pcd") else { return };
    let out = tempfile::tempdir().unwrap();
    let _ = terrace([Path::new("extract"), &scan, Path::new("--out"), out.path()]).ended_with(0);
    let file = planes(out.path());
    let table = file.planes.iter().max_by_key(|p| p.points).unwrap();
    assert!(table.points > 100_000, "{table:?}");
    assert!(table.rms.unwrap() < 0.005, "{table:?}");
    let labelled = labels(out.path()).iter().filter(|&&x| i64::from(x) == i64::from(table.id)).count();
    assert_eq!(labelled as u64, table.points);
}

#[test]
fn kitchen_of_five_posed_frames_has_large_planes() {
    let Some(frames) = real("sevenscenes") else { return };
    let folder = tempfile::tempdir().unwrap();
    let [kitchen, out] = ["kitchen", "out"].map(|name| folder.path().join(name));
    std::fs::create_dir(&kitchen).unwrap();
    for number in [0, 10, 20, 30, 40] {
        for end in ["depth.png", "pose.txt"] {
            let name = format!("frame-{number:06}.{end}");
            // Written, not copied: the originals may be read-only.
            std::fs::write(kitchen.join(&name), std::fs::read(frames.join(&name)).unwrap()).unwrap();
        }
    }
    let arguments = ["--intrinsics", "585,585,320,240", "--sensor", "kinect", "--no-points", "--out"];
    let run = terrace(
        [Path::new("extract"), &kitchen].into_iter().chain(arguments.map(Path::new)).chain([out.as_path()]),
    )
    .ended_with(0);
    assert!(!run.stderr.contains("warning"), "{}", run.stderr);
    let file = planes(&out);
    assert_eq!(file.parameters["inputs"], 5);
    assert_eq!(labels(&out).len(), 5 * 640 * 480);
    let large = file.planes.iter().filter(|p| p.points > 20_000).count();
    assert!(large >= 3, "{large} planes above 20 000 points");
    assert!(!out.join("points.ply").exists());
}

#[test]
fn hall_of_six_lidar_scans_has_a_floor() {
    let Some(hall) = real("balm_real") else { return };
    let out = tempfile::tempdir().unwrap();
    let poses = hall.join("alidarPose.csv");
    let _ = terrace([
        Path::new("extract"),
        &hall,
        Path::new("--poses"),
        &poses,
        Path::new("--out"),
        out.path(),
        Path::new("--no-points"),
    ])
    .ended_with(0);
    let file = planes(out.path());
    assert_eq!(file.parameters["inputs"], 6);
    let floor = file.planes.iter().find(|p| p.coefficients[2].abs() > 0.98 && p.points > 20_000);
    let floor = floor.expect("a level plane of more than 20 000 points");
    assert!(floor.rms.unwrap() < 0.05, "{floor:?}");
}
