//! Against tabulated values and against simulated errors.
#![allow(clippy::unwrap_used, clippy::float_cmp, reason = "tests")]

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use terrace_calibration::{
    Calibration, LEVELS, Summary, chi_squared_cdf, chi_squared_quantile, squared_mahalanobis, table,
};

/// χ² quantiles at these probabilities by 40-digit arithmetic (mpmath).
const PROBABILITIES: [f64; 5] = [1e-6, 0.025, 0.5, 0.95, 0.999_99];
#[expect(clippy::unreadable_literal, clippy::excessive_precision, reason = "a table")]
const QUANTILES: [(f64, [f64; 5]); 7] = [
    (
        1.0,
        [
            1.5707963267957191e-12,
            0.00098206911717525591,
            0.45493642311957275,
            3.841458820694126,
            19.511420964657573,
        ],
    ),
    (
        2.0,
        [
            2.0000010000006667e-6,
            0.050635615968579751,
            1.3862943611198906,
            5.991464547107982,
            23.025850929940457,
        ],
    ),
    (
        3.0,
        [
            0.00024181048720124283,
            0.21579528262389787,
            2.3659738843753383,
            7.81472790325118,
            25.901749745662051,
        ],
    ),
    (
        4.0,
        [
            0.0028297613229586858,
            0.48441855708792981,
            3.3566939800333213,
            9.4877290367811568,
            28.473255424006033,
        ],
    ),
    (
        6.0,
        [0.036508565926558585, 1.2373442457912026, 5.3481206274471206, 12.591587243743979, 33.107056816829],
    ),
    (
        100.0,
        [46.501330715893183, 74.221927474923726, 99.334129235988456, 124.34211340400408, 172.09894203613807],
    ),
    (
        6000.0,
        [5493.6085688589491, 5787.197241969327, 5999.3333465036602, 6181.3145309252227, 6478.7024122376523],
    ),
];

#[test]
fn quantiles_are_those_of_the_tables() {
    let mut worst: f64 = 0.0;
    for (k, quantiles) in QUANTILES {
        for (p, expected) in PROBABILITIES.into_iter().zip(quantiles) {
            let x = chi_squared_quantile(k, p).unwrap();
            worst = worst.max((x / expected - 1.0).abs());
            assert!((x / expected - 1.0).abs() < 1e-12, "{k} {p}: {x}, not {expected}");
            assert!((chi_squared_cdf(k, expected).unwrap() - p).abs() < 1e-11, "{k} {p}");
        }
    }
    println!("worst relative error of a quantile: {worst:e}");
}

#[test]
fn millions_of_degrees_of_freedom_are_nearly_normal() {
    for k in [1e6, 9.999e6, 1.001e7, 1e9_f64] {
        let z = (chi_squared_quantile(k, 0.975).unwrap() - k) / (2.0 * k).sqrt();
        // Cornish and Fisher: skewness adds √8 (z² − 1) / (6 √k).
        let expected = 1.959_963_985 + 8_f64.sqrt() * 2.841_458_8 / (6.0 * k.sqrt());
        assert!((z - expected).abs() < 1e-5, "{k} {z} {expected}");
    }
}

#[test]
fn what_is_no_probability_has_no_quantile() {
    for (k, p) in [
        (3.0, 0.0),
        (3.0, 1.0),
        (3.0, f64::NAN),
        (0.0, 0.5),
        (-1.0, 0.5),
        (f64::INFINITY, 0.5),
        (f64::NAN, 0.5),
    ] {
        assert_eq!(chi_squared_quantile(k, p), None);
    }
    assert_eq!(chi_squared_cdf(3.0, f64::INFINITY), Some(1.0));
    assert_eq!(chi_squared_cdf(3.0, -1.0), Some(0.0));
    assert_eq!(chi_squared_cdf(3.0, f64::NAN), None);
}

fn normal(rng: &mut ChaCha8Rng) -> f64 {
    let (radius, turn): (f64, f64) = (1.0 - rng.random::<f64>(), rng.random());
    (-2.0 * radius.ln()).sqrt() * (std::f64::consts::TAU * turn).cos()
}

/// Errors `L z` with standard normal z and the covariance `L Lᵀ` times `inflated`, another L for each.
fn simulated<const D: usize>(n: usize, inflated: f64, seed: u64) -> Calibration {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut all = Calibration::new(u32::try_from(D).unwrap()).unwrap();
    for _ in 0..n {
        // A triangle with scales from 1e-4 to 100, as of tilts and offsets.
        let scale: [f64; D] = std::array::from_fn(|_| 10_f64.powf(rng.random_range(-4.0..2.0)));
        let l: [[f64; D]; D] = std::array::from_fn(|i| {
            std::array::from_fn(|j| match i.cmp(&j) {
                std::cmp::Ordering::Less => 0.0,
                std::cmp::Ordering::Equal => scale[i],
                std::cmp::Ordering::Greater => rng.random_range(-1.0..1.0) * scale[i],
            })
        });
        let z: [f64; D] = std::array::from_fn(|_| normal(&mut rng));
        let error = l.map(|row| row.iter().zip(&z).map(|(a, b)| a * b).sum());
        let covariance = std::array::from_fn(|i| {
            std::array::from_fn(|j| l[i].iter().zip(&l[j]).map(|(a, b)| a * b).sum::<f64>() * inflated)
        });
        all.push(squared_mahalanobis(error, covariance).unwrap()).unwrap();
    }
    all
}

