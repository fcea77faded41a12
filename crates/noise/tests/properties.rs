//! What holds for every model, sensor and point.

// A test has no caller to report to.
#![allow(clippy::unwrap_used)]

use proptest::prelude::*;
use terrace_noise::{Covariance, PointNoise, PoseNoise, ScanNoise, SensorNoise, Sight};

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn apply(rows: [[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    rows.map(|row| dot(row, v))
}

/// `R C Rᵀ`.
fn turn(rows: [[f64; 3]; 3], covariance: Covariance) -> [[f64; 3]; 3] {
    rows.map(|a| rows.map(|b| dot(a, apply(covariance.rows(), b))))
}

fn vector(size: f64) -> impl Strategy<Value = [f64; 3]> {
    prop::array::uniform3(-size..size)
}

fn unit() -> impl Strategy<Value = [f64; 3]> {
    vector(1.0).prop_filter("too short", |v| dot(*v, *v) > 0.01).prop_map(|v| v.map(|x| x / dot(v, v).sqrt()))
}

/// Rows of a rotation.
fn rotation() -> impl Strategy<Value = [[f64; 3]; 3]> {
    (unit(), unit()).prop_filter_map("nearly parallel", |(x, other)| {
        let z = cross(x, other);
        let length = dot(z, z).sqrt();
        (length > 0.1).then(|| {
            let z = z.map(|c| c / length);
            [x, cross(z, x), z]
        })
    })
}

/// Models that know no axes of the world.
fn isotropic() -> impl Strategy<Value = SensorNoise> {
    prop_oneof![
        (0.0..1.0).prop_map(|s| format!("uniform:{s}")),
        (100.0..2000.0).prop_map(|f| format!("kinect:focal={f}")),
        (1.0..500.0, 0.0..1.0, 100.0..2000.0, 0.0..2.0)
            .prop_map(|(fb, d, f, p)| format!("stereo:fb={fb},disparity={d},focal={f},pixel={p}")),
        (0.0..0.5, 0.0..0.05, 0.0..0.01)
            .prop_map(|(r, a, p)| format!("lidar:range={r},angle={a}rad,proportional={p}")),
    ]
    .prop_map(|text| text.parse().unwrap())
}

/// Any model.
fn model() -> impl Strategy<Value = SensorNoise> {
    prop_oneof![
        4 => isotropic(),
        1 => vector(1.0).prop_map(|[x, y, z]| format!("axes:{},{},{}", x.abs(), y.abs(), z.abs()).parse().unwrap()),
    ]
}

/// A sight of a point in front of a camera.
fn sight() -> impl Strategy<Value = ([f64; 3], [f64; 3], [f64; 3], [f64; 3])> {
    (vector(100.0), vector(50.0), unit(), unit())
        .prop_filter("hardly in front", |(_, lever, axis, _)| dot(*lever, *axis) > 0.1)
}

proptest! {
    #[test]
    fn covariances_are_finite_and_positive_semidefinite(
        noise in model(), (sensor, lever, axis, normal) in sight(), along in unit(),
    ) {
        let point = [0, 1, 2].map(|i| sensor[i] + lever[i]);
        let sight = Sight::new(sensor, point).unwrap();
        for sight in [sight, sight.with_axis(axis).unwrap(), sight.with_normal(normal).unwrap()] {
            let covariance = noise.covariance(&sight).unwrap();
            let m = covariance.rows();
            let trace = m[0][0] + m[1][1] + m[2][2];
            let slack = 1e-14 * trace;
            prop_assert!(trace.is_finite());
            // Before rounding is taken off by `along`.
            prop_assert!(dot(along, apply(m, along)) >= -slack);
            for i in 0..3 {
                let j = (i + 1) % 3;
                prop_assert!(m[i][i] >= 0.0);
                prop_assert!(m[i][j].powi(2) <= m[i][i] * m[j][j] + slack * trace);
            }
            prop_assert!(dot(m[0], cross(m[1], m[2])) >= -slack * trace * trace);
        }
    }

    #[test]
    fn the_ray_and_all_across_it_are_eigenvectors(
        axial in 0.0..1.0, lateral in 0.0..1.0, [ray, a, b] in rotation(), length in 1e-3..1e3,
    ) {
        let m = PointNoise { axial, lateral }.covariance(ray.map(|x| length * x)).unwrap().rows();
        for (v, sigma) in [(ray, axial), (a, lateral), (b, lateral)] {
            let image = apply(m, v);
            for i in 0..3 {
                prop_assert!((image[i] - sigma * sigma * v[i]).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn what_turns_and_moves_with_the_sensor_keeps_its_noise(
        noise in isotropic(), (sensor, lever, axis, normal) in sight(), rows in rotation(), shift in vector(100.0),
    ) {
        let covariance = |sensor: [f64; 3], lever: [f64; 3], axis, normal| {
            let point = [0, 1, 2].map(|i| sensor[i] + lever[i]);
            let scan = ScanNoise::new(noise, Some(sensor)).unwrap().with_axis(axis).unwrap();
            scan.covariance_on(point, normal)
        };
        let edge = (dot(lever, normal) / dot(lever, lever).sqrt()).abs();
        // Near an incidence of 90° the last digits of the angle decide.
        prop_assume!(edge > 0.01);
        let before = covariance(sensor, lever, axis, normal).unwrap();
        let moved = apply(rows, sensor);
        let moved = [0, 1, 2].map(|i| moved[i] + shift[i]);
        let after = covariance(moved, apply(rows, lever), apply(rows, axis), apply(rows, normal)).unwrap();
        let (expected, found) = (turn(rows, before), after.rows());
        let trace = expected[0][0] + expected[1][1] + expected[2][2];
        for i in 0..3 {
            for j in 0..3 {
                prop_assert!((expected[i][j] - found[i][j]).abs() <= 1e-9 * trace, "{expected:?} {found:?}");
            }
        }
    }

    #[test]
    fn a_pose_that_turns_with_the_world_keeps_its_noise(
        mix in prop::array::uniform6(prop::array::uniform6(-0.1..0.1)),
        rows in rotation(), lever in vector(50.0),
    ) {
        let covariance = mix.map(|a: [f64; 6]| mix.map(|b: [f64; 6]| a.iter().zip(b).map(|(x, y)| x * y).sum()));
        let local = PoseNoise::from_covariance(covariance).unwrap().at([0.0; 3], lever).unwrap();
        let turned = PoseNoise::from_sensor_frame(covariance, rows).unwrap();
        let found = turned.at([0.0; 3], apply(rows, lever)).unwrap().rows();
        let expected = turn(rows, local);
        let trace = expected[0][0] + expected[1][1] + expected[2][2];
        for i in 0..3 {
            for j in 0..3 {
                prop_assert!((expected[i][j] - found[i][j]).abs() <= 1e-12 * trace);
            }
        }
    }

    #[test]
    fn a_scan_is_its_points(noise in model(), points in prop::collection::vec(vector(20.0), 0..20)) {
        let scan = ScanNoise::new(noise, Some([1.0; 3])).unwrap();
        let all: Vec<_> = scan.covariances(points.iter().copied()).collect();
        let each: Vec<_> = points.iter().map(|p| noise.covariance(&Sight::new([1.0; 3], *p).unwrap())).collect();
        prop_assert_eq!(all, each);
    }

    #[test]
    fn a_model_is_what_its_text_reads_as(noise in model()) {
        prop_assert_eq!(noise.to_string().parse::<SensorNoise>().unwrap(), noise);
    }

    #[test]
    fn no_text_panics(text in "(uniform|axes|kinect|stereo|lidar|x)?:?[a-z=,:. 0-9eE+µ-]{0,40}") {
        if let Ok(noise) = text.parse::<SensorNoise>() {
            prop_assert_eq!(noise.to_string().parse::<SensorNoise>().unwrap(), noise);
        }
    }

    #[test]
    fn no_point_gives_nan(noise in model(), sensor in prop::array::uniform3(any::<f64>()),
        point in prop::array::uniform3(any::<f64>()), axis in prop::array::uniform3(any::<f64>()))
    {
        let sight = Sight::new(sensor, point);
        for sight in [sight, sight.and_then(|s| s.with_axis(axis)), sight.and_then(|s| s.with_normal(axis))] {
            if let Some(covariance) = sight.and_then(|sight| noise.covariance(&sight)) {
                prop_assert!(covariance.entries().iter().all(|x| x.is_finite()));
            }
        }
        if let Some(covariance) = PoseNoise::from_radians(0.1, 0.1).unwrap().at(sensor, point) {
            prop_assert!(covariance.entries().iter().all(|x| x.is_finite()));
        }
    }
}
