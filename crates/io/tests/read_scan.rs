//! From a file to a scan: format, errors, frame, and what cannot be read.
#![allow(
    clippy::unwrap_used,
    clippy::cast_possible_truncation,
    clippy::float_cmp,
    reason = "a test may fail, and compares exactly"
)]

mod common;

use std::path::PathBuf;

use common::{depth_png, write};
use tempfile::TempDir;
use terrace_io::{
    DepthError, ErrorSource, FieldChoice, Info, ReadError, ReadErrorKind, ReadOptions, Source, inspect,
    read_scan,
};
use terrace_noise::Kinect;
use terrace_types::{Frame, Pose, Scan, ScanError, Sigma};

const PCD: &str = "VERSION 0.7\nFIELDS x y z sigma\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\nWIDTH 3\nHEIGHT 1\n\
    VIEWPOINT 0 0 2 1 0 0 0\nPOINTS 3\nDATA ascii\n0 0 0 0.5\n3 0 -2 0.25\nnan nan nan 0\n";

struct Files(TempDir);

impl Files {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.path().join(name);
        write(&path, bytes);
        path
    }

    fn read(
        &self,
        name: &str,
        bytes: impl AsRef<[u8]>,
        options: &ReadOptions,
    ) -> Result<Scan, ReadErrorKind> {
        read_scan(&Source::new(self.path(name, bytes)), options).map_err(|e| {
            assert!(e.path.ends_with(name) && e.to_string().contains(name), "{e}");
            *e.kind
        })
    }
}

fn model(text: &str) -> ReadOptions {
    ReadOptions { errors: ErrorSource::Model(text.parse().unwrap()), ..ReadOptions::default() }
}

fn kinect_camera() -> ReadOptions {
    ReadOptions { intrinsics: Some("585,585,0,0".parse().unwrap()), ..model("kinect") }
}

#[test]
fn viewpoint_is_the_place_of_the_sensor() {
    let scan = Files::new().read("a.pcd", PCD, &ReadOptions::default()).unwrap();
    assert_eq!(scan.frame(), Frame::World { sensor: Some([0.0, 0.0, 2.0]) });
    assert_eq!((scan.len(), scan.present()), (3, 2));
    assert!(matches!(scan.sigma(), Sigma::PerPoint(s) if s[..2] == [0.5, 0.25]));
}

#[test]
fn pose_from_outside_wins_over_viewpoint() {
    let pose = Pose::from_quaternion([1.0, 2.0, 3.0], [0.0, 0.0, 0.0, 1.0]).unwrap();
    let files = Files::new();
    let source = Source { pose: Some(pose), ..Source::new(files.path("a.pcd", PCD)) };
    let scan = read_scan(&source, &ReadOptions::default()).unwrap();
    assert_eq!(scan.frame(), Frame::Sensor { pose });
}

#[test]
fn sigma_of_the_file_negative() {
    let negative = PCD.replace("0.25", "-0.25");
    let error = Files::new().read("a.pcd", negative, &ReadOptions::default()).unwrap_err();
    assert!(matches!(error, ReadErrorKind::Scan(ScanError::Sigma(_))));
    assert!(error.to_string().contains("-0.25"), "{error}");
}

#[test]
fn depth_image() {
    let files = Files::new();
    let png = depth_png(2, &[1400, 0, 65535, 2400]);
    let scan = files.read("a.png", &png, &kinect_camera()).unwrap();
    assert_eq!(scan.frame(), Frame::Sensor { pose: Pose::IDENTITY });
    assert_eq!((scan.len(), scan.present()), (4, 2));
    assert_eq!(scan.points()[3], [2.4 / 585.0, 2.4 / 585.0, 2.4]);
    let sigma_z = [0, 3].map(|i| scan.sigma().of(i).unwrap()[2]);
    let expected = [1.4, 2.4].map(|z| Kinect::default().axial(z, None).unwrap());
    assert!((0..2).all(|i| (sigma_z[i] - expected[i]).abs() < 1e-15), "{sigma_z:?}");

    let error = files.read("a.png", &png, &ReadOptions::default()).unwrap_err();
    assert!(matches!(error, ReadErrorKind::NoIntrinsics));
    let options = ReadOptions { depth_scale: 0.0, ..kinect_camera() };
    let error = files.read("a.png", &png, &options).unwrap_err();
    assert!(matches!(error, ReadErrorKind::Depth(DepthError::Scale { .. })));
}

