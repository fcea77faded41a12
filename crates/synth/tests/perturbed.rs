//! Noise of copies against the errors that the scans state.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

use proptest::prelude::*;
use terrace_synth::{Params, Scene, perturbed};
use terrace_types::{Frame, Pose, Scan, Sigma};

const WORLD: Frame = Frame::World { sensor: None };
const PLACE: [f64; 3] = [0.3, -1.2, 2.5];

fn bits(points: &[[f64; 3]]) -> Vec<[u64; 3]> {
    points.iter().map(|p| p.map(f64::to_bits)).collect()
}

fn rows([xx, xy, xz, yy, yz, zz]: [f64; 6]) -> [[f64; 3]; 3] {
    [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
}

/// The largest deviation of mean and covariance of `errors` from zero and `covariance`, in standard errors of each.
fn largest_deviation(errors: &[[f64; 3]], covariance: [f64; 6]) -> f64 {
    let (n, c) = (errors.len() as f64, rows(covariance));
    let mut largest: f64 = 0.0;
    for i in 0..3 {
        let mean = errors.iter().map(|e| e[i]).sum::<f64>() / n;
        if c[i][i] == 0.0 {
            assert!(errors.iter().all(|e| e[i] == 0.0), "axis {i} has no error");
            continue;
        }
        largest = largest.max(mean.abs() / (c[i][i] / n).sqrt());
        for j in 0..3 {
            if c[j][j] > 0.0 {
                let found = errors.iter().map(|e| e[i] * e[j]).sum::<f64>() / n;
                let standard = ((c[i][j] * c[i][j] + c[i][i] * c[j][j]) / n).sqrt();
                largest = largest.max((found - c[i][j]).abs() / standard);
            }
        }
    }
    largest
}

fn errors(noisy: &Scan, exact: &Scan) -> Vec<[f64; 3]> {
    noisy.points().iter().zip(exact.points()).map(|(a, b)| [0, 1, 2].map(|i| a[i] - b[i])).collect()
}

/// `Σ vᵢ vᵢᵀ`.
fn sum_of_squares(vectors: &[[f64; 3]]) -> [f64; 6] {
    let entry = |i: usize, j: usize| vectors.iter().map(|v| v[i] * v[j]).sum();
    [entry(0, 0), entry(0, 1), entry(0, 2), entry(1, 1), entry(1, 2), entry(2, 2)]
}

#[test]
fn copies_have_the_covariance_that_is_stated() {
    let n = 200_000;
    let ray = [0.002, -0.009, 0.017];
    let kinds = [
        ("uniform", Sigma::Uniform(0.01), [1e-4, 0.0, 0.0, 1e-4, 0.0, 1e-4]),
        ("per point", Sigma::PerPoint(vec![0.02; n]), [4e-4, 0.0, 0.0, 4e-4, 0.0, 4e-4]),
        ("per axis", Sigma::PerAxis(vec![[0.01, 0.0, 0.03]; n]), [1e-4, 0.0, 0.0, 0.0, 0.0, 9e-4]),
    ];
    let covariances = [
        ("rank 0", vec![]),
        ("rank 1", vec![ray]),
        ("rank 1 in a plane of the axes", vec![[0.01, 0.0, -0.02]]),
        ("rank 2", vec![ray, [0.004, 0.003, 0.0]]),
        ("rank 3", vec![ray, [0.004, 0.003, 0.0], [0.0, 1e-4, 0.002]]),
    ];
    let covariances = covariances.map(|(name, vectors)| {
        let covariance = sum_of_squares(&vectors);
        (name, Sigma::Covariance(vec![covariance; n]), covariance)
    });
    for (name, sigma, covariance) in kinds.into_iter().chain(covariances) {
        let exact = Scan::new(vec![PLACE; n], sigma, WORLD).unwrap();
        let noisy = perturbed(&exact, 41, 3);
        let deviation = largest_deviation(&errors(&noisy, &exact), covariance);
        assert!(deviation < 4.0, "{name}: {deviation}");
        println!("{name}: {deviation:.2} standard errors at most");
        assert_eq!(noisy.sigma(), exact.sigma());
    }
}

#[test]
fn one_point_has_its_covariance_from_stream_to_stream() {
    let covariance = sum_of_squares(&[[0.002, -0.009, 0.017], [0.004, 0.003, 0.0]]);
    let exact = Scan::new(vec![PLACE; 2], Sigma::Covariance(vec![covariance; 2]), WORLD).unwrap();
    let copies: Vec<_> = (0..50_000).map(|stream| errors(&perturbed(&exact, 5, stream), &exact)).collect();
    for point in 0..2 {
        let of_point: Vec<_> = copies.iter().map(|c| c[point]).collect();
        assert!(largest_deviation(&of_point, covariance) < 4.0);
    }
    // Two points of a scan, and one point in two streams that follow each other, have nothing in common.
    let alone = (covariance[0] * covariance[0] / copies.len() as f64).sqrt();
    let product = |pairs: &mut dyn Iterator<Item = (f64, f64)>| pairs.map(|(a, b)| a * b).sum::<f64>();
    let points = product(&mut copies.iter().map(|c| (c[0][0], c[1][0]))) / copies.len() as f64;
    let streams = product(&mut copies.windows(2).map(|w| (w[0][0][0], w[1][0][0]))) / copies.len() as f64;
    assert!(points.abs() < 4.0 * alone && streams.abs() < 4.0 * alone, "{points} {streams} {alone}");
}

#[test]
fn an_error_along_a_ray_moves_a_point_along_it() {
    let ray = [0.002, -0.009, 0.017];
    let sigma = Sigma::Covariance(vec![sum_of_squares(&[ray]); 1_000]);
    let exact = Scan::new(vec![[0.0; 3]; 1_000], sigma, WORLD).unwrap();
    for error in perturbed(&exact, 1, 1).points() {
        let along = error[2] / ray[2];
        assert!((0..3).all(|i| (error[i] - along * ray[i]).abs() < 1e-14), "{error:?}");
    }
}

#[test]
fn the_deviates_of_a_point_do_not_depend_on_the_kind_of_error_or_on_absent_points() {
    let [x, y, z] = [0.01, 0.02, 0.003];
    let with =
        |points: [[f64; 3]; 3], sigma| perturbed(&Scan::new(points.to_vec(), sigma, WORLD).unwrap(), 8, 2);
    let axes = with([PLACE; 3], Sigma::PerAxis(vec![[x, y, z]; 3]));
    let covariance = with([PLACE; 3], Sigma::Covariance(vec![[x * x, 0.0, 0.0, y * y, 0.0, z * z]; 3]));
    assert_eq!(axes.points(), covariance.points());
    let gaps = with([[f64::NAN; 3], PLACE, PLACE], Sigma::PerAxis(vec![[x, y, z]; 3]));
    assert_eq!(axes.points()[1..], gaps.points()[1..]);
}

#[test]
fn noise_is_not_that_of_the_scene_with_the_same_seed() {
    let params = |sigma| Params { sigma: Some(sigma), seed: 0, points: Some(50_000) };
    let exact = Scene::table().generate(&params(0.0)).unwrap().merged().scan;
    let of_scene = errors(&Scene::table().generate(&params(1.0)).unwrap().merged().scan, &exact);
    let told = exact.clone().with_sigma(Sigma::Uniform(1.0)).unwrap();
    let of_copy = errors(&perturbed(&told, 0, 0), &exact);
    let n = of_copy.len() as f64;
    let correlation = of_scene.iter().zip(&of_copy).map(|(a, b)| a[0] * b[0]).sum::<f64>() / n;
    assert!(correlation.abs() < 4.0 / n.sqrt(), "{correlation}");
}

#[test]
fn noise_out_of_the_range_of_numbers_makes_a_point_absent() {
    let exact = Scan::new(vec![[f64::MAX; 3]; 20], Sigma::Uniform(f64::MAX), WORLD).unwrap();
    let noisy = perturbed(&exact, 0, 0);
    assert_eq!(noisy.len(), 20);
    assert!(noisy.present() < 20);
}

fn any_point() -> impl Strategy<Value = [f64; 3]> {
    let number = prop_oneof![-50.0..50.0_f64, Just(0.0), Just(-0.0)];
    let absent = prop::sample::select(vec![[f64::NAN; 3], [1.0, f64::INFINITY, 2.0]]);
    prop_oneof![4 => prop::array::uniform3(number), 1 => absent]
}

fn any_sigma(points: usize) -> impl Strategy<Value = Sigma> {
    let size = prop_oneof![Just(0.0), 1e-6..1.0_f64];
    let vector = || prop::array::uniform3(-0.1..0.1_f64);
    let covariance = prop::collection::vec(vector(), 0..3).prop_map(|v| sum_of_squares(&v));
    prop_oneof![
        Just(Sigma::Unknown),
        size.clone().prop_map(Sigma::Uniform),
        prop::collection::vec(size.clone(), points).prop_map(Sigma::PerPoint),
        prop::collection::vec(prop::array::uniform3(size), points).prop_map(Sigma::PerAxis),
        prop::collection::vec(covariance, points).prop_map(Sigma::Covariance),
    ]
}

fn any_scan() -> impl Strategy<Value = Scan> {
    let frame = prop::sample::select(vec![WORLD, Frame::Sensor { pose: Pose::IDENTITY }]);
    let points = prop::collection::vec(any_point(), 1..20);
    points.prop_flat_map(|p| (any_sigma(p.len()), Just(p))).prop_flat_map(move |(sigma, points)| {
        frame.clone().prop_map(move |frame| Scan::new(points.clone(), sigma.clone(), frame).unwrap())
    })
}

proptest! {
    #[test]
    fn only_coordinates_with_an_error_move(scan in any_scan(), seed: u64, stream: u64) {
        let noisy = perturbed(&scan, seed, stream);
        prop_assert_eq!(noisy.frame(), scan.frame());
        prop_assert_eq!(noisy.sigma(), scan.sigma());
        prop_assert_eq!(noisy.present(), scan.present());
        for (index, (a, b)) in noisy.points().iter().zip(scan.points()).enumerate() {
            let absent = b.iter().any(|x| !x.is_finite());
            let sigma = scan.sigma().of(index).unwrap_or([0.0; 3]);
            for i in 0..3 {
                let stays = absent || sigma[i] == 0.0;
                prop_assert_eq!(stays, a[i].to_bits() == b[i].to_bits(), "{:?} {:?} {:?}", a, b, sigma);
            }
        }
    }

    #[test]
    fn seed_and_stream_decide_every_bit(scan in any_scan(), seed: u64, stream: u64) {
        let copy = |seed, stream| bits(perturbed(&scan, seed, stream).points());
        let here = copy(seed, stream);
        prop_assert_eq!(&here, &copy(seed, stream));
        let moved = here != bits(scan.points());
        prop_assert_eq!(moved, here != copy(seed.wrapping_add(1), stream));
        prop_assert_eq!(moved, here != copy(seed, stream.wrapping_add(1)));
        prop_assert_eq!(moved, here != copy(seed, stream ^ (1 << 63)));
    }
}
