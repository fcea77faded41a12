//! Which files are taken, in which order, and with which pose.
#![allow(
    clippy::unwrap_used,
    clippy::cast_possible_truncation,
    clippy::float_cmp,
    reason = "a test may fail, and compares exactly"
)]

mod common;

use std::path::{Path, PathBuf};

use ::png::{BitDepth, ColorType};
use common::{depth_png, png, write};
use proptest::prelude::*;
use tempfile::TempDir;
use terrace_io::{Source, SourceError, find_sources, natural_order};

fn folder(files: &[(&str, &[u8])]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        write(&folder.path().join(name), bytes);
    }
    folder
}

fn names(sources: &[Source]) -> Vec<String> {
    sources.iter().map(|s| s.path.file_name().unwrap().to_string_lossy().into_owned()).collect()
}

fn heights(sources: &[Source]) -> Vec<Option<f64>> {
    sources.iter().map(|s| s.pose.map(|p| p.translation()[2])).collect()
}

fn pose_at(z: f64) -> String {
    format!("1 0 0 0\n0 1 0 0\n0 0 1 {z}\n0 0 0 1\n")
}

/// KITTI lines whose z is their index.
fn kitti(count: usize) -> String {
    (0..count).map(|z| format!("1 0 0 0 0 1 0 0 0 0 1 {z}")).collect::<Vec<_>>().join("\n")
}

#[test]
fn folder_of_depth_images_with_poses_beside() {
    let depth = depth_png(1, &[1000]);
    let colour = png(1, 1, ColorType::Rgb, BitDepth::Eight, &[0; 3]);
    let (one, two) = (pose_at(1.0), pose_at(2.0));
    let place = folder(&[
        ("frame-10.depth.png", &depth),
        ("frame-9.depth.png", &depth),
        ("frame-9.color.png", &colour),
        ("frame-9.pose.txt", one.as_bytes()),
        ("frame-10.pose.txt", two.as_bytes()),
        ("camera-intrinsics.txt", b"585 0 320 0 585 240 0 0 1"),
        (".hidden.ply", b"ply\n"),
        ("points.npy", b""),
    ]);
    let sources = find_sources(&[place.path()], None).unwrap();
    assert_eq!(names(&sources), ["frame-9.depth.png", "frame-10.depth.png"]);
    assert_eq!(heights(&sources), [Some(1.0), Some(2.0)]);

    let by_pattern = find_sources(&[place.path().join("frame-*")], None).unwrap();
    assert_eq!(by_pattern, sources);
    let by_folder = find_sources(&[place.path()], Some(place.path())).unwrap();
    assert_eq!(by_folder, sources);

    std::fs::remove_file(place.path().join("frame-9.pose.txt")).unwrap();
    let error = find_sources(&[place.path()], None).unwrap_err();
    assert!(matches!(error, SourceError::PoseMissing { path } if path.ends_with("frame-9.depth.png")));
}

#[test]
fn pose_beside_an_image_of_plain_name() {
    let place = folder(&[("a.png", &depth_png(1, &[1])), ("a.pose.txt", pose_at(3.0).as_bytes())]);
    assert_eq!(heights(&find_sources(&[place.path().join("a.png")], None).unwrap()), [Some(3.0)]);
}

#[test]
fn damaged_pose_beside_names_the_file() {
    let bad = pose_at(f64::NEG_INFINITY);
    let place = folder(&[("a.depth.png", &depth_png(1, &[1])), ("a.pose.txt", bad.as_bytes())]);
    let message = find_sources(&[place.path()], None).unwrap_err().to_string();
    assert!(message.contains("a.pose.txt") && message.contains("-inf"), "{message}");
}

#[test]
fn tables_only_where_there_is_no_cloud() {
    let files: &[(&str, &[u8])] = &[
        ("scan2.xyz", b"0 0 0"),
        ("scan10.csv", b"0 0 0"),
        ("labels.npy", b""),
        ("alidarPose.csv", b""),
        ("sigma.npy", b""),
    ];
    let place = folder(files);
    assert_eq!(names(&find_sources(&[place.path()], None).unwrap()), ["scan2.xyz", "scan10.csv"]);
    write(&place.path().join("cloud.PLY"), b"ply\n");
    assert_eq!(names(&find_sources(&[place.path()], None).unwrap()), ["cloud.PLY"]);
}

#[test]
fn nothing_usable_names_the_folder() {
    let place = folder(&[("notes.md", b"hello"), ("image.jpg", b"\xff\xd8\xff")]);
    let error = find_sources(&[place.path()], None).unwrap_err();
    assert!(error.to_string().contains(&place.path().display().to_string()));
    assert!(matches!(error, SourceError::NothingUsable { files: 2, .. }));
    let error = find_sources(&[place.path().join("*.md")], None).unwrap_err();
    assert!(matches!(error, SourceError::NothingUsable { files: 1, .. }));
}

#[test]
fn no_such_input() {
    assert!(matches!(find_sources::<PathBuf>(&[], None), Err(SourceError::NoInput)));
    for missing in ["no/such/file.ply", "no/such/*.ply"] {
        assert!(matches!(find_sources(&[missing], None), Err(SourceError::NotFound { .. })));
    }
    assert!(matches!(find_sources(&["scan[.ply"], None), Err(SourceError::Pattern { .. })));
}

#[test]
fn literal_name_wins_over_pattern() {
    let place = folder(&[("scan[1].ply", b"ply\n"), ("scan1.ply", b"ply\n")]);
    let sources = find_sources(&[place.path().join("scan[1].ply")], None).unwrap();
    assert_eq!(names(&sources), ["scan[1].ply"]);
    let sources = find_sources(&[place.path().join("scan?.ply")], None).unwrap();
    assert_eq!(names(&sources), ["scan1.ply"]);
}

