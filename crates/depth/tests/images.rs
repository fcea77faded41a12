//! Images of known surfaces.

#![allow(clippy::unwrap_used)]

use proptest::prelude::*;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use terrace_depth::{Camera, DepthError, PlaneFinder, Settings};
use terrace_noise::{Kinect, SensorNoise};
use terrace_types::{PlaneId, Pose};

const SIZE: [usize; 2] = [320, 240];
/// Raw units per metre.
const UNITS: f64 = 10_000.0;

fn camera() -> Camera {
    Camera::new(SIZE, [290.0, 290.0], [159.5, 119.5], UNITS).unwrap()
}

fn kinect() -> SensorNoise {
    "kinect".parse().unwrap()
}

fn finder(noise: impl Into<Option<SensorNoise>>) -> PlaneFinder {
    PlaneFinder::new(camera(), noise.into(), Settings::default()).unwrap()
}

fn gauss(rng: &mut ChaCha8Rng) -> f64 {
    let (a, b): (f64, f64) = (rng.random(), rng.random());
    (-2.0 * (1.0 - a).ln()).sqrt() * (std::f64::consts::TAU * b).cos()
}

/// An image of the nearest of some planes `n · p = offset`, with the errors of a Kinect along z times `noise`.
fn image(planes: &[([f64; 3], f64)], noise: f64, rng: &mut ChaCha8Rng) -> (Vec<u16>, Vec<usize>) {
    let kinect = Kinect::default();
    (0..SIZE[0] * SIZE[1])
        .map(|at| {
            let ray = [((at % SIZE[0]) as f64 - 159.5) / 290.0, ((at / SIZE[0]) as f64 - 119.5) / 290.0, 1.0];
            let depths = planes.iter().map(|(n, offset)| offset / (0..3).map(|i| n[i] * ray[i]).sum::<f64>());
            let nearest = depths.enumerate().filter(|(_, z)| *z > 0.0).min_by(|a, b| a.1.total_cmp(&b.1));
            let Some((plane, z)) = nearest.filter(|(_, z)| *z < 6.0) else { return (0, usize::MAX) };
            let z = z + noise * kinect.axial(z, None).unwrap() * gauss(rng);
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            ((z * UNITS).round() as u16, plane)
        })
        .unzip()
}

/// A floor and two walls that meet in a corner ahead.
fn corner() -> Vec<([f64; 3], f64)> {
    let unit = |n: [f64; 3]| {
        let length = n.iter().map(|x| x * x).sum::<f64>().sqrt();
        n.map(|x| x / length)
    };
    vec![(unit([0.0, 1.0, 0.25]), 1.2), (unit([0.7, -0.05, 0.8]), 2.4), (unit([-0.8, 0.0, 0.7]), 2.2)]
}

#[test]
fn a_corner_is_three_planes_with_borders_to_the_pixel() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let (raw, truth) = image(&corner(), 1.0, &mut rng);
    for noise in [Some(kinect()), None] {
        let found = finder(noise).find(&raw).unwrap();
        assert_eq!(found.planes.len(), 3);
        let mut right = 0;
        for (label, truth) in found.labels.iter().zip(&truth) {
            let Some(plane) = label.and_then(|id| found.planes.get(id.index())) else { continue };
            let (n, offset) = corner()[*truth];
            let normal = plane.plane.normal();
            let cosine: f64 = (0..3).map(|i| n[i] * normal[i]).sum::<f64>().abs();
            right += usize::from(cosine > 0.99 && (plane.plane.d().abs() - offset).abs() < 0.05);
        }
        assert!(right as f64 > 0.98 * truth.len() as f64, "{right} of {}", truth.len());
        // The camera is in front of each.
        assert!(found.planes.iter().all(|plane| plane.plane.d() > 0.0));
    }
}

#[test]
fn errors_that_are_not_stated_are_found() {
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let (raw, _) = image(&corner(), 1.0, &mut rng);
    let (stated, found) = (finder(kinect()).find(&raw).unwrap(), finder(None).find(&raw).unwrap());
    for (a, b) in stated.planes.iter().zip(&found.planes) {
        assert!((0.7..1.3).contains(&b.reduced_chi_squared), "{}", b.reduced_chi_squared);
        assert!((a.plane.d() - b.plane.d()).abs() < 0.003);
    }
}

