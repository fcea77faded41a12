//! Errors by a model of the sensor, and errors of merged scans.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::float_cmp, reason = "tests")]

use proptest::prelude::*;
use terrace_noise::{ScanNoise, ScanNoiseError, SensorNoise};
use terrace_synth::{LabelledScan, Params, Scene, StatedError, Synthetic, perturbed, stated};
use terrace_types::{Frame, Pose, Scan, Sigma, WorldPoint};

fn exact(scene: &Scene, seed: u64) -> Synthetic {
    scene.generate(&Params { points: Some(2_000), sigma: Some(0.0), seed }).unwrap()
}

fn model(text: &str) -> SensorNoise {
    text.parse().unwrap()
}

fn with_errors(made: &Synthetic, noise: &str, axis: Option<[f64; 3]>) -> Synthetic {
    let scans = made.scans.iter().map(|s| {
        let scan = stated(&s.scan, &model(noise), axis).unwrap();
        LabelledScan { scan, labels: s.labels.clone() }
    });
    Synthetic { scans: scans.collect(), planes: made.planes.clone() }
}

fn world_points(made: &Synthetic) -> Vec<WorldPoint> {
    made.scans.iter().flat_map(|s| s.scan.world_points()).map(Option::unwrap).collect()
}

/// Whether two covariances agree to rounding of the largest variance.
fn agree(a: [f64; 6], b: [f64; 6]) -> bool {
    let largest = a[0].max(a[3]).max(a[5]);
    a.iter().zip(b).all(|(x, y)| (x - y).abs() <= 1e-14 * largest)
}

#[test]
fn scenes_know_the_axis_of_their_sensor() {
    assert_eq!(Scene::room().optical_axis(), Some([0.0, 0.0, 1.0]));
    for scene in [Scene::corridor(), Scene::table(), Scene::desk(), Scene::strip(), Scene::patch()] {
        assert_eq!(scene.optical_axis(), None);
    }
}

#[test]
fn stated_covariances_are_those_of_the_model_in_the_world() {
    let turn = Pose::from_quaternion([5.0, -3.0, 1.0], [0.4, 0.1, -0.3, 0.8]).unwrap();
    let models = [
        "kinect",
        "stereo:fb=40,disparity=0.3,focal=600",
        "lidar:range=0.02,angle=1mrad",
        "axes:0.01,0.02,0.005",
        "uniform:0.01",
    ];
    for scene in [Scene::room(), Scene::corridor().transformed(&turn).unwrap()] {
        let made = exact(&scene, 4);
        for noise in models {
            // A lidar sees behind itself, where a camera has no covariance.
            let axis = scene.optical_axis();
            let told = with_errors(&made, noise, axis);
            for scan in &told.scans {
                let Frame::Sensor { pose } = scan.scan.frame() else { panic!("no pose") };
                let mut in_world = ScanNoise::new(model(noise), Some(pose.translation())).unwrap();
                if let Some(axis) = axis {
                    in_world = in_world.with_axis(pose.rotate(axis)).unwrap();
                }
                for point in scan.scan.world_points().flatten() {
                    let expected = in_world.covariance(point.position).unwrap().entries();
                    let found = point.covariance.unwrap();
                    let largest = expected[0].max(expected[3]).max(expected[5]);
                    let close = expected.iter().zip(found).all(|(a, b)| (a - b).abs() < 1e-11 * largest);
                    assert!(close, "{noise}: {expected:?} {found:?}");
                }
            }
        }
    }
}

#[test]
fn scans_in_the_world_are_seen_from_their_sensor() {
    let place = [3.0, 4.0, 0.0];
    let scan =
        Scan::new(vec![place, [f64::NAN; 3]], Sigma::Unknown, Frame::World { sensor: Some([3.0, 0.0, 0.0]) })
            .unwrap();
    let told = stated(&scan, &model("lidar:range=0.02,angle=1mrad"), None).unwrap();
    let expected = [0.004_f64.powi(2), 0.0, 0.0, 0.02_f64.powi(2), 0.0, 0.004_f64.powi(2)];
    assert!(agree(told.sigma().covariance_of(0).unwrap(), expected));
    assert_eq!(told.sigma().covariance_of(1), Some([0.0; 6]));
}

#[test]
fn what_the_model_cannot_say_is_refused() {
    let table = exact(&Scene::table(), 0).merged().scan;
    let kinect = model("kinect");
    assert_eq!(
        stated(&table, &kinect, None),
        Err(StatedError::Noise(ScanNoiseError::SensorUnknown { noise: kinect }))
    );
    assert!(stated(&table, &model("uniform:0.01"), None).is_ok());

    let points = vec![[0.0, 0.0, 2.0], [0.1, 0.0, -2.0]];
    let scan = Scan::new(points, Sigma::Unknown, Frame::Sensor { pose: Pose::IDENTITY }).unwrap();
    let behind = stated(&scan, &kinect, Some([0.0, 0.0, 1.0])).unwrap_err();
    assert_eq!(behind, StatedError::NoCovariance { noise: kinect, point: 1, position: [0.1, 0.0, -2.0] });
    let axis = [0.0; 3];
    assert_eq!(stated(&scan, &kinect, Some(axis)), Err(ScanNoiseError::NoAxis { axis }.into()));
}

