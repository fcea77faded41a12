//! The strip and the patch.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::float_cmp, reason = "tests")]

use terrace_synth::{Params, Scene, SceneKind};
use terrace_types::Sigma;

type Vec3 = [f64; 3];

fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn exact(scene: &Scene) -> Vec<Vec3> {
    let params = Params { sigma: Some(0.0), seed: 6, ..Params::default() };
    scene.generate(&params).unwrap().merged().scan.points().to_vec()
}

fn mean(points: &[Vec3]) -> Vec3 {
    [0, 1, 2].map(|i| points.iter().map(|p| p[i]).sum::<f64>() / points.len() as f64)
}

/// The sides of the rectangle: the building is turned by yaw 0.6, pitch 0.3 and roll 0.4, and its sides were y and x.
fn sides() -> [Vec3; 2] {
    let ((sy, cy), (sp, cp), (sr, cr)) = (0.6_f64.sin_cos(), 0.3_f64.sin_cos(), 0.4_f64.sin_cos());
    [[cy * sp * sr - sy * cr, sy * sp * sr + cy * cr, cp * sr], [cy * cp, sy * cp, -sp]]
}

#[test]
fn the_points_fill_a_rectangle_of_the_size_that_is_said() {
    for (scene, size, points) in [(Scene::strip(), [0.9, 0.3], 5_000), (Scene::patch(), [0.6, 0.6], 10_000)] {
        let cloud = exact(&scene);
        assert_eq!((cloud.len(), scene.kind().default_points()), (points, points));
        let [plane] = scene.planes() else { panic!("one plane") };
        assert_eq!(plane.name, scene.kind().name());
        assert!(cloud.iter().all(|p| plane.plane.signed_distance(*p).abs() < 1e-9));
        for (side, length) in sides().into_iter().zip(size) {
            assert!(dot(side, plane.plane.normal()).abs() < 1e-12);
            let along: Vec<_> = cloud.iter().map(|p| dot(side, *p)).collect();
            let (low, high) = along.iter().fold((f64::MAX, f64::MIN), |(a, b), x| (a.min(*x), b.max(*x)));
            assert!(high - low <= length + 1e-12 && high - low > 0.99 * length, "{} of {length}", high - low);
            // Spread evenly, a quarter of the points is on each quarter of the side.
            for quarter in 0..4 {
                let place = |x: &f64| (4.0 * (x - low) / (high - low)).floor().min(3.0) == f64::from(quarter);
                let share = along.iter().filter(|x| place(x)).count() as f64 / points as f64;
                assert!((share - 0.25).abs() < 4.0 * (0.1875 / points as f64).sqrt(), "{share}");
            }
        }
    }
}

#[test]
fn the_rectangles_face_the_origin_at_a_slant_from_a_metre_and_a_half() {
    for scene in [Scene::strip(), Scene::patch()] {
        let normal = scene.planes()[0].plane.normal();
        let middle = mean(&exact(&scene));
        let distance = dot(middle, middle).sqrt();
        assert!((distance - 1.5).abs() < 0.02, "{distance}");
        let cosine = -dot(middle, normal) / distance;
        assert!((0.8..0.97).contains(&cosine), "{cosine}");
        // A camera at the origin that looks along z sees it.
        assert!(middle[2] / distance > 0.96, "{middle:?}");
        for direction in [normal, sides()[0], sides()[1]] {
            assert!(direction.iter().all(|x| (0.1..0.95).contains(&x.abs())), "{direction:?}");
        }
    }
}

#[test]
fn the_noise_of_the_patch_grows_along_its_first_side() {
    let made = |sigma| {
        Scene::patch().generate(&Params { sigma, seed: 6, ..Params::default() }).unwrap().merged().scan
    };
    let (noisy, truth) = (made(None), made(Some(0.0)));
    let Sigma::PerPoint(sigmas) = noisy.sigma() else { panic!("one error per point") };
    let along: Vec<_> = truth.points().iter().map(|p| dot(sides()[0], *p)).collect();
    let middle = dot(sides()[0], mean(truth.points()));
    let low = along.iter().copied().fold(f64::MAX, f64::min);
    assert!((middle - low - 0.3).abs() < 0.01);
    for (sigma, along) in sigmas.iter().zip(&along) {
        assert!((0.001..=0.012).contains(sigma));
        let expected = 0.001 + 0.011 * (along - low) / 0.6;
        assert!((sigma - expected).abs() < 1e-5, "{sigma} {expected}");
    }
    let (least, most) = sigmas.iter().fold((1.0_f64, 0.0_f64), |(a, b), s| (a.min(*s), b.max(*s)));
    assert!(least < 0.00101 && most > 0.01199, "{least} {most}");
    assert_eq!(made(Some(0.004)).sigma(), &Sigma::Uniform(0.004));
    assert_eq!(SceneKind::Strip.default_points(), 5_000);
    let strip = Scene::strip().generate(&Params::default()).unwrap();
    assert_eq!(strip.scans[0].scan.sigma(), &Sigma::Uniform(0.01));
}

#[test]
fn the_noise_of_the_patch_is_as_stated_along_every_axis_at_both_ends() {
    // Noise takes deviates, but places are drawn first: of the first point alone both are known.
    let mut parts = [[[0.0; 2]; 3]; 2];
    for seed in 0..20_000 {
        let made =
            |sigma| Scene::patch().generate(&Params { sigma, seed, points: Some(1) }).unwrap().merged().scan;
        let (noisy, truth) = (made(None), made(Some(0.0)));
        let sigma = noisy.sigma().of(0).unwrap()[0];
        let part = usize::from(sigma > 0.0065);
        for axis in 0..3 {
            let error = (noisy.points()[0][axis] - truth.points()[0][axis]) / sigma;
            parts[part][axis][0] += 1.0;
            parts[part][axis][1] += error * error;
        }
    }
    for [n, sum] in parts.into_iter().flatten() {
        assert!(n > 9_000.0 && (sum / n - 1.0).abs() < 4.0 * (2.0_f64 / n).sqrt(), "{n} {sum}");
    }
}
