//! Errors of points by the noise model of their sensor: which place of it counts, which axis, and which points are no
//! measurements.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::cast_possible_truncation,
    clippy::float_cmp,
    reason = "a test may fail, and compares exactly"
)]

mod common;

use common::{depth_png, write};
use proptest::prelude::*;
use terrace_io::{
    Counted, ErrorSource, ReadError, ReadErrorKind, ReadOptions, Source, read_counted, read_scan,
};
use terrace_noise::{ScanNoise, SensorNoise};
use terrace_types::{Frame, Pose, Scan, Sigma};

/// A quarter turn about z: x of the sensor is y of the world.
fn turned() -> Pose {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    Pose::from_quaternion([10.0, 20.0, 30.0], [0.0, 0.0, half, half]).unwrap()
}

fn pcd(points: &str) -> String {
    format!(
        "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH {0}\nHEIGHT 1\n\
         VIEWPOINT 0 0 2 1 0 0 0\nPOINTS {0}\nDATA ascii\n{points}",
        points.lines().count()
    )
}

fn read(name: &str, bytes: impl AsRef<[u8]>, pose: Option<Pose>, model: &str) -> Result<Counted, ReadError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    write(&path, bytes);
    let options = ReadOptions {
        intrinsics: Some("585,585,0,0".parse().unwrap()),
        errors: ErrorSource::Model(model.parse().unwrap()),
        ..ReadOptions::default()
    };
    read_counted(&Source { pose, ..Source::new(path) }, &options)
}

fn scan(name: &str, bytes: impl AsRef<[u8]>, pose: Option<Pose>, model: &str) -> Scan {
    let counted = read(name, bytes, pose, model).unwrap();
    assert_eq!(counted.not_measured, 0);
    counted.scan
}

/// Whether the covariances are those of the model with the sensor at `sensor`.
fn fits(scan: &Scan, model: &str, sensor: [f64; 3], axis: Option<[f64; 3]>) {
    let noise: SensorNoise = model.parse().unwrap();
    let mut expected = ScanNoise::new(noise, Some(sensor)).unwrap();
    if let Some(axis) = axis {
        expected = expected.with_axis(axis).unwrap();
    }
    let Sigma::Covariance(found) = scan.sigma() else { panic!("{:?}", scan.sigma()) };
    assert_eq!(found.len(), scan.len());
    for (index, point) in scan.points().iter().enumerate() {
        let entries = expected.covariance(*point).map(|c| c.entries());
        assert_eq!(scan.world_point(index).is_some(), entries.is_some(), "point {index}");
        assert!(entries.is_none_or(|entries| entries == found[index]), "point {index}");
    }
}

const MODELS: [&str; 3] =
    ["kinect", "stereo:fb=80,disparity=0.2,focal=700", "lidar:range=0.02,angle=0.1deg,proportional=0.001"];

#[test]
fn a_depth_image_is_measured_along_z_of_the_camera() {
    let png = depth_png(640, &[1400, 0, 65535, 2400].repeat(160));
    for pose in [None, Some(turned())] {
        for model in MODELS {
            let scan = scan("a.png", &png, pose, model);
            assert_eq!(scan.frame(), Frame::Sensor { pose: pose.unwrap_or(Pose::IDENTITY) });
            assert_eq!((scan.len(), scan.present()), (640, 320));
            fits(&scan, model, [0.0; 3], Some([0.0, 0.0, 1.0]));
        }
    }
}

#[test]
fn a_cloud_is_measured_from_the_viewpoint_or_from_the_origin_of_its_sensor() {
    let cloud = pcd("3 0 -2\n0 1 2\nnan nan nan\n");
    for model in MODELS {
        fits(&scan("a.pcd", &cloud, None, model), model, [0.0, 0.0, 2.0], None);
        fits(&scan("a.pcd", &cloud, Some(turned()), model), model, [0.0; 3], None);
    }
}

#[test]
fn without_a_place_of_the_sensor() {
    for model in MODELS {
        let error = read("a.xyz", "0 0 0\n1 1 1\n", None, model).unwrap_err();
        assert!(matches!(*error.kind, ReadErrorKind::NoSensorPosition { .. }));
        let (told, name) = (error.to_string(), model.split(':').next().unwrap());
        assert!(told.contains("a.xyz") && told.contains(name) && told.contains("pose"), "{told}");
    }
    let uniform = scan("a.xyz", "0 0 0\n1 1 1\n", None, "uniform:0.02");
    assert_eq!(uniform.sigma(), &Sigma::Uniform(0.02));
    let axes = scan("a.xyz", "0 0 0\n1 1 1\n", None, "axes:0.01,0.02,0.03");
    assert_eq!(axes.sigma(), &Sigma::PerAxis(vec![[0.01, 0.02, 0.03]; 2]));
}