#[test]
fn pattern_over_folders() {
    let place =
        folder(&[("run10/a.ply", b""), ("run9/b.ply", b""), ("run9/a.ply", b""), ("other/c.txt", b"")]);
    let sources = find_sources(&[place.path().join("run*")], None).unwrap();
    assert_eq!(names(&sources), ["a.ply", "b.ply", "a.ply"]);
    assert!(sources[0].path.parent().unwrap().ends_with("run9"));
}

#[test]
fn as_many_poses_as_scans_go_in_order() {
    let place = folder(&[("s8.ply", b""), ("s16.ply", b""), ("p.txt", kitti(2).as_bytes())]);
    let sources = find_sources(&[place.path()], Some(&place.path().join("p.txt"))).unwrap();
    assert_eq!(names(&sources), ["s8.ply", "s16.ply"]);
    assert_eq!(heights(&sources), [Some(0.0), Some(1.0)]);
}

#[test]
fn poses_by_time_stamp() {
    let tum = "10.000 0 0 0 0 0 0 1\n11.015 0 0 1 0 0 0 1\n12.0 0 0 2 0 0 0 1\n";
    let place = folder(&[("11.000.ply", b""), ("12.010000.ply", b""), ("p.txt", tum.as_bytes())]);
    let poses = place.path().join("p.txt");
    assert_eq!(heights(&find_sources(&[place.path()], Some(&poses)).unwrap()), [Some(1.0), Some(2.0)]);
    let place = folder(&[("11.500.ply", b""), ("p.txt", tum.as_bytes())]);
    let error = find_sources(&[place.path()], Some(&place.path().join("p.txt"))).unwrap_err();
    assert!(matches!(error, SourceError::NoPoseAtTime { distance, .. } if (distance - 0.485).abs() < 1e-9));
    let nanoseconds = "1403636579.763 0 0 1 0 0 0 1\n1403636580.763 0 0 2 0 0 0 1\n";
    let place = folder(&[("1403636579763555584.ply", b""), ("p.txt", nanoseconds.as_bytes())]);
    assert_eq!(
        heights(&find_sources(&[place.path()], Some(&place.path().join("p.txt"))).unwrap()),
        [Some(1.0)]
    );
}

#[test]
fn poses_by_number_in_the_name() {
    let place = folder(&[("full0.pcd", b""), ("full16.pcd", b""), ("p.csv", kitti(20).as_bytes())]);
    let sources = find_sources(&[place.path()], Some(&place.path().join("p.csv"))).unwrap();
    assert_eq!(heights(&sources), [Some(0.0), Some(16.0)]);
}

#[test]
fn counts_differ_and_names_do_not_tell() {
    for (a, b) in [("a.ply", "b.ply"), ("a1.ply", "b1.ply"), ("a1.ply", "a99.ply")] {
        let place = folder(&[(a, b""), (b, b""), ("p.txt", kitti(3).as_bytes())]);
        let error = find_sources(&[place.path()], Some(&place.path().join("p.txt"))).unwrap_err();
        assert!(matches!(error, SourceError::CountMismatch { poses: 3, scans: 2, .. }), "{error}");
        assert!(error.to_string().contains("3 poses for 2 scans"));
    }
}

#[test]
fn folder_of_poses() {
    let place = folder(&[
        ("pcs/PC-0071.pcd", b""),
        ("pcs/PC-0081.pcd", b""),
        ("poses/pose-0071.txt", pose_at(71.0).as_bytes()),
        ("poses/pose-0081.txt", pose_at(81.0).as_bytes()),
        ("poses/README.md", b"poses"),
        ("two/pose-71.txt", kitti(2).as_bytes()),
        ("two/pose-81.txt", b""),
        ("two/pose-081.txt", b""),
    ]);
    let (scans, poses, two) =
        (place.path().join("pcs"), place.path().join("poses"), place.path().join("two"));
    assert_eq!(heights(&find_sources(&[&scans], Some(&poses)).unwrap()), [Some(71.0), Some(81.0)]);
    let error = find_sources(&[scans.join("PC-0071.pcd")], Some(&two)).unwrap_err();
    assert!(matches!(error, SourceError::NotOnePose { count: 2, .. }));
    let error = find_sources(&[scans.join("PC-0081.pcd")], Some(&two)).unwrap_err();
    assert!(matches!(error, SourceError::NoPoseForNumber { found: 2, .. }));
    let error = find_sources(&[&scans], Some(&place.path().join("pcs"))).unwrap_err();
    assert!(matches!(error, SourceError::Poses(_)), "{error}");
    let error = find_sources(&[&scans], Some(Path::new("no/such"))).unwrap_err();
    assert!(matches!(error, SourceError::Poses(_)));
}

proptest! {
    #[test]
    fn natural_order_counts(a in 0_u64.., b in 0_u64.., prefix in "[a-z_-]{0,3}", suffix in "[a-z.]{0,3}", pad in 0_usize..24) {
        let name = |n: u64| format!("{prefix}{n:0pad$}{suffix}");
        prop_assert_eq!(natural_order(&name(a), &name(b)), a.cmp(&b));
    }

    #[test]
    fn natural_order_is_total(a in "[a0-2é.]{0,6}", b in "[a0-2é.]{0,6}", c in "[a0-2é.]{0,6}") {
        prop_assert_eq!(natural_order(&a, &b), natural_order(&b, &a).reverse());
        prop_assert_eq!(natural_order(&a, &b).is_eq(), a == b);
        if natural_order(&a, &b).is_le() && natural_order(&b, &c).is_le() {
            prop_assert!(natural_order(&a, &c).is_le());
        }
    }
}
