//! Told poses against the covariance and the convention of pose errors.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::float_cmp, reason = "tests")]

use proptest::prelude::*;
use terrace_noise::PoseNoise;
use terrace_synth::{MisplacedError, PoseOffset, misplaced};
use terrace_types::{Frame, Pose, PoseError, Scan, Sigma};

type Vec3 = [f64; 3];

fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn sub(a: Vec3, b: Vec3) -> Vec3 {
    [0, 1, 2].map(|i| a[i] - b[i])
}

fn length(a: Vec3) -> f64 {
    a.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// `exp(ω) v` as the sum of its series.
fn exponential(omega: Vec3, v: Vec3) -> Vec3 {
    let (mut sum, mut term) = (v, v);
    for k in 1..40 {
        term = cross(omega, term).map(|x| x / f64::from(k));
        sum = [0, 1, 2].map(|i| sum[i] + term[i]);
    }
    sum
}

fn any_pose() -> impl Strategy<Value = Pose> {
    (prop::array::uniform4(-1.0..1.0_f64), prop::array::uniform3(-10.0..10.0_f64))
        .prop_filter_map("a quaternion without length", |(q, t)| Pose::from_quaternion(t, q).ok())
}

/// `A Aᵀ` for a root with that many columns: 10 to 30 mm and 3 to 12 mrad, correlated.
fn noise(rank: usize) -> PoseNoise {
    let scales = [0.02, 0.01, 0.03, 0.004, 0.012, 0.003];
    let root =
        |i: usize, k: usize| if k < rank { scales[i] * (1.0 + (i * 7 + k * 5) as f64).sin() } else { 0.0 };
    let entry = |i: usize, j: usize| (0..6).map(|k| root(i, k) * root(j, k)).sum();
    let rows = [0, 1, 2, 3, 4, 5];
    PoseNoise::from_covariance(rows.map(|i| rows.map(|j| entry(i, j)))).unwrap()
}

fn truth() -> (Pose, Scan) {
    let pose = Pose::from_quaternion([2.0, -1.0, 1.5], [0.3, -0.5, 0.2, 0.7]).unwrap();
    let points = vec![[0.4, -0.2, 3.0], [-5.0, 2.0, 4.0], [0.0; 3]];
    (pose, Scan::new(points, Sigma::Uniform(0.01), Frame::Sensor { pose }).unwrap())
}

#[test]
fn moved_points_have_the_covariance_of_the_pose() {
    let (pose, scan) = truth();
    let true_points: Vec<_> = scan.world_points().map(|p| p.unwrap().position).collect();
    let n = 40_000;
    for rank in [1, 2, 4, 6] {
        let noise = noise(rank);
        let mut sums = vec![[0.0; 6]; true_points.len()];
        for stream in 0..n {
            let told = misplaced(&scan, &noise, 17, stream).unwrap();
            for ((sum, truth), told) in sums.iter_mut().zip(&true_points).zip(told.world_points()) {
                let error = sub(*truth, told.unwrap().position);
                for (entry, (i, j)) in sum.iter_mut().zip([(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)]) {
                    *entry += error[i] * error[j] / n as f64;
                }
            }
        }
        for (found, point) in sums.iter().zip(&true_points) {
            let c = noise.at(pose.translation(), *point).unwrap().rows();
            let places = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];
            let mut largest: f64 = 0.0;
            for (entry, (i, j)) in found.iter().zip(places) {
                // Four standard errors, 2.8 % of a variance, and 1 % for what is beyond first order.
                let scale = (c[i][i] * c[j][j]).sqrt();
                let standard = ((c[i][j] * c[i][j] + scale * scale) / n as f64).sqrt();
                largest = largest.max((entry - c[i][j]).abs() / scale);
                assert!((entry - c[i][j]).abs() < 4.0 * standard + 0.01 * scale, "{rank}: {found:?} {c:?}");
            }
            println!("rank {rank}: {:.2} % at most", 100.0 * largest);
        }
    }
}

#[test]
fn drawn_errors_have_the_covariance_whatever_its_rank() {
    let n = 100_000;
    for rank in [0, 1, 3, 6] {
        let noise = noise(rank);
        let c = noise.covariance();
        let mut sum = [[0.0; 6]; 6];
        for stream in 0..n {
            let PoseOffset { translation: [x, y, z], rotation: [a, b, c] } =
                PoseOffset::drawn(&noise, 3, stream);
            let e = [x, y, z, a, b, c];
            for i in 0..6 {
                for j in 0..6 {
                    sum[i][j] += e[i] * e[j] / n as f64;
                }
            }
        }
        for i in 0..6 {
            for j in 0..6 {
                let standard = ((c[i][j] * c[i][j] + c[i][i] * c[j][j]) / n as f64).sqrt();
                assert!((sum[i][j] - c[i][j]).abs() <= 4.5 * standard, "rank {rank}: {i} {j}");
            }
        }
    }
}