#[test]
fn points_at_the_sensor_and_beyond_all_numbers_are_absent_and_counted() {
    for model in MODELS {
        let counted = read("a.pcd", pcd("0 0 2\n1 0 2\n3e38 0 0\nnan 0 0\n"), None, model).unwrap();
        // The lidar's error grows with the range alone: at 3e38 m its variance is a number, but none to be used.
        assert_eq!(counted.not_measured, if model.starts_with("lidar") { 1 } else { 2 }, "{model}");
        assert_eq!(counted.scan.len(), 4);
        assert!(counted.scan.world_point(0).is_none() && counted.scan.world_point(1).is_some());
    }
    // For models that do not ask for the sensor, a point at its place is as good as any.
    let counted = read("a.pcd", pcd("0 0 2\n1 0 2\n"), None, "uniform:0.01").unwrap();
    assert_eq!((counted.not_measured, counted.scan.present()), (0, 2));
}

#[test]
fn depths_beyond_those_a_model_was_made_for_stay() {
    let noise: SensorNoise = "kinect".parse().unwrap();
    assert!(!noise.valid_depths().contains(&20.0));
    assert_eq!(scan("a.png", depth_png(1, &[20_000]), None, "kinect").present(), 1);
}

#[test]
fn errors_along_the_axes_of_the_world_stay_there_under_a_pose() {
    let (model, cloud) = ("axes:0.01,0.02,0.03", "1 2 3\n4 5 6\n");
    let tilted = Pose::from_quaternion([1.0, 2.0, 3.0], [0.1, -0.2, 0.3, 0.9]).unwrap();
    for pose in [turned(), tilted] {
        let scan = scan("a.xyz", cloud, Some(pose), model);
        let world: Vec<_> = scan.world_points().map(|p| p.unwrap().covariance.unwrap()).collect();
        for (found, expected) in world.concat().iter().zip([1e-4, 0.0, 0.0, 4e-4, 0.0, 9e-4].repeat(2)) {
            assert!((found - expected).abs() < 1e-18, "{world:?}");
        }
    }
    let shifted = Pose::from_quaternion([1.0, 2.0, 3.0], [0.0, 0.0, 0.0, 1.0]).unwrap();
    for pose in [shifted, Pose::IDENTITY] {
        let scan = scan("a.xyz", cloud, Some(pose), model);
        assert_eq!(scan.sigma(), &Sigma::PerAxis(vec![[0.01, 0.02, 0.03]; 2]));
    }
}

#[test]
fn fields_of_the_file_are_not_looked_at() {
    let text = "x y z sigma\n0 0 0 -1\n";
    assert_eq!(scan("a.xyz", text, None, "uniform:0.5").sigma(), &Sigma::Uniform(0.5));
}

#[test]
fn a_scan_alone_is_the_counted_one() {
    let folder = tempfile::tempdir().unwrap();
    let source = Source::new(folder.path().join("a.pcd"));
    write(&source.path, pcd("0 0 2\n1 0 2\n"));
    let errors = ErrorSource::Model("kinect".parse().unwrap());
    let options = ReadOptions { errors, ..ReadOptions::default() };
    let (scan, counted) = (read_scan(&source, &options).unwrap(), read_counted(&source, &options).unwrap());
    assert_eq!((scan.present(), counted.not_measured, counted.scan.present()), (1, 1, 1));
}

/// Numbers of any size that stands in files.
fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![
        (-1.0..1.0_f64, -60..40_i32).prop_map(|(x, power)| x * 10.0_f64.powi(power)),
        -10.0..10.0_f64,
        Just(0.0),
        Just(f64::NAN),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn no_point_makes_a_scan_unreadable(
        points in prop::collection::vec(prop::array::uniform3(coordinate()), 1..200),
        model in prop::sample::select(&[
            "kinect",
            "stereo:fb=80,disparity=0.2,focal=700",
            "stereo:fb=80,disparity=0.2,focal=700,pixel=0",
            "stereo:fb=80,disparity=0,focal=700",
            "lidar:range=0.02,angle=0.1deg,proportional=0.001",
            "lidar:range=0,angle=1mrad",
            "lidar:range=0.02,angle=0",
            "lidar:range=0,angle=0",
            "axes:0.01,0,3",
        ][..]),
    ) {
        let text: String = points.iter().map(|p| format!("{:e} {:e} {:e}\n", p[0], p[1], p[2])).collect();
        let finite = points.iter().filter(|p| p.iter().all(|x| x.is_finite())).count();
        for pose in [turned(), Pose::from_quaternion([1.0, 2.0, 3.0], [0.1, -0.2, 0.3, 0.9]).unwrap()] {
            let counted = read("a.xyz", text.replace("NaN", "nan"), Some(pose), model).unwrap();
            prop_assert_eq!(counted.scan.len(), points.len());
            prop_assert_eq!(counted.scan.present() + counted.not_measured, finite);
        }
    }
}
