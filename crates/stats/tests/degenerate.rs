//! Sets that are empty, tiny, flat, or hold what is no number.

// These results are exact; a test has no caller to report to.
#![allow(clippy::float_cmp, clippy::unwrap_used)]

use terrace_stats::{Moments, Stats, SymmetricMatrix3, UncertainVector};

const ANCHOR: [f64; 3] = [10.0, -20.0, 30.0];

fn exact(points: &[[f64; 3]]) -> Stats {
    let mut stats = Stats::new(ANCHOR);
    for point in points {
        stats.push(&UncertainVector::exact(*point));
    }
    stats
}

#[test]
fn of_nothing_there_is_no_mean() {
    for empty in [Stats::new(ANCHOR), Stats::from_moments(ANCHOR, Moments::default())] {
        assert_eq!((empty.count(), empty.weight()), (0, 0.0));
        assert_eq!(empty.mean(), None);
        assert_eq!(empty.covariance(), None);
        assert_eq!(empty.covariance_of_mean(), None);
        assert_eq!(empty.variance_with_error(), None);
        assert_eq!(empty.expected_squared_distance(&UncertainVector::exact([0.0; 3])), None);
    }
}

#[test]
fn nothing_added_changes_nothing() {
    let mut stats = exact(&[[11.0, -20.5, 30.25], [9.0, -20.0, 31.0]]);
    let before = stats;
    stats.merge(&Stats::new([1e6; 3]));
    assert_eq!(stats, before);
    let mut empty = Stats::new(ANCHOR);
    empty.merge(&before);
    assert_eq!(empty, before);
}

#[test]
fn one_vector_has_no_scatter_but_its_error() {
    let mut one = Stats::new(ANCHOR);
    one.push(&UncertainVector { value: [11.0, -20.5, 30.25], error: [0.5, 0.25, 2.0] });
    assert_eq!(one.mean(), Some([11.0, -20.5, 30.25]));
    assert_eq!(one.covariance(), Some(SymmetricMatrix3::ZERO));
    assert_eq!(one.covariance_of_mean(), Some(SymmetricMatrix3::diagonal([0.25, 0.0625, 4.0])));
    assert_eq!(one.variance_with_error(), Some([0.25, 0.0625, 4.0]));
}

#[test]
fn duplicates_have_no_scatter() {
    // A value that is not a round number relative to the anchor.
    let stats = exact(&vec![[10.1, -20.2, 30.3]; 1000]);
    assert_eq!(stats.count(), 1000);
    let covariance = stats.covariance().unwrap();
    assert!(covariance.0.iter().all(|c| c.abs() < 1e-15), "{covariance:?}");
    assert!(covariance.diagonal_entries().iter().all(|c| *c >= 0.0));
}

#[test]
fn an_exactly_flat_set_has_no_variance_across() {
    let points: Vec<_> =
        (0..100).map(|i| [10.0 + f64::from(i % 10), -20.0 + f64::from(i / 10), 30.0]).collect();
    let covariance = exact(&points).covariance().unwrap();
    assert_eq!(covariance.get(2, 2), 0.0);
    assert_eq!([covariance.get(0, 2), covariance.get(1, 2)], [0.0; 2]);
    // Ten equidistant values: (10² − 1) / 12.
    assert!((covariance.get(0, 0) - 8.25).abs() < 1e-12 && (covariance.get(1, 1) - 8.25).abs() < 1e-12);
}

#[test]
fn a_collinear_set_varies_along_its_line_alone() {
    let points: Vec<_> = (0..10).map(|i| ANCHOR.map(|a| a + f64::from(i))).collect();
    let covariance = exact(&points).covariance().unwrap();
    let third = 1.0 / 3f64.sqrt();
    assert!((covariance.quadratic_form([third; 3]) - 3.0 * 8.25).abs() < 1e-12);
    for across in [[1.0, -1.0, 0.0], [1.0, 1.0, -2.0]] {
        assert!(covariance.quadratic_form(across).abs() < 1e-12);
    }
}

