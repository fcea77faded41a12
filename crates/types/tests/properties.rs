//! Poses, planes and scans against algebra written out here.

// Where no arithmetic happens, values are equal; a test has no caller to report to.
#![allow(clippy::float_cmp, clippy::unwrap_used)]

use proptest::prelude::*;
use terrace_types::{Frame, Plane, Pose, Scan, Sigma};

type Matrix = [[f64; 3]; 3];

fn vector(reach: f64) -> impl Strategy<Value = [f64; 3]> {
    prop::array::uniform3(-reach..reach)
}

/// Not so short that its direction would be chance.
fn direction() -> impl Strategy<Value = [f64; 3]> {
    vector(10.0).prop_filter("too short", |v| length(*v) > 1e-3)
}

fn quaternion() -> impl Strategy<Value = [f64; 4]> {
    prop::array::uniform4(-1.0..1.0).prop_filter("too short", |q| q.iter().map(|x| x * x).sum::<f64>() > 1e-4)
}

fn pose() -> impl Strategy<Value = Pose> {
    (vector(100.0), quaternion()).prop_map(|(t, q)| Pose::from_quaternion(t, q).unwrap())
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

fn length(v: [f64; 3]) -> f64 {
    dot(v, v).sqrt()
}

fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| (a[i] - b[i]).abs()).fold(0.0, f64::max)
}

fn product(a: Matrix, b: Matrix) -> Matrix {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}

fn transpose(a: Matrix) -> Matrix {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| a[j][i]))
}

fn determinant(a: Matrix) -> f64 {
    (0..3)
        .map(|j| a[0][j] * (a[1][(j + 1) % 3] * a[2][(j + 2) % 3] - a[1][(j + 2) % 3] * a[2][(j + 1) % 3]))
        .sum()
}

fn from_identity(a: Matrix) -> f64 {
    (0..3)
        .flat_map(|i| (0..3).map(move |j| (a[i][j] - f64::from(u8::from(i == j))).abs()))
        .fold(0.0, f64::max)
}

/// The Hamilton product `p q` of quaternions `x y z w`: the rotation by `q`, then by `p`.
fn hamilton([a, b, c, d]: [f64; 4], [x, y, z, w]: [f64; 4]) -> [f64; 4] {
    [
        d * x + a * w + b * z - c * y,
        d * y - a * z + b * w + c * x,
        d * z + a * y - b * x + c * w,
        d * w - a * x - b * y - c * z,
    ]
}