#[test]
fn merged_scans_keep_their_covariances() {
    // Noise along the ray alone has a covariance of rank 1, whose variances may round below zero when turned.
    for (scene, noise) in [
        (Scene::room(), "kinect"),
        (Scene::room(), "lidar:range=0.02,angle=0"),
        (Scene::corridor(), "lidar:range=0.02,angle=0.1deg"),
        (Scene::corridor(), "lidar:range=0.02,angle=0"),
    ] {
        let made = with_errors(&exact(&scene, 2), noise, scene.optical_axis());
        let merged = made.merged();
        assert!(matches!(merged.scan.sigma(), Sigma::Covariance(_)));
        for (a, b) in merged.scan.world_points().zip(world_points(&made)) {
            assert_eq!(a.unwrap().position, b.position);
            assert!(agree(a.unwrap().covariance.unwrap(), b.covariance.unwrap()));
        }
        assert_eq!(perturbed(&merged.scan, 0, 0).present(), made.points());
    }
}

#[test]
fn merged_scans_say_what_all_of_them_know() {
    let pose = Pose::from_quaternion([1.0, 2.0, 3.0], [0.4, 0.1, -0.3, 0.8]).unwrap();
    let scan = |sigma| {
        let points = vec![[1.0, 2.0, 3.0], [f64::NAN; 3]];
        LabelledScan {
            scan: Scan::new(points, sigma, Frame::Sensor { pose }).unwrap(),
            labels: vec![None; 2],
        }
    };
    let merged = |sigmas: &[Sigma]| {
        let scans = sigmas.iter().cloned().map(scan).collect();
        Synthetic { scans, planes: Vec::new() }.merged().scan.sigma().clone()
    };
    let (equal, axes) = (Sigma::Uniform(0.5), [0.1, 0.2, 0.3]);
    let covariance = [0.04, 0.01, 0.0, 0.09, 0.0, 0.01];
    let (per_axis, correlated) = (Sigma::PerAxis(vec![axes; 2]), Sigma::Covariance(vec![covariance; 2]));
    let (none, turned) = ([0.0; 3], pose.rotate_sigma(axes));
    assert_eq!(
        merged(&[equal.clone(), Sigma::PerPoint(vec![0.25; 2])]),
        Sigma::PerPoint(vec![0.5, 0.0, 0.25, 0.0])
    );
    assert_eq!(merged(&[equal.clone(), per_axis]), Sigma::PerAxis(vec![[0.5; 3], none, turned, none]));
    assert_eq!(
        merged(&[equal.clone(), correlated.clone()]),
        Sigma::Covariance(vec![
            [0.25, 0.0, 0.0, 0.25, 0.0, 0.25],
            [0.0; 6],
            pose.rotate_covariance(covariance),
            [0.0; 6]
        ])
    );
    assert_eq!(merged(&[equal, Sigma::Unknown, correlated]), Sigma::Unknown);
}

proptest! {
    // Under any rotation, also where rounding makes a turned variance negative.
    #[test]
    fn covariances_of_any_rank_merge(
        quaternion in prop::array::uniform4(-1.0..1.0_f64),
        vectors in prop::collection::vec(prop::array::uniform3(prop_oneof![Just(0.0), Just(1e-9), -0.1..0.1_f64]), 0..3)
    ) {
        let Ok(pose) = Pose::from_quaternion([0.0; 3], quaternion) else { return Ok(()) };
        let entry = |i: usize, j: usize| vectors.iter().map(|v| v[i] * v[j]).sum::<f64>();
        let covariance = [entry(0, 0), entry(0, 1), entry(0, 2), entry(1, 1), entry(1, 2), entry(2, 2)];
        // The second scan has the axes of the first turned back, so that one variance stays and others vanish.
        for (sigma, pose) in [(covariance, pose), (pose.rotate_covariance([0.0, 0.0, 0.0, 0.0, 0.0, 4e-4]), transposed(&pose))] {
            let Ok(scan) = Scan::new(vec![[1.0; 3]], Sigma::Covariance(vec![sigma]), Frame::Sensor { pose }) else { continue };
            let world = scan.world_point(0).unwrap().covariance.unwrap();
            let scans = vec![LabelledScan { scan, labels: vec![None] }];
            let merged = Synthetic { scans, planes: Vec::new() }.merged().scan;
            let found = merged.sigma().covariance_of(0).unwrap();
            prop_assert!(agree(found, world), "{found:?} {world:?}");
            prop_assert!(Sigma::is_valid_covariance(found));
        }
    }
}

fn transposed(pose: &Pose) -> Pose {
    let r = pose.rotation();
    Pose::new([0, 1, 2].map(|j| [r[0][j], r[1][j], r[2][j]]), [0.0; 3]).unwrap()
}
