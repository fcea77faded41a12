//! Properties of all scenes.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::float_cmp, reason = "tests")]

use proptest::prelude::*;
use terrace_synth::{MAX_POINTS, MAX_SIGMA, Params, Scene, SceneKind, SynthError, Synthetic};
use terrace_types::{Frame, PlaneId, Pose, Scan, Sigma};

fn any_kind() -> impl Strategy<Value = SceneKind> {
    prop::sample::select(SceneKind::ALL.to_vec())
}

fn any_pose(reach: f64) -> impl Strategy<Value = Pose> {
    (prop::array::uniform4(-1.0..1.0_f64), prop::array::uniform3(-reach..reach))
        .prop_filter_map("a quaternion without length", |(q, t)| Pose::from_quaternion(t, q).ok())
}

/// Largest distance of a labelled point from its plane.
fn largest_distance(made: &Synthetic) -> f64 {
    let of_scan = |scan: &Scan, labels: &[Option<PlaneId>]| {
        let labelled = scan.world_points().zip(labels).filter_map(|(p, label)| Some((p?, (*label)?)));
        labelled
            .map(|(p, id)| made.planes[id.index()].plane.signed_distance(p.position).abs())
            .fold(0.0, f64::max)
    };
    made.scans.iter().map(|s| of_scan(&s.scan, &s.labels)).fold(0.0, f64::max)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn labelled_points_without_noise_lie_on_their_planes(kind in any_kind(), points in 1..3_000_usize, seed: u64) {
        let params = Params { points: Some(points), sigma: Some(0.0), seed };
        let made = Scene::new(kind).generate(&params).unwrap();
        prop_assert!(largest_distance(&made) < 1e-9);
    }

    #[test]
    fn the_number_of_points_is_the_one_asked_for(kind in any_kind(), points in 1..2_000_usize, seed: u64) {
        let made = Scene::new(kind).generate(&Params { points: Some(points), sigma: None, seed }).unwrap();
        prop_assert_eq!(made.points(), points);
        let labelled = made.scans.iter().flat_map(|s| &s.labels).flatten().count();
        prop_assert_eq!(made.planes.iter().map(|p| p.points).sum::<usize>(), labelled);
        for scan in &made.scans {
            prop_assert!(!scan.scan.is_empty());
            prop_assert_eq!(scan.scan.present(), scan.labels.len());
        }
    }

    #[test]
    fn pieces_of_any_size_make_the_same_points(kind in any_kind(), points in 1..2_000_usize, size in 0..700_usize, seed: u64) {
        let scene = Scene::new(kind);
        let params = Params { points: Some(points), sigma: None, seed };
        let whole = scene.generate(&params).unwrap();
        let mut chunks = scene.chunks(&params, size).unwrap();
        let (mut positions, mut labels) = (Vec::new(), Vec::new());
        for chunk in chunks.by_ref() {
            prop_assert!(chunk.scan.labels.len() <= size.max(1));
            positions.extend_from_slice(chunk.scan.scan.points());
            labels.extend(chunk.scan.labels);
        }
        prop_assert_eq!(positions, whole.scans.iter().flat_map(|s| s.scan.points()).copied().collect::<Vec<_>>());
        prop_assert_eq!(labels, whole.merged().labels);
        prop_assert_eq!(chunks.planes(), whole.planes);
    }

    #[test]
    fn the_seed_decides_every_bit(kind in any_kind(), seed: u64) {
        let made = |seed| Scene::new(kind).generate(&Params { points: Some(200), sigma: None, seed }).unwrap();
        prop_assert_eq!(made(seed), made(seed));
        prop_assert_ne!(made(seed).scans, made(seed.wrapping_add(1)).scans);
    }

    #[test]
    fn a_motion_moves_the_poses_and_planes_and_no_measured_point(kind in any_kind(), pose in any_pose(1e7), again in any_pose(10.0), seed: u64) {
        let params = Params { points: Some(300), sigma: Some(0.0), seed };
        let scene = Scene::new(kind);
        let moved = scene.transformed(&again).unwrap().transformed(&pose).unwrap().generate(&params).unwrap();
        // A plane 1e7 m away is known to about 1e7 m times the rounding of its normal.
        prop_assert!(largest_distance(&moved) < 1e-7);
        let still = scene.generate(&params).unwrap();
        for (a, b) in still.scans.iter().zip(&moved.scans) {
            prop_assert_eq!(&a.labels, &b.labels);
            if matches!(a.scan.frame(), Frame::Sensor { .. }) {
                prop_assert_eq!(a.scan.points(), b.scan.points());
            }
            for (p, q) in a.scan.world_points().flatten().zip(b.scan.world_points().flatten()) {
                let expected = pose.transform(again.transform(p.position));
                prop_assert!((0..3).all(|i| (expected[i] - q.position[i]).abs() < 1e-7));
            }
        }
    }

    #[test]
    fn points_under_their_pose_are_the_merged_points(kind in any_kind(), seed: u64) {
        let made = Scene::new(kind).generate(&Params { points: Some(500), sigma: None, seed }).unwrap();
        let merged = made.merged();
        let world: Vec<_> = made.scans.iter().flat_map(|s| {
            let pose = match s.scan.frame() {
                Frame::Sensor { pose } => pose,
                Frame::World { .. } => Pose::IDENTITY,
            };
            s.scan.points().iter().map(move |p| pose.transform(*p))
        }).collect();
        prop_assert_eq!(merged.scan.points(), &world[..]);
        let sigmas: Vec<_> = made.scans.iter().flat_map(|s| s.scan.world_points()).map(|p| p.unwrap().sigma).collect();
        prop_assert_eq!(merged.scan.world_points().map(|p| p.unwrap().sigma).collect::<Vec<_>>(), sigmas);
    }

    #[test]
    fn standard_errors_out_of_range_are_refused(sigma in prop_oneof![-1e9..-1e-300, 1_000.1..1e300, Just(f64::NAN), Just(f64::INFINITY)]) {
        let refused = Scene::table().generate(&Params { sigma: Some(sigma), ..Params::default() });
        match refused {
            Err(SynthError::Sigma { value }) => prop_assert_eq!(value.to_bits(), sigma.to_bits()),
            other => prop_assert!(false, "{other:?}"),
        }
    }
}