#[test]
fn content_counts_before_the_extension() {
    let files = Files::new();
    let ply = "ply\r\nformat ascii 1.0\r\nelement vertex 1\r\nproperty float x\r\nproperty float y\r\n\
        property float z\r\nend_header\r\n1 2 3\r\n";
    for (name, bytes) in [("a.txt", ply), ("a", ply), ("a.ply", PCD), ("a.bin", PCD)] {
        assert!(files.read(name, bytes, &ReadOptions::default()).unwrap().present() > 0, "{name}");
    }
}

#[test]
fn what_is_not_read_says_so() {
    let files = Files::new();
    let read = |name: &str, bytes: &[u8]| files.read(name, bytes, &ReadOptions::default()).unwrap_err();
    let bag = read("a.bag", b"#ROSBAG V2.0\n");
    assert!(matches!(bag, ReadErrorKind::Foreign { .. }) && bag.to_string().contains("PCD"), "{bag}");
    assert!(read("a.png", b"\xff\xd8\xff\xe0").to_string().contains("JPEG"));
    assert!(matches!(read("a.bin", b"hello"), ReadErrorKind::Unknown));
    assert!(matches!(read("a.ply", b""), ReadErrorKind::Empty));
    let missing = read_scan(&Source::new("no/such.ply"), &ReadOptions::default()).unwrap_err();
    assert!(matches!(*missing.kind, ReadErrorKind::Io(_)));
    let folder = read_scan(&Source::new(files.0.path()), &ReadOptions::default()).unwrap_err();
    assert!(matches!(*folder.kind, ReadErrorKind::NotAFile));
}

#[test]
fn errors_by_field_name_where_there_are_no_names() {
    let named = ErrorSource::FromFile(FieldChoice::Named("quality".into()));
    let options = ReadOptions { errors: named, ..kinect_camera() };
    let files = Files::new();
    let error = files.read("a.png", depth_png(1, &[1000]), &options).unwrap_err();
    assert!(matches!(error, ReadErrorKind::NoNamedFields { .. }));
    let error = files.read("a.pcd", PCD, &options).unwrap_err();
    assert!(error.to_string().contains("quality"), "{error}");
}

#[test]
fn broken_files_of_every_kind() {
    let files = Files::new();
    let depth = depth_png(3, &[1000; 9]);
    for (name, whole) in [("a.pcd", PCD.as_bytes()), ("a.png", &depth), ("a.xyz", b"0 0 0\n1 1 1\n")] {
        for end in 0..whole.len() {
            let _ = files.read(name, &whole[..end], &kinect_camera());
        }
    }
}

fn look(
    files: &Files,
    name: &str,
    bytes: impl AsRef<[u8]>,
    options: &ReadOptions,
) -> Result<Info, ReadError> {
    inspect(&files.path(name, bytes), options)
}

#[test]
fn info_of_a_cloud() {
    let info = look(&Files::new(), "a.pcd", PCD, &ReadOptions::default()).unwrap();
    assert_eq!((info.points, info.present, info.absent()), (3, 2, 1));
    assert_eq!(info.bounds, Some([[0.0, 0.0, -2.0], [3.0, 0.0, 0.0]]));
    assert_eq!(info.spacing, Some(13.0_f64.sqrt()));
    assert_eq!(info.sigma, Some([0.25, 0.5]));
    assert_eq!(info.viewpoint.map(|v| v.translation()), Some([0.0, 0.0, 2.0]));
    assert_eq!(info.image_size, None);
}

#[test]
fn info_of_a_depth_image() {
    let png = depth_png(2, &[1000, 0, 65535, 2000]);
    let info = look(&Files::new(), "a.png", &png, &ReadOptions::default()).unwrap();
    assert_eq!((info.points, info.present, info.image_size), (4, 2, Some([2, 2])));
    assert_eq!((info.bounds, info.spacing), (None, None));
    let info = look(&Files::new(), "a.png", &png, &kinect_camera()).unwrap();
    assert_eq!(info.bounds.map(|b| [b[0][2], b[1][2]]), Some([1.0, 2.0]));
}

#[test]
fn spacing_of_one_point_equal_points_and_a_grid() {
    let files = Files::new();
    let spacing = |text: &str| look(&files, "a.xyz", text, &ReadOptions::default()).unwrap().spacing;
    assert_eq!(spacing("1 2 3\n"), None);
    assert_eq!(spacing(&"1 2 3\n".repeat(50)), None);
    let line = |i: u32| format!("{} {} 7\n", f64::from(i % 80) * 0.5, i / 80);
    let grid = (0..80 * 80).map(line).collect::<Vec<_>>().concat();
    assert_eq!(spacing(&grid), Some(0.5));
    // Twice the same scan has the spacing of one.
    assert_eq!(spacing(&(grid.clone() + &grid)), Some(0.5));
}