proptest! {
    #[test]
    fn the_inverse_undoes_a_pose(pose in pose(), p in vector(1000.0)) {
        prop_assert!(apart(pose.inverse_transform(pose.transform(p)), p) < 1e-11);
        prop_assert!(apart(pose.transform(pose.inverse_transform(p)), p) < 1e-11);
    }

    #[test]
    fn a_pose_keeps_lengths_angles_and_handedness(pose in pose(), a in vector(1.0), b in vector(1.0)) {
        let (c, d) = (pose.rotate(a), pose.rotate(b));
        prop_assert!((dot(a, b) - dot(c, d)).abs() < 1e-14);
        prop_assert!((determinant(pose.rotation()) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_rotated_direction_is_the_difference_of_moved_points(pose in pose(), p in vector(9.0), v in vector(9.0)) {
        let moved = [0, 1, 2].map(|i| p[i] + v[i]);
        let (end, start) = (pose.transform(moved), pose.transform(p));
        prop_assert!(apart(pose.rotate(v), [0, 1, 2].map(|i| end[i] - start[i])) < 1e-12);
    }

    #[test]
    fn rotations_are_orthonormal_to_the_last_digits(
        q in quaternion(),
        noise in prop::array::uniform3(vector(1e-4)),
    ) {
        let exact = Pose::from_quaternion([0.0; 3], q).unwrap();
        prop_assert!(from_identity(product(exact.rotation(), transpose(exact.rotation()))) < 1e-12);

        // As a matrix written with four digits.
        let r = exact.rotation();
        let noisy = Pose::new([0, 1, 2].map(|i| [0, 1, 2].map(|j| r[i][j] + noise[i][j])), [0.0; 3]).unwrap();
        prop_assert!(from_identity(product(noisy.rotation(), transpose(noisy.rotation()))) < 1e-12);
        prop_assert!(from_identity(product(noisy.rotation(), transpose(r))) < 1e-3);
    }

    #[test]
    fn a_pose_made_from_its_own_matrix_is_the_same(pose in pose()) {
        let r = pose.rotation();
        let t = pose.translation();
        let rows = [0, 1, 2].map(|i| [r[i][0], r[i][1], r[i][2], t[i]]);
        let again = Pose::from_matrix([rows[0], rows[1], rows[2], [0.0, 0.0, 0.0, 1.0]]).unwrap();
        prop_assert_eq!(again.translation(), t);
        prop_assert!((0..3).all(|i| apart(again.rotation()[i], r[i]) < 1e-15));
    }

    #[test]
    fn quaternions_and_matrices_compose_alike(p in quaternion(), q in quaternion(), v in vector(10.0)) {
        let [first, second] = [q, p].map(|q| Pose::from_quaternion([0.0; 3], q).unwrap());
        let both = Pose::from_quaternion([0.0; 3], hamilton(p, q)).unwrap();
        let matrix = Pose::new(product(second.rotation(), first.rotation()), [0.0; 3]).unwrap();
        prop_assert!(apart(both.rotate(v), second.rotate(first.rotate(v))) < 1e-12);
        prop_assert!(apart(both.rotate(v), matrix.rotate(v)) < 1e-12);
    }

    #[test]
    fn a_quaternion_turns_about_its_axis(axis in direction(), angle in -3.0..3.0f64) {
        let along = axis.map(|x| x / length(axis));
        let half: f64 = angle / 2.0;
        let [x, y, z] = along.map(|x| x * half.sin());
        let pose = Pose::from_quaternion([0.0; 3], [x, y, z, half.cos()]).unwrap();
        prop_assert!(apart(pose.rotate(along), along) < 1e-14);
        let trace = (0..3).map(|i| pose.rotation()[i][i]).sum::<f64>();
        prop_assert!((trace - (1.0 + 2.0 * angle.cos())).abs() < 1e-13);
    }

    #[test]
    fn rotated_errors_are_those_of_the_rotated_covariance(pose in pose(), sigma in prop::array::uniform3(0.0..5.0)) {
        let r = pose.rotation();
        let mut variances = [[0.0; 3]; 3];
        for i in 0..3 {
            variances[i][i] = sigma[i] * sigma[i];
        }
        let covariance = product(product(r, variances), transpose(r));
        let rotated = pose.rotate_sigma(sigma);
        prop_assert!((0..3).all(|i| (rotated[i] * rotated[i] - covariance[i][i]).abs() < 1e-12));
    }

    #[test]
    fn a_plane_holds_its_point_and_its_direction(point in vector(100.0), normal in direction(), side in -9.0..9.0f64) {
        let plane = Plane::through(point, normal).unwrap();
        let n = plane.normal();
        prop_assert!((length(n) - 1.0).abs() < 1e-15);
        prop_assert!((dot(n, normal) - length(normal)).abs() < 1e-13);
        prop_assert!(plane.signed_distance(point).abs() < 1e-12);
        prop_assert!((plane.signed_distance([0, 1, 2].map(|i| point[i] + side * n[i])) - side).abs() < 1e-12);
        prop_assert_eq!(plane.coefficients(), [n[0], n[1], n[2], plane.d()]);
        prop_assert_eq!(plane.signed_distance([0.0; 3]), plane.d());
    }

    #[test]
    fn a_flipped_plane_is_the_same_plane(point in vector(100.0), normal in direction(), p in vector(100.0)) {
        let plane = Plane::through(point, normal).unwrap();
        prop_assert_eq!(plane.flipped().signed_distance(p), -plane.signed_distance(p));
        prop_assert_eq!(plane.flipped().flipped(), plane);
    }

    #[test]
    fn the_length_of_a_normal_does_not_matter(point in vector(9.0), normal in direction(), power in -290i32..290) {
        let plane = Plane::through(point, normal).unwrap();
        let scaled = Plane::through(point, normal.map(|x| x * 10f64.powi(power))).unwrap();
        prop_assert!(apart(plane.normal(), scaled.normal()) < 1e-15);
    }

    #[test]
    fn points_of_every_frame_and_error_arrive_in_the_world(
        pose in pose(),
        points in prop::collection::vec((vector(10.0), any::<bool>(), prop::array::uniform3(0.0..1.0)), 0..20),
    ) {
        let places: Vec<_> = points.iter().map(|(p, there, _)| if *there { *p } else { [p[0], f64::NAN, p[2]] }).collect();
        let sigmas = [
            Sigma::Unknown,
            Sigma::Uniform(0.25),
            Sigma::PerPoint(points.iter().map(|(_, _, s)| s[0]).collect()),
            Sigma::PerAxis(points.iter().map(|(_, _, s)| *s).collect()),
        ];
        for (kind, sigma) in sigmas.into_iter().enumerate() {
            let frames = [Frame::World { sensor: None }, Frame::World { sensor: Some([1.0; 3]) }, Frame::Sensor { pose }];
            for frame in frames {
                let scan = Scan::new(places.clone(), sigma.clone(), frame).unwrap();
                prop_assert_eq!(scan.world_points().len(), points.len());
                let positions = scan.world_points().map(|point| point.map(|point| point.position));
                prop_assert!(scan.world_positions().eq(positions));
                prop_assert_eq!(scan.present(), points.iter().filter(|(_, there, _)| *there).count());
                prop_assert_eq!(scan.sensor_position(), match frame {
                    Frame::World { sensor } => sensor,
                    Frame::Sensor { pose } => Some(pose.translation()),
                });
                for (found, (p, there, s)) in scan.world_points().zip(&points) {
                    prop_assert_eq!(found.is_some(), *there);
                    let Some(found) = found else { continue };
                    let moved = matches!(frame, Frame::Sensor { .. });
                    prop_assert_eq!(found.position, if moved { pose.transform(*p) } else { *p });
                    let expected = [None, Some([0.25; 3]), Some([s[0]; 3]), Some(*s)][kind];
                    let turned = moved && kind == 3;
                    prop_assert_eq!(found.sigma, expected.map(|s| if turned { pose.rotate_sigma(s) } else { s }));
                }
            }
        }
    }

    #[test]
    fn a_pose_given_later_is_as_one_given_first(pose in pose(), points in prop::collection::vec(vector(10.0), 0..9)) {
        let late = Scan::new(points.clone(), Sigma::Unknown, Frame::World { sensor: None }).unwrap();
        let late = late.with_sigma(Sigma::Uniform(0.5)).unwrap().with_pose(pose);
        let first = Scan::new(points, Sigma::Uniform(0.5), Frame::Sensor { pose }).unwrap();
        prop_assert_eq!(late.sensor_position(), Some(pose.translation()));
        prop_assert_eq!(late, first);
    }
}

#[test]
fn a_quarter_turn_by_hand() {
    // About z: x becomes y, y becomes -x.
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let pose = Pose::from_quaternion([10.0, 20.0, 30.0], [0.0, 0.0, half, half]).unwrap();
    assert!(apart(pose.transform([1.0, 2.0, 3.0]), [8.0, 21.0, 33.0]) < 1e-14);
    assert!(apart(pose.rotate_sigma([0.1, 0.2, 0.3]), [0.2, 0.1, 0.3]) < 1e-15);
    assert_eq!(Pose::IDENTITY.transform([1.0, 2.0, 3.0]), [1.0, 2.0, 3.0]);
}

#[test]
fn a_plane_by_hand() {
    // 2x + 3y + 6z = 49, and the normal (2, 3, 6) has length 7.
    let plane = Plane::through([2.0, 3.0, 6.0], [2.0, 3.0, 6.0]).unwrap();
    let expected = [2.0 / 7.0, 3.0 / 7.0, 6.0 / 7.0, -7.0];
    assert!(plane.coefficients().iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15));
    assert!((plane.signed_distance([0.0; 3]) + 7.0).abs() < 1e-15);
}

/// `M Mᵀ`: any covariance.
fn covariance() -> impl Strategy<Value = Matrix> {
    prop::array::uniform3(vector(0.1)).prop_map(|m| product(m, transpose(m)))
}

fn entries(m: Matrix) -> [f64; 6] {
    [m[0][0], m[0][1], m[0][2], m[1][1], m[1][2], m[2][2]]
}

proptest! {
    #[test]
    fn a_covariance_turns_with_the_pose(pose in pose(), c in covariance(), p in vector(10.0)) {
        let expected = entries(product(product(pose.rotation(), c), transpose(pose.rotation())));
        let scan = Scan::new(vec![p], Sigma::Covariance(vec![entries(c)]), Frame::Sensor { pose }).unwrap();
        let point = scan.world_point(0).unwrap();
        let (found, sigma) = (point.covariance.unwrap(), point.sigma.unwrap());
        for i in 0..6 {
            prop_assert!((found[i] - expected[i]).abs() < 1e-15);
        }
        for (sigma, variance) in sigma.into_iter().zip([found[0], found[3], found[5]]) {
            prop_assert!((sigma - variance.sqrt()).abs() < 1e-15);
        }
        let in_world = Scan::new(vec![p], scan.sigma().clone(), Frame::World { sensor: None }).unwrap();
        prop_assert_eq!(in_world.world_point(0).unwrap().covariance, Some(entries(c)));
    }

    #[test]
    fn a_covariance_is_let_in_and_one_with_a_negative_variance_is_not(c in covariance(), v in direction()) {
        prop_assert!(Sigma::is_valid_covariance(entries(c)));
        // A rank of one has determinants that are zero but for rounding.
        let ray = [0, 1, 2].map(|i| v.map(|x| v[i] * x));
        prop_assert!(Sigma::is_valid_covariance(entries(ray)));
        let below = [0, 1, 2].map(|i| [0, 1, 2].map(|j| {
            let unit = f64::from(u8::from(i == j));
            ray[i][j] - 1e-3 * dot(v, v) * unit
        }));
        prop_assert!(!Sigma::is_valid_covariance(entries(below)));
    }
}