#[test]
fn numbers_of_points_out_of_range_are_refused() {
    let asked = |points| Scene::room().generate(&Params { points: Some(points), ..Params::default() });
    assert_eq!(asked(0).unwrap_err(), SynthError::NoPoints);
    assert_eq!(asked(MAX_POINTS + 1).unwrap_err(), SynthError::TooManyPoints { points: MAX_POINTS + 1 });
    let largest = Params { points: Some(10), sigma: Some(MAX_SIGMA), ..Params::default() };
    assert_eq!(Scene::room().generate(&largest).unwrap().points(), 10);
}

#[test]
fn every_plane_is_seen_from_its_front_at_ten_thousand_points() {
    for kind in SceneKind::ALL {
        for seed in 0..5 {
            let made = Scene::sized(kind, 10_000)
                .generate(&Params { points: Some(10_000), sigma: Some(0.0), seed })
                .unwrap();
            for plane in &made.planes {
                assert!(plane.points >= 10, "{kind}: {} has {} points", plane.name, plane.points);
                let centroid = plane.centroid.unwrap();
                assert!(plane.plane.signed_distance(centroid).abs() < 1e-9);
            }
            for scan in &made.scans {
                let Some(sensor) = scan.scan.sensor_position() else { continue };
                for id in scan.labels.iter().flatten() {
                    assert!(made.planes[id.index()].plane.signed_distance(sensor) > 0.0);
                }
            }
        }
    }
}

#[test]
fn curved_things_are_labelled_as_none() {
    let room = Scene::room().generate(&Params { sigma: Some(0.0), ..Params::default() }).unwrap();
    let merged = room.merged();
    let (ball, radius) = ([2.2, 3.4, 0.32], 0.32);
    let distance = |p: &[f64; 3]| (0..3).map(|i| (p[i] - ball[i]).powi(2)).sum::<f64>().sqrt();
    let on_ball: Vec<_> = merged
        .scan
        .points()
        .iter()
        .zip(&merged.labels)
        .filter(|(p, _)| (distance(p) - radius).abs() < 1e-9)
        .collect();
    assert!(on_ball.len() > 1_000);
    assert!(on_ball.iter().all(|(_, label)| label.is_none()));
    let unlabelled = merged.labels.iter().filter(|label| label.is_none()).count() as f64;
    assert!((0.03..0.15).contains(&(unlabelled / merged.labels.len() as f64)));
}