#[test]
fn covariances_are_those_of_errors() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    // Nearly across the axis, where errors across it do not matter: these have none.
    let truth = ([0.1, -0.05, (1.0_f64 - 0.0125).sqrt()], 2.0);
    let mut finder = finder(kinect());
    let (mut sum, mut grown) = (0.0, 0);
    let runs = 150;
    for _ in 0..runs {
        let (raw, _) = image(&[truth], 1.0, &mut rng);
        let found = finder.find(&raw).unwrap();
        let [plane] = &found.planes[..] else { panic!("{} planes", found.planes.len()) };
        let covariant = plane.covariant.unwrap();
        let side =
            if (0..3).map(|i| truth.0[i] * covariant.fit.normal[i]).sum::<f64>() < 0.0 { -1.0 } else { 1.0 };
        let n = truth.0.map(|x| side * x);
        let dot = |a: [f64; 3], b: [f64; 3]| (0..3).map(|i| a[i] * b[i]).sum::<f64>();
        let [e1, e2] = covariant.fit.axes;
        let off = [dot(e1, n), dot(e2, n), side * truth.1 - dot(n, covariant.fit.centroid)];
        // By the covariance, inverted by Cramer's rule.
        let c = covariant.tilt_offset.rows();
        let cross = |a: [f64; 3], b: [f64; 3]| {
            [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
        };
        let determinant = dot(c[0], cross(c[1], c[2]));
        let rows = [cross(c[1], c[2]), cross(c[2], c[0]), cross(c[0], c[1])];
        sum += dot(off, rows.map(|row| dot(row, off))) / determinant;
        grown += usize::from(plane.growth > 1.0);
    }
    // Three freedoms: 3 is expected, with a standard error of √(6 / runs).
    let mean = sum / f64::from(runs);
    assert!((2.3..3.6).contains(&mean), "{mean}");
    assert!(grown < 20, "{grown}");
}

#[test]
fn a_ball_is_no_plane() {
    let raw: Vec<u16> = (0..SIZE[0] * SIZE[1])
        .map(|at| {
            let [x, y] = [((at % SIZE[0]) as f64 - 159.5) / 290.0, ((at / SIZE[0]) as f64 - 119.5) / 290.0];
            // |z r − (0, 0, 1.5)| = 0.6.
            let (a, b, c) = (x * x + y * y + 1.0, -3.0, 1.5 * 1.5 - 0.36);
            let root = b * b - 4.0 * a * c;
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            if root < 0.0 { 0 } else { ((-b - root.sqrt()) / (2.0 * a) * UNITS).round() as u16 }
        })
        .collect();
    let found = finder(kinect()).find(&raw).unwrap();
    let labelled = found.labels.iter().flatten().count();
    assert!(labelled < found.points / 4, "{labelled} of {}: {:?}", found.points, found.planes);
}

#[test]
fn nothing_is_found_in_nothing_and_in_noise() {
    let mut rng = ChaCha8Rng::seed_from_u64(6);
    let noise: Vec<u16> = (0..SIZE[0] * SIZE[1]).map(|_| rng.random_range(5_000..50_000)).collect();
    let lone = |value: u16| {
        let mut raw = vec![0; SIZE[0] * SIZE[1]];
        raw[777] = value;
        raw
    };
    for raw in [vec![0; SIZE[0] * SIZE[1]], vec![u16::MAX; SIZE[0] * SIZE[1]], lone(1), lone(20_000), noise] {
        for model in [Some(kinect()), None] {
            let found = finder(model).find(&raw).unwrap();
            assert!(found.planes.is_empty(), "{:?}", found.planes);
            assert!(found.labels.iter().all(Option::is_none));
        }
    }
}