#[test]
fn scans_in_the_world_have_no_pose_to_tell() {
    let scan = |sensor| Scan::new(vec![[1.0; 3]], Sigma::Unknown, Frame::World { sensor }).unwrap();
    for sensor in [None, Some([1.0, 2.0, 3.0])] {
        let refused = misplaced(&scan(sensor), &noise(6), 0, 0).unwrap_err();
        assert_eq!(refused, MisplacedError::InWorld { sensor });
    }
}

#[test]
fn poses_out_of_the_range_of_numbers_are_refused() {
    let pose = Pose::new(Pose::IDENTITY.rotation(), [f64::MAX; 3]).unwrap();
    let offset = PoseOffset { translation: [f64::MAX; 3], rotation: [0.0; 3] };
    assert!(matches!(offset.truth(&pose), Err(PoseError::NotFinite { .. })));
    let spin = PoseOffset { translation: [0.0; 3], rotation: [1e300; 3] };
    assert!(spin.told(&Pose::IDENTITY).is_err());
}

proptest! {
    #[test]
    fn the_told_pose_with_the_drawn_error_is_the_true_one(
        pose in any_pose(), q in prop::array::uniform3(-20.0..20.0_f64), rank in 0..7_usize, seed: u64, stream: u64
    ) {
        let noise = noise(rank);
        let scan = Scan::new(vec![q, [f64::NAN; 3]], Sigma::Uniform(0.01), Frame::Sensor { pose }).unwrap();
        let moved = misplaced(&scan, &noise, seed, stream).unwrap();
        let PoseOffset { translation, rotation } = PoseOffset::drawn(&noise, seed, stream);
        prop_assert_eq!(moved.points()[0], q);
        prop_assert_eq!(moved.sigma(), scan.sigma());
        prop_assert_eq!(moved.present(), 1);
        let Frame::Sensor { pose: told } = moved.frame() else { return Err(TestCaseError::fail("no pose")) };
        let (truth, measured, sensor) = (pose.transform(q), told.transform(q), told.translation());

        // true = exp(δω) R q + t + δt of the told pose.
        let turned = exponential(rotation, told.rotate(q));
        let exact = [0, 1, 2].map(|i| turned[i] + sensor[i] + translation[i]);
        prop_assert!(length(sub(exact, truth)) < 1e-12, "{:?} {truth:?}", exact);
        let again = PoseOffset { translation, rotation }.truth(&told).unwrap();
        prop_assert!(length(sub(again.transform(q), truth)) < 1e-12);

        // To first order p + δt + δω × (p − s), as `PoseNoise` has it.
        let arm = sub(measured, sensor);
        let swing = cross(rotation, arm);
        let first = [0, 1, 2].map(|i| measured[i] + translation[i] + swing[i]);
        let beyond = 0.5 * length(rotation).powi(2) * length(arm);
        prop_assert!(length(sub(first, truth)) <= beyond + 1e-12);
    }

    #[test]
    fn large_errors_turn_by_the_exponential_too(
        pose in any_pose(), translation in prop::array::uniform3(-5.0..5.0_f64), rotation in prop::array::uniform3(-2.0..2.0_f64)
    ) {
        let offset = PoseOffset { translation, rotation };
        let told = offset.told(&pose).unwrap();
        for q in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] {
            let expected = exponential(rotation, told.rotate(q));
            prop_assert!(length(sub(expected, pose.rotate(q))) < 1e-12);
        }
        let back = offset.truth(&told).unwrap();
        prop_assert!(length(sub(back.translation(), pose.translation())) < 1e-14 * 20.0);
    }

    #[test]
    fn without_an_error_the_pose_stays_to_the_last_bit(pose in any_pose(), seed: u64, stream: u64) {
        let exact = PoseNoise::from_radians(0.0, 0.0).unwrap();
        let scan = Scan::new(vec![[1.0; 3]], Sigma::Unknown, Frame::Sensor { pose }).unwrap();
        prop_assert_eq!(misplaced(&scan, &exact, seed, stream).unwrap(), scan);
    }

    #[test]
    fn seed_and_stream_decide_the_error(seed: u64, stream: u64) {
        let drawn = |seed, stream| PoseOffset::drawn(&noise(6), seed, stream);
        prop_assert_eq!(drawn(seed, stream), drawn(seed, stream));
        prop_assert_ne!(drawn(seed, stream), drawn(seed, stream.wrapping_add(1)));
        prop_assert_ne!(drawn(seed, stream), drawn(seed.wrapping_add(1), stream));
    }
}
