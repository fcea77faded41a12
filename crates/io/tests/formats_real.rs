//! Real files, where there are any: the number of points their headers tell, and coordinates that make sense.

#![allow(clippy::unwrap_used, clippy::panic, clippy::float_cmp)]
#![allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]

mod formats_support;

use std::path::{Path, PathBuf};

use formats_support::{Format, data};
use terrace_io::{Cloud, FieldChoice, npy, pcd, text};
use terrace_types::{Pose, Sigma};

/// All files of a folder and the folders in it that end with `extension`, in a fixed order.
fn files(folder: &Path, extension: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).into_iter().flatten() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files(&path, extension));
        } else if path.to_string_lossy().ends_with(extension) {
            found.push(path);
        }
    }
    found.sort();
    found
}

fn read(path: &Path, format: Format) -> Cloud {
    let bytes = std::fs::read(path).unwrap();
    format.read(&bytes).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The number in the first line of the header that starts with `key`.
fn promised(path: &Path, key: &str) -> usize {
    let bytes = std::fs::read(path).unwrap();
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(2000)]).into_owned();
    head.lines().find_map(|line| line.strip_prefix(key)).unwrap().trim().parse().unwrap()
}

/// How many points are present, and the largest coordinate.
fn present(cloud: &Cloud) -> (usize, f64) {
    let finite = cloud.points.iter().filter(|p| p.iter().all(|x| x.is_finite()));
    finite.fold((0, 0.0), |(n, largest), p| (n + 1, p.iter().fold(largest, |m, x| x.abs().max(m))))
}

#[test]
fn all_ply_files() {
    let Some(data) = data() else { return };
    let found = files(&data, ".ply");
    for path in &found {
        let cloud = read(path, Format::Ply);
        assert_eq!(cloud.points.len(), promised(path, "element vertex"), "{}", path.display());
        let (points, largest) = present(&cloud);
        assert_eq!(points, cloud.points.len(), "{}", path.display());
        assert!(largest > 0.1 && largest < 500.0, "{}: {largest}", path.display());
        // A label for every point, where there are labels.
        if let Ok(labels) = std::fs::read(path.with_extension("labels.npy")) {
            assert_eq!(npy::read_labels(&labels).unwrap().len(), points, "{}", path.display());
        }
    }
    eprintln!("{} PLY files", found.len());
}

#[test]
fn all_pcd_files() {
    let Some(data) = data() else { return };
    let found = files(&data, ".pcd");
    for path in &found {
        let cloud = read(path, Format::Pcd);
        assert_eq!(cloud.points.len(), promised(path, "POINTS"), "{}", path.display());
        let (points, largest) = present(&cloud);
        // A Kinect frame may have a third without a measurement.
        assert!(3 * points > cloud.points.len(), "{}: {points} present", path.display());
        // Some of the tutorials are not in metres.
        let most = if path.parent().is_some_and(|folder| folder.ends_with("pcl_data")) { 1e7 } else { 500.0 };
        assert!(largest > 0.1 && largest < most, "{}: {largest}", path.display());
        assert!(cloud.viewpoint.is_some(), "{}", path.display());
    }
    eprintln!("{} PCD files", found.len());
}

#[test]
fn the_viewpoint_of_a_capture_is_turned_about_x() {
    let Some(data) = data() else { return };
    for path in files(&data, "capture0001.pcd") {
        let pose = read(&path, Format::Pcd).viewpoint.unwrap();
        assert_eq!(pose, Pose::from_quaternion([0.0; 3], [1.0, 0.0, 0.0, 0.0]).unwrap());
        assert_eq!(pose.rotate([0.0, 0.0, 1.0]), [0.0, 0.0, -1.0]);
    }
}

#[test]
fn scenes_are_the_same_in_ply_and_npy() {
    let Some(data) = data() else { return };
    for path in files(&data.join("scenes"), "points.ply") {
        let array = npy::read(&std::fs::read(path.with_extension("npy")).unwrap()).unwrap();
        assert_eq!(read(&path, Format::Ply).points, array.points, "{}", path.display());
        let sigma = npy::read_scalars(&std::fs::read(path.with_file_name("sigma.npy")).unwrap()).unwrap();
        let labels = npy::read_labels(&std::fs::read(path.with_file_name("labels.npy")).unwrap()).unwrap();
        assert_eq!((sigma.len(), labels.len()), (array.points.len(), array.points.len()));
        assert!(sigma.iter().all(|sigma| *sigma > 0.0 && *sigma < 0.5));
    }
    for path in files(&data.join("scenes"), "organized.npy") {
        let organised = npy::read(&std::fs::read(&path).unwrap()).unwrap();
        let points = npy::read(&std::fs::read(path.with_file_name("points.npy")).unwrap()).unwrap().points;
        assert_eq!((organised.points.len(), present(&organised).0), (640 * 480, points.len()));
    }
}

#[test]
fn synpeb_is_the_same_in_ply_and_pcd() {
    let Some(data) = data() else { return };
    let folder = data.join("synpeb");
    let (Some(ply), Some(pcd)) = (files(&folder, ".ply").pop(), files(&folder, ".pcd").pop()) else { return };
    let (ply, bytes) = (read(&ply, Format::Ply), std::fs::read(pcd).unwrap());
    let pcd = pcd::read(&bytes, &FieldChoice::Named("intensity".into())).unwrap();
    assert_eq!(ply.points.len(), pcd.points.len());
    // The text has six decimals, the PLY is single precision.
    for (a, b) in ply.points.as_flattened().iter().zip(pcd.points.as_flattened()) {
        assert!((a - b).abs() <= 5e-7 + 1e-7 * b.abs(), "{a} {b}");
    }
    let Sigma::PerPoint(intensity) = pcd.sigma else { panic!("no field read") };
    assert!(intensity.iter().all(|label| label.fract() == 0.0));
    // The same points as plain text.
    let body = bytes
        .windows(11)
        .position(|w| w == b"DATA ascii\n")
        .or_else(|| bytes.windows(10).position(|w| w == b"DATA ascii"));
    let lines: Vec<&[u8]> = bytes[body.unwrap()..].split(|b| *b == b'\n').skip(1).collect();
    let text = text::read(&lines.join(&b'\n'), &FieldChoice::Automatic).unwrap();
    assert_eq!(text.points, pcd.points);
}
