//! What must hold for any values.
#![allow(clippy::unwrap_used, clippy::float_cmp, reason = "tests")]

use faer::{Mat, Side, linalg::solvers::Solve};
use proptest::prelude::*;
use terrace_calibration::{
    Calibration, CalibrationError, Share, chi_squared_cdf, chi_squared_quantile, squared_mahalanobis,
};

fn values() -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(prop_oneof![4 => 0.0..12.0_f64, 1 => Just(0.0), 1 => 1e-9..1e9_f64], 0..60)
}

fn of(values: &[f64]) -> Calibration {
    let mut all = Calibration::new(3).unwrap();
    all.extend(values.iter().copied());
    all
}

/// A covariance `S (A Aᵀ + r I) S` with scales S, the parts it was made of, and an error of the same scales.
fn covariance<const D: usize>() -> impl Strategy<Value = ([f64; D], [[f64; D]; D])> {
    let entries = prop::collection::vec(-1.0..1.0_f64, D * D);
    let scales = prop::collection::vec(-8.0..4.0_f64, D);
    (entries, scales, prop::collection::vec(-3.0..3.0_f64, D), 0.01..1.0_f64).prop_map(|(a, s, e, ridge)| {
        // Scales are of variances: 1e-8 to 1e4.
        let scale: [f64; D] = std::array::from_fn(|i| 10.0_f64.powf(s[i] / 2.0));
        let product = |i: usize, j: usize| (0..D).map(|k| a[i * D + k] * a[j * D + k]).sum::<f64>();
        let matrix = std::array::from_fn(|i| {
            std::array::from_fn(|j| (product(i, j) + if i == j { ridge } else { 0.0 }) * scale[i] * scale[j])
        });
        (std::array::from_fn(|i| e[i] * scale[i]), matrix)
    })
}

/// The same by faer, after the same division by standard deviations.
fn by_faer<const D: usize>(error: [f64; D], covariance: [[f64; D]; D]) -> f64 {
    let s: [f64; D] = std::array::from_fn(|i| covariance[i][i].sqrt());
    let correlation = Mat::from_fn(D, D, |i, j| covariance[i][j] / s[i] / s[j]);
    let scaled = Mat::from_fn(D, 1, |i, _| error[i] / s[i]);
    let solved = correlation.llt(Side::Lower).unwrap().solve(&scaled);
    (0..D).map(|i| scaled[(i, 0)] * solved[(i, 0)]).sum()
}

/// `A m`.
fn times<const D: usize>(a: &[[f64; D]; D], m: &[[f64; D]; D]) -> [[f64; D]; D] {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..D).map(|k| a[i][k] * m[k][j]).sum()))
}

fn transposed<const D: usize>(m: &[[f64; D]; D]) -> [[f64; D]; D] {
    std::array::from_fn(|i| std::array::from_fn(|j| m[j][i]))
}

