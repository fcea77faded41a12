//! Weighting by information.

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use terrace::{InsertError, Mapper, Params, Scan, Sigma, Weighting};

use crate::common::{angle, cloud, gauss, map, rough, tenth, unknown};

fn by_information() -> Params {
    Params { weighting: Weighting::Information, ..tenth(Params::default) }
}

#[test]
fn points_without_a_usable_sigma_are_refused_and_the_map_is_as_it_was() {
    let points = rough(0.05);
    let mut mapper = Mapper::new(by_information()).unwrap();
    mapper.insert(&cloud(points.clone(), Sigma::Uniform(0.01))).unwrap();
    let before = mapper.extract().unwrap();
    let with = |index: usize, value: f64| {
        let mut sigmas = vec![0.01; points.len()];
        sigmas[index] = value;
        cloud(points.clone(), Sigma::PerPoint(sigmas))
    };
    let mut axes = vec![[0.01; 3]; points.len()];
    axes[4] = [0.01, 0.0, 0.01];
    let refused: [(Scan, usize); 6] = [
        (unknown(&points), 0),
        (cloud(points.clone(), Sigma::Uniform(0.0)), 0),
        (with(7, 0.0), 7),
        // Their squares are no numbers to divide by.
        (with(8, 1e-200), 8),
        (with(9, 1e200), 9),
        (cloud(points.clone(), Sigma::PerAxis(axes)), 4),
    ];
    for (scan, point) in refused {
        assert_eq!(mapper.insert(&scan), Err(InsertError::NoWeight { point }));
        assert_eq!(mapper.extract().unwrap(), before);
    }
}

#[test]
fn absent_points_need_no_sigma() {
    let mut points = rough(0.05);
    let mut sigmas = vec![0.01; points.len()];
    points[3] = [f64::NAN; 3];
    sigmas[3] = 0.0;
    let scan = cloud(points, Sigma::PerPoint(sigmas));
    let inserted = Mapper::new(by_information()).unwrap().insert(&scan).unwrap();
    assert_eq!((inserted.points, inserted.absent), (9_999, 1));
}

#[test]
fn equal_weights_change_nothing_but_roundings() {
    let scan = cloud(rough(0.05), Sigma::Uniform(0.003));
    let (uniform, weighted) = (map(tenth(Params::clusters), &[&scan]), map(by_information(), &[&scan]));
    assert_eq!(uniform.labels, weighted.labels);
    let (a, b) = (&uniform.planes[0], &weighted.planes[0]);
    assert_eq!(a.points, b.points);
    assert!(angle(a.plane.normal(), b.plane.normal()) < 1e-9 && (a.rms - b.rms).abs() < 1e-9);
    assert!(
        (0..3).all(|i| (a.normal_uncertainty.unwrap()[i] - b.normal_uncertainty.unwrap()[i]).abs() < 1e-9)
    );
}

#[test]
fn with_errors_of_many_sizes_information_halves_the_error_of_the_normal() {
    // Standard errors from 1 to 12 mm on one square metre, forty times: for 1/σ² spread so, theory gives a variance
    // of about 1/[mean σ² · mean σ⁻²] = 1/4.3 of the uniform one.
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    let (mut uniform, mut weighted) = (0.0, 0.0);
    for _ in 0..40 {
        let (mut points, mut sigmas) = (Vec::new(), Vec::new());
        for _ in 0..2_000 {
            let sigma = rng.random_range(0.001..0.012);
            points.push([rng.random(), rng.random(), 0.05 + sigma * gauss(&mut rng)]);
            sigmas.push(sigma);
        }
        let scan = cloud(points, Sigma::PerPoint(sigmas));
        let off = |params| {
            let found = map(params, &[&scan]);
            assert_eq!(found.planes.len(), 1);
            angle(found.planes[0].plane.normal(), [0.0, 0.0, 1.0]).powi(2)
        };
        uniform += off(tenth(Params::clusters));
        weighted += off(by_information());
    }
    let ratio = (weighted / uniform).sqrt();
    assert!((0.3..0.65).contains(&ratio), "{ratio}");
}