/// Mean and variance of `values` in units of their standard errors, the values being standard normal.
fn deviations(values: &[f64]) -> [f64; 2] {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| v * v).sum::<f64>() / n;
    [mean * n.sqrt(), (variance - 1.0) * (n / 2.0).sqrt()]
}

#[test]
fn noise_of_the_table_has_the_stated_size_along_every_axis() {
    for sigma in [0.01, 0.05] {
        let made = |sigma| {
            let params = Params { sigma: Some(sigma), seed: 11, ..Params::default() };
            Scene::table().generate(&params).unwrap().merged()
        };
        let (noisy, exact) = (made(sigma), made(0.0));
        assert_eq!(noisy.scan.sigma(), &Sigma::Uniform(sigma));
        for axis in 0..3 {
            let pairs = noisy.scan.points().iter().zip(exact.scan.points());
            let errors: Vec<_> = pairs.map(|(a, b)| (a[axis] - b[axis]) / sigma).collect();
            assert!(
                deviations(&errors).iter().all(|d| d.abs() < 4.0),
                "axis {axis}: {:?}",
                deviations(&errors)
            );
        }
    }
}

#[test]
fn noise_of_sensors_lies_along_the_ray_with_the_stated_size() {
    for kind in [SceneKind::Room, SceneKind::Corridor] {
        let made =
            |sigma| Scene::new(kind).generate(&Params { sigma, seed: 5, points: Some(100_000) }).unwrap();
        let (noisy, exact) = (made(None), made(Some(0.0)));
        let mut errors = Vec::new();
        for (a, b) in noisy.scans.iter().zip(&exact.scans) {
            for ((p, q), world) in a.scan.points().iter().zip(b.scan.points()).zip(a.scan.world_points()) {
                let sigma = world.unwrap().sigma.unwrap()[0];
                let range = q.iter().map(|x| x * x).sum::<f64>().sqrt();
                let model =
                    if kind == SceneKind::Room { 0.0012 + 0.0019 * (q[2] - 0.4).powi(2) } else { 0.02 };
                assert!((sigma - model).abs() < 1e-12);
                let along = (0..3).map(|i| (p[i] - q[i]) * q[i] / range).sum::<f64>();
                let total = (0..3).map(|i| (p[i] - q[i]).powi(2)).sum::<f64>().sqrt();
                assert!((total - along.abs()).abs() < 1e-9);
                errors.push(along / sigma);
            }
        }
        assert!(deviations(&errors).iter().all(|d| d.abs() < 4.0), "{kind}: {:?}", deviations(&errors));
    }
}

#[test]
fn names_find_their_scenes() {
    for kind in SceneKind::ALL {
        assert_eq!(kind.name().parse(), Ok(kind));
        assert_eq!(Scene::new(kind).kind(), kind);
    }
    assert_eq!("attic".parse::<SceneKind>().unwrap_err().name, "attic");
}

#[test]
fn no_plane_of_the_table_is_parallel_to_an_axis() {
    for plane in Scene::table().planes() {
        assert!(plane.plane.normal().iter().all(|c| (0.1..0.95).contains(&c.abs())), "{:?}", plane.plane);
    }
}

#[test]
fn points_spread_by_area() {
    let made = Scene::table().generate(&Params::default()).unwrap();
    let total = 1.2 * 1.0 + 0.75 * 1.0 + 1.2 * 0.75;
    for (plane, area) in made.planes.iter().zip([1.2 * 1.0, 0.75 * 1.0, 1.2 * 0.75]) {
        let (n, share) = (made.points() as f64, area / total);
        let deviation = (plane.points as f64 - n * share) / (n * share * (1.0 - share)).sqrt();
        assert!(deviation.abs() < 4.0, "{}: {deviation}", plane.name);
    }
}