fn inside([low, high]: [f64; 2], value: f64) -> bool {
    low <= value && value <= high
}

#[test]
fn honest_covariances_are_found_honest() {
    for all in
        [simulated::<1>(20_000, 1.0, 1), simulated::<3>(20_000, 1.0, 2), simulated::<4>(20_000, 1.0, 3)]
    {
        let nees = all.nees().unwrap();
        assert!(inside(all.nees_band(0.99).unwrap(), nees), "{}", Summary::new("honest", &all));
        assert!(inside(all.nees_interval(0.99).unwrap(), 1.0));
        for level in LEVELS {
            assert!(inside(all.coverage(level).unwrap().interval(0.99).unwrap(), level), "{level}");
        }
        assert!((all.median_ratio().unwrap() - 1.0).abs() < 0.04);
        let test = all.kolmogorov_smirnov().unwrap();
        assert!(test.statistic < 0.015 && test.p_value > 0.01, "{test:?}");
        for [expected, observed] in all.quantiles(100) {
            assert!((expected - observed).abs() < 0.05 || expected > 2.5, "{expected} {observed}");
        }
    }
}

#[test]
fn bands_hold_as_often_as_they_claim() {
    // 400 runs of 50 errors: NEES in its 90 % band, coverage in its 90 % interval, p-values below 0.1.
    let runs: Vec<Calibration> = (0..400).map(|seed| simulated::<3>(50, 1.0, 1000 + seed)).collect();
    let often = |hit: &dyn Fn(&Calibration) -> bool| runs.iter().filter(|all| hit(all)).count();
    let band = often(&|all| inside(all.nees_band(0.9).unwrap(), all.nees().unwrap()));
    let wilson = often(&|all| inside(all.coverage(0.68).unwrap().interval(0.9).unwrap(), 0.68));
    let scatter = often(&|all| inside(all.nees_interval(0.9).unwrap(), 1.0));
    let rejected = often(&|all| all.kolmogorov_smirnov().unwrap().p_value < 0.1);
    println!("of 400: band {band}, Wilson {wilson}, scatter {scatter}, rejected {rejected}");
    // Three standard deviations of the binomial are 18; shares of 50 come in steps.
    assert!((342..=378).contains(&band), "{band}");
    assert!((335..=385).contains(&wilson), "{wilson}");
    assert!((332..=378).contains(&scatter), "{scatter}");
    assert!((22..=58).contains(&rejected), "{rejected}");
}

#[test]
fn doubled_covariances_give_half() {
    let all = simulated::<3>(20_000, 2.0, 4);
    assert!((all.nees().unwrap() - 0.5).abs() < 0.02 && (all.median_ratio().unwrap() - 0.5).abs() < 0.02);
    assert!(all.nees_band(0.99).unwrap()[0] > 0.9);
    assert!(all.coverage(0.68).unwrap().interval(0.99).unwrap()[0] > 0.8);
    assert!(all.kolmogorov_smirnov().unwrap().p_value < 1e-12);
}

#[test]
fn of_nothing_nothing_is_told() {
    let empty = Calibration::new(3).unwrap();
    assert_eq!((empty.count(), empty.nees(), empty.median_ratio()), (0, None, None));
    assert_eq!((empty.nees_band(0.95), empty.nees_interval(0.95), empty.coverage(0.95)), (None, None, None));
    assert!(empty.quantiles(10).is_empty() && empty.kolmogorov_smirnov().is_none());
    assert_eq!(
        Summary::new("none", &empty).to_string(),
        "none: n 0, NEES/D -, within 50 % -, 68 % -, 95 % -, 99 % -"
    );
    assert_eq!(table(&[("none", &empty)]).lines().count(), 2);
}

#[test]
fn one_value() {
    let mut one = Calibration::new(2).unwrap();
    one.push(4.0).unwrap();
    assert_eq!((one.nees(), one.nees_interval(0.95)), (Some(2.0), None));
    // χ² with two degrees of freedom is exponential: quantiles are −2 ln(1 − p).
    let [low, high] = one.nees_band(0.95).unwrap();
    assert!((low + 0.975_f64.ln()).abs() < 1e-12 && (high + 0.025_f64.ln()).abs() < 1e-12);
    assert_eq!(one.quantiles(5).len(), 1);
    assert!(
        (one.quantiles(5)[0][0] - (2.0 * 2_f64.ln()).sqrt()).abs() < 1e-12 && one.quantiles(5)[0][1] == 2.0
    );
    assert!((one.median_ratio().unwrap() - 4.0 / (2.0 * 2_f64.ln())).abs() < 1e-12);
    assert!((one.kolmogorov_smirnov().unwrap().statistic - (1.0 - (-2_f64).exp())).abs() < 1e-12);
    for level in [0.0, 1.0, f64::NAN] {
        assert_eq!((one.nees_band(level), one.coverage(level)), (None, None));
    }
}

#[test]
fn tables_are_aligned_whatever_the_names() {
    let all = simulated::<3>(100, 1e-9, 5);
    let text = table(&[("a", &all), ("a much longer name, Ω", &all), ("", &Calibration::new(1).unwrap())]);
    let widths: Vec<usize> = text.lines().map(|line| line.chars().count()).collect();
    assert!(widths.len() == 4 && widths.iter().all(|width| *width == widths[0]), "{text}");
}