/// Relative difference.
fn apart(a: f64, b: f64) -> f64 {
    (a - b).abs() / a.abs().max(b.abs()).max(f64::MIN_POSITIVE)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    #[test]
    fn distances_of_three_are_those_of_faer((error, covariance) in covariance::<3>()) {
        let ours = squared_mahalanobis(error, covariance).unwrap();
        prop_assert!(apart(ours, by_faer(error, covariance)) < 1e-11);
    }

    #[test]
    fn distances_of_four_are_those_of_faer((error, covariance) in covariance::<4>()) {
        let ours = squared_mahalanobis(error, covariance).unwrap();
        prop_assert!(apart(ours, by_faer(error, covariance)) < 1e-11);
    }

    #[test]
    fn linear_maps_change_no_distance(
        (error, covariance) in covariance::<3>(),
        map in prop::array::uniform3(prop::array::uniform3(-1.0..1.0_f64)),
        units in prop::array::uniform3(-6.0..6.0_f64),
    ) {
        // To like scales first, so that the map mixes coordinates rather than drowning the small ones; diagonally
        // dominant, so that it loses none; then to other units.
        let s: [f64; 3] = std::array::from_fn(|i| covariance[i][i].sqrt());
        let a: [[f64; 3]; 3] = std::array::from_fn(|i| {
            std::array::from_fn(|j| (map[i][j] + if i == j { 4.0 } else { 0.0 }) / s[j] * 10.0_f64.powf(units[i]))
        });
        let mapped: [f64; 3] = std::array::from_fn(|i| (0..3).map(|j| a[i][j] * error[j]).sum());
        let there = times(&times(&a, &covariance), &transposed(&a));
        let (before, after) = (squared_mahalanobis(error, covariance), squared_mahalanobis(mapped, there));
        prop_assert!(apart(before.unwrap(), after.unwrap()) < 1e-9, "{before:?} {after:?}");
    }

    #[test]
    fn no_input_breaks_a_distance(error: [f64; 3], covariance: [[f64; 3]; 3]) {
        let distance = squared_mahalanobis(error, covariance);
        prop_assert!(distance.is_none_or(|d| d.is_finite() && d >= 0.0));
    }

    #[test]
    fn merging_is_taking_the_values_of_both(a in values(), b in values()) {
        let together = of(&a.iter().chain(&b).copied().collect::<Vec<_>>());
        let (mut ab, mut ba) = (of(&a), of(&b));
        ab.merge(&of(&b)).unwrap();
        ba.merge(&of(&a)).unwrap();
        prop_assert_eq!(&ab, &together);
        prop_assert_eq!(ba.quantiles(20), together.quantiles(20));
        prop_assert_eq!(ba.coverage(0.68), together.coverage(0.68));
        prop_assert_eq!(ba.median_ratio(), together.median_ratio());
        prop_assert_eq!(ba.kolmogorov_smirnov(), together.kolmogorov_smirnov());
        match (ba.nees(), together.nees()) {
            (Some(x), Some(y)) => prop_assert!(apart(x, y) < 1e-12),
            (x, y) => prop_assert_eq!(x, y),
        }
    }

    #[test]
    fn coverage_does_not_fall_with_the_level(values in values(), a in 0.001..0.999_f64, b in 0.001..0.999_f64) {
        let all = of(&values);
        if let (Some(low), Some(high)) = (all.coverage(a.min(b)), all.coverage(a.max(b))) {
            prop_assert!(low.hits() <= high.hits() && low.of() == values.len());
        } else {
            prop_assert!(values.is_empty());
        }
    }

    #[test]
    fn intervals_hold_what_they_are_of(of_all in 1_usize..5000, share in 0.0..=1.0_f64, level in 0.01..0.999_f64) {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 0 to 5000")]
        let hits = (share * of_all as f64) as usize;
        let share = Share::new(hits, of_all).unwrap();
        let [low, high] = share.interval(level).unwrap();
        prop_assert!(0.0 <= low && low <= share.value() && share.value() <= high && high <= 1.0 && low < high);
        let [wider_low, wider_high] = share.interval(f64::midpoint(level, 1.0)).unwrap();
        prop_assert!(wider_low <= low && high <= wider_high);
    }

    #[test]
    fn scaled_values_scale_what_is_told(values in prop::collection::vec(0.01..20.0_f64, 2..50), factor in 0.1..10.0_f64) {
        let (plain, scaled) = (of(&values), of(&values.iter().map(|v| v * factor).collect::<Vec<_>>()));
        prop_assert!(apart(plain.nees().unwrap() * factor, scaled.nees().unwrap()) < 1e-12);
        prop_assert!(apart(plain.median_ratio().unwrap() * factor, scaled.median_ratio().unwrap()) < 1e-12);
        prop_assert_eq!(plain.nees_band(0.9), scaled.nees_band(0.9));
    }

    #[test]
    fn points_of_the_plot_rise_and_keep_the_ends(values in values(), points in 0_usize..80) {
        let (all, shown) = (of(&values).quantiles(usize::MAX), of(&values).quantiles(points));
        prop_assert_eq!(all.len(), values.len());
        prop_assert!(shown.len() <= points);
        prop_assert!(shown.iter().all(|point| all.contains(point)));
        prop_assert!(shown.windows(2).all(|pair| pair[0][0] < pair[1][0] && pair[0][1] <= pair[1][1]));
        if points > 0 {
            prop_assert_eq!(shown.last(), all.last());
        }
        if points > 1 {
            prop_assert_eq!(shown.first(), all.first());
        }
    }

    #[test]
    fn quantiles_undo_probabilities(k in prop_oneof![Just(1.0), 0.5..20.0_f64, 20.0..1e6_f64], p in 1e-6..0.999_999_f64) {
        let x = chi_squared_quantile(k, p).unwrap();
        // The sensitivity of the probability to the last digits of x grows with the root of k.
        prop_assert!((chi_squared_cdf(k, x).unwrap() - p).abs() < 1e-9, "{k} {p} {x}");
    }

    #[test]
    fn no_input_breaks_the_distribution(k: f64, value: f64) {
        prop_assert!(chi_squared_cdf(k, value).is_none_or(|p| (0.0..=1.0).contains(&p)));
        prop_assert!(chi_squared_quantile(k, value).is_none_or(|x| x >= 0.0));
    }

    #[test]
    fn no_value_breaks_a_calibration(values: Vec<f64>, level: f64) {
        let all = of(&values);
        prop_assert_eq!(all.count() + all.refused(), values.len());
        prop_assert!(all.nees().is_none_or(f64::is_finite));
        let _ = (all.nees_band(level), all.nees_interval(level), all.coverage(level), all.quantiles(9));
        prop_assert!(all.kolmogorov_smirnov().is_none_or(|ks| (0.0..=1.0).contains(&ks.p_value)));
    }
}

#[test]
fn refusals() {
    assert_eq!(Calibration::new(0), Err(CalibrationError::DegreesOfFreedom { degrees_of_freedom: 0 }));
    let mut all = Calibration::new(3).unwrap();
    for value in [-1.0, f64::INFINITY, f64::NAN] {
        assert!(matches!(all.push(value), Err(CalibrationError::Value { .. })));
    }
    all.refuse();
    assert_eq!((all.count(), all.refused()), (0, 4));
    let before = all.clone();
    let merged = all.merge(&Calibration::new(2).unwrap());
    assert_eq!(merged, Err(CalibrationError::Merge { ours: 3, theirs: 2 }));
    assert_eq!(all, before);
}