#[test]
fn a_wall_without_any_error_is_one_plane() {
    let raw = vec![15_000; SIZE[0] * SIZE[1]];
    for model in [Some(kinect()), None] {
        let found = finder(model).find(&raw).unwrap();
        assert_eq!(found.planes.len(), 1);
        assert_eq!(found.planes[0].points, raw.len() as u64);
        assert!((found.planes[0].plane.d() - 1.5).abs() < 1e-9);
        let area = raw.len() as f64 * 1.5 * 1.5 / (290.0 * 290.0);
        assert!((found.planes[0].area / area - 1.0).abs() < 1e-6);
    }
}

#[test]
fn images_of_one_pixel_and_of_odd_sizes_are_images() {
    for size in [[1, 1], [1, 300], [300, 1], [7, 9], [641, 479]] {
        let camera = Camera::new(size, [300.0, 300.0], [3.0, 3.0], 1000.0).unwrap();
        let mut finder = PlaneFinder::new(camera, None, Settings::default()).unwrap();
        let found = finder.find(&vec![2000; size[0] * size[1]]).unwrap();
        assert_eq!(found.labels.len(), size[0] * size[1]);
    }
}

#[test]
fn what_cannot_be_used_is_refused() {
    let new = |size, focal, units| Camera::new(size, focal, [0.0, 0.0], units);
    assert!(matches!(new([0, 4], [1.0, 1.0], 1.0), Err(DepthError::Size { width: 0, height: 4 })));
    assert!(matches!(new([4, 1 << 20], [1.0, 1.0], 1.0), Err(DepthError::Size { .. })));
    assert!(matches!(new([4, 4], [0.0, 1.0], 1.0), Err(DepthError::Pinhole { .. })));
    assert!(matches!(new([4, 4], [1.0, f64::NAN], 1.0), Err(DepthError::Pinhole { .. })));
    for units in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(new([4, 4], [1.0, 1.0], units), Err(DepthError::Scale { .. })));
    }
    let short = finder(None).find(&[1, 2, 3]);
    assert_eq!(short, Err(DepthError::Length { found: 3, expected: SIZE[0] * SIZE[1] }));
    let settings = Settings { reach: f64::NAN, ..Settings::default() };
    assert!(matches!(
        PlaneFinder::new(camera(), None, settings),
        Err(DepthError::Setting { name: "reach", .. })
    ));
}

#[test]
fn planes_go_with_the_camera() {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let (raw, _) = image(&corner(), 1.0, &mut rng);
    let found = finder(kinect()).find(&raw).unwrap();
    let pose = Pose::new([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], [3.0, -2.0, 0.5]).unwrap();
    for plane in &found.planes {
        let moved = plane.moved(&pose);
        assert!(moved.plane.signed_distance(pose.transform(plane.centroid)).abs() < 1e-12);
        // The camera is as far away, on the same side.
        assert!((moved.plane.signed_distance(pose.translation()) - plane.plane.d()).abs() < 1e-9);
        assert!(moved.covariant.is_some());
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn labels_are_of_measured_pixels_and_counted(seed in any::<u64>(), planes in 1..4_usize, holes in 0.0..0.3_f64) {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let (mut raw, _) = image(&corner()[..planes], rng.random_range(0.0..2.0), &mut rng);
        for raw in &mut raw {
            if rng.random_bool(holes) {
                *raw = if rng.random() { 0 } else { u16::MAX };
            }
        }
        let mut finder = finder(kinect());
        let found = finder.find(&raw).unwrap();
        let measured = |raw: &u16| *raw != 0 && *raw != u16::MAX;
        prop_assert_eq!(found.points, raw.iter().filter(|raw| measured(raw)).count());
        prop_assert!(found.labels.iter().zip(&raw).all(|(label, raw)| label.is_none() || measured(raw)));
        for (at, plane) in found.planes.iter().enumerate() {
            let id = PlaneId::from_index(at).unwrap();
            prop_assert_eq!(found.labels.iter().filter(|label| **label == Some(id)).count() as u64, plane.points);
        }
        prop_assert!(found.planes.windows(2).all(|pair| pair[0].points >= pair[1].points));
        // Memory that was used before changes nothing.
        prop_assert_eq!(&finder.find(&raw).unwrap(), &found);
    }
}