#[test]
fn a_nan_pushed_makes_its_axis_nan_and_no_other() {
    let mut stats = exact(&[[10.0, -20.0, 30.0], [11.0, -19.0, 31.0]]);
    stats.push(&UncertainVector::exact([f64::NAN, -21.0, 29.0]));
    assert_eq!(stats.count(), 3);
    let mean = stats.mean().unwrap();
    assert!(mean[0].is_nan() && mean[1] == -20.0);
    let covariance = stats.covariance().unwrap();
    assert!(covariance.get(0, 0).is_nan() && covariance.get(0, 1).is_nan() && covariance.get(0, 2).is_nan());
    assert!((covariance.get(1, 2) - 2.0 / 3.0).abs() < 1e-15);
    assert!(!covariance.is_finite());
    assert!(stats.covariance_of_mean().unwrap().get(0, 0).is_nan());
    assert!(stats.variance_with_error().unwrap()[0].is_nan());
    assert!(stats.expected_squared_distance(&UncertainVector::exact(ANCHOR)).unwrap().is_nan());
    let mut union = exact(&[ANCHOR; 4]);
    union.merge(&stats);
    assert!(union.mean().unwrap()[0].is_nan());
}

#[test]
fn a_nan_error_spoils_what_depends_on_errors() {
    let mut stats = exact(&[ANCHOR]);
    stats.push(&UncertainVector::isotropic(ANCHOR, f64::NAN));
    assert_eq!(stats.mean(), Some(ANCHOR));
    assert_eq!(stats.covariance(), Some(SymmetricMatrix3::ZERO));
    assert!(stats.variance_with_error().unwrap().iter().all(|v| v.is_nan()));
    assert!(stats.expected_squared_distance(&UncertainVector::exact(ANCHOR)).unwrap().is_nan());
}

#[test]
fn infinities_give_no_finite_answer_and_no_panic() {
    let mut stats = exact(&[ANCHOR]);
    stats.push(&UncertainVector::exact([f64::INFINITY, 0.0, 0.0]));
    assert_eq!(stats.mean().unwrap()[0], f64::INFINITY);
    assert!(stats.covariance().unwrap().get(0, 0).is_nan());
    // As large as f64 goes: squares overflow.
    let mut stats = Stats::new([0.0; 3]);
    stats.push(&UncertainVector::exact([f64::MAX; 3]));
    assert!(!stats.covariance().unwrap().is_finite());
}

#[test]
fn without_weight_there_is_no_mean() {
    for weights in [[0.0, 0.0], [1.0, -1.0], [1.0, f64::NAN]] {
        let mut stats = Stats::new(ANCHOR);
        for weight in weights {
            stats.push_weighted(&UncertainVector::isotropic([11.0; 3], 0.1), weight);
        }
        assert_eq!(stats.count(), 2);
        assert_eq!(stats.mean(), None);
        assert_eq!(stats.covariance(), None);
        assert_eq!(stats.covariance_of_mean(), None);
        assert_eq!(stats.variance_with_error(), None);
        assert_eq!(stats.expected_squared_distance(&UncertainVector::exact(ANCHOR)), None);
    }
}

#[test]
fn counts_saturate() {
    let mut stats = exact(&[[11.0, -20.0, 30.0]]);
    for _ in 0..64 {
        let same = stats;
        stats.merge(&same);
    }
    assert_eq!(stats.count(), u64::MAX);
    stats.push(&UncertainVector::exact(ANCHOR));
    assert_eq!(stats.count(), u64::MAX);
    stats.push_weighted(&UncertainVector::exact(ANCHOR), 1.0);
    assert_eq!(stats.count(), u64::MAX);
    assert_eq!(stats.mean(), Some([11.0, -20.0, 30.0]));
}

#[test]
fn what_is_a_finite_uncertain_vector() {
    let of = |value, error| UncertainVector { value: [0.0, value, 0.0], error: [0.0, 0.0, error] };
    assert!(of(1.0, 0.0).is_finite() && of(-1e300, 1e300).is_finite());
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert!(!of(bad, 0.0).is_finite() && !of(0.0, bad).is_finite());
    }
    assert!(!of(0.0, -1e-300).is_finite());
}

#[test]
#[should_panic(expected = "index out of bounds")]
fn a_matrix_has_three_rows() {
    SymmetricMatrix3::ZERO.get(3, 0);
}
