//! Sums against computations from the raw vectors, in any order and grouping.

// Exact where no rounding can happen; a test has no caller to report to.
#![allow(clippy::float_cmp, clippy::unwrap_used)]

use proptest::prelude::*;
use terrace_stats::{Moments, Stats, SymmetricMatrix3, UncertainVector};

/// Rounding allowed in a mean, per unit of the largest distance from the anchor; in a covariance, per its square.
const ROUNDING: f64 = 1e-14;

fn vector(reach: f64) -> impl Strategy<Value = [f64; 3]> {
    prop::array::uniform3(-reach..reach)
}

fn uncertain() -> impl Strategy<Value = UncertainVector> {
    (vector(1.0), prop::array::uniform3(0.0..0.5)).prop_map(|(value, error)| UncertainVector { value, error })
}

fn set(most: usize) -> impl Strategy<Value = Vec<UncertainVector>> {
    prop::collection::vec(uncertain(), 1..most)
}

fn stats(anchor: [f64; 3], vectors: &[UncertainVector]) -> Stats {
    let mut stats = Stats::new(anchor);
    for v in vectors {
        stats.push(v);
    }
    stats
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| a[i] - b[i])
}

/// Largest distance of the vectors from the anchors: what rounding is measured by.
fn reach(anchors: &[[f64; 3]], vectors: &[UncertainVector]) -> f64 {
    let squared = |a: &[f64; 3], v: &UncertainVector| dot(minus(v.value, *a), minus(v.value, *a));
    anchors.iter().flat_map(|a| vectors.iter().map(move |v| squared(a, v))).fold(0.0, f64::max).sqrt()
}

/// Mean and covariance in two passes over the vectors.
fn two_passes(vectors: &[UncertainVector], weights: &[f64]) -> ([f64; 3], SymmetricMatrix3) {
    let total: f64 = weights.iter().sum();
    let both = || vectors.iter().zip(weights);
    let mean = [0, 1, 2].map(|i| both().map(|(v, w)| w * v.value[i]).sum::<f64>() / total);
    let pair = |i: usize, j: usize| {
        both().map(|(v, w)| w * (v.value[i] - mean[i]) * (v.value[j] - mean[j])).sum::<f64>() / total
    };
    (mean, SymmetricMatrix3([pair(0, 0), pair(0, 1), pair(0, 2), pair(1, 1), pair(1, 2), pair(2, 2)]))
}

fn same_vector(a: [f64; 3], b: [f64; 3], tolerance: f64) -> bool {
    (0..3).all(|i| (a[i] - b[i]).abs() <= tolerance)
}

fn same_matrix(a: SymmetricMatrix3, b: SymmetricMatrix3, tolerance: f64) -> bool {
    (0..6).all(|i| (a.0[i] - b.0[i]).abs() <= tolerance)
}

/// Whether two statistics, of any anchors, answer alike. `r` is the distance that rounding is measured by.
fn alike(a: &Stats, b: &Stats, r: f64) -> Result<(), TestCaseError> {
    let squared = ROUNDING * r * r;
    prop_assert_eq!(a.count(), b.count());
    prop_assert!((a.weight() - b.weight()).abs() <= ROUNDING * a.weight());
    prop_assert!(same_vector(a.mean().unwrap(), b.mean().unwrap(), ROUNDING * r));
    prop_assert!(same_matrix(a.covariance().unwrap(), b.covariance().unwrap(), squared));
    prop_assert!(same_matrix(a.covariance_of_mean().unwrap(), b.covariance_of_mean().unwrap(), squared));
    prop_assert!(same_vector(a.variance_with_error().unwrap(), b.variance_with_error().unwrap(), squared));
    Ok(())
}

proptest! {
    #[test]
    fn sums_equal_two_passes(set in set(300), anchor in vector(1.0), weights in prop::collection::vec(0.1..9.0, 300)) {
        let r = reach(&[anchor], &set);
        let ones = vec![1.0; set.len()];
        let (mean, covariance) = two_passes(&set, &ones);
        let unweighted = stats(anchor, &set);
        prop_assert_eq!(unweighted.count(), set.len() as u64);
        prop_assert_eq!(unweighted.weight(), set.len() as f64);
        prop_assert!(same_vector(unweighted.mean().unwrap(), mean, ROUNDING * r));
        prop_assert!(same_matrix(unweighted.covariance().unwrap(), covariance, ROUNDING * r * r));

        let weights = &weights[..set.len()];
        let (mean, covariance) = two_passes(&set, weights);
        let mut weighted = Stats::new(anchor);
        for (v, w) in set.iter().zip(weights) {
            weighted.push_weighted(v, *w);
        }
        prop_assert_eq!(weighted.count(), set.len() as u64);
        prop_assert!(same_vector(weighted.mean().unwrap(), mean, ROUNDING * r));
        prop_assert!(same_matrix(weighted.covariance().unwrap(), covariance, ROUNDING * r * r));
        let total: f64 = weights.iter().sum();
        let added = [0, 1, 2].map(|i| {
            set.iter().zip(weights).map(|(v, w)| (w * v.error[i]).powi(2)).sum::<f64>() / (total * total)
        });
        let of_mean = covariance * (1.0 / set.len() as f64) + SymmetricMatrix3::diagonal(added);
        prop_assert!(same_matrix(weighted.covariance_of_mean().unwrap(), of_mean, ROUNDING * r * r));
    }

    #[test]
    fn each_sum_is_what_it_says(set in set(50), weights in prop::collection::vec(0.1..9.0, 50)) {
        let mut moments = Moments::EMPTY;
        for (v, w) in set.iter().zip(&weights) {
            moments.push_weighted(v, *w);
        }
        let sum = |f: &dyn Fn(&UncertainVector, f64) -> f64| set.iter().zip(&weights).map(|(v, w)| f(v, *w)).sum::<f64>();
        let near = |a: f64, b: f64| (a - b).abs() < 1e-11;
        prop_assert!(near(moments.weight(), sum(&|_, w| w)));
        for i in 0..3 {
            prop_assert!(near(moments.sum()[i], sum(&|v, w| w * v.value[i])));
            prop_assert!(near(moments.error()[i], sum(&|v, w| w * w * v.error[i] * v.error[i])));
            for j in 0..3 {
                prop_assert!(near(moments.second().get(i, j), sum(&|v, w| w * v.value[i] * v.value[j])));
            }
        }
    }

    #[test]
    fn a_weight_of_one_is_no_weight(set in set(50), anchor in vector(1.0)) {
        let mut weighted = Stats::new(anchor);
        for v in &set {
            weighted.push_weighted(v, 1.0);
        }
        prop_assert_eq!(weighted, stats(anchor, &set));
    }

    #[test]
    fn merging_commutes(a in set(50), b in set(50), anchors in prop::array::uniform2(vector(3.0))) {
        let (one, other) = (stats(anchors[0], &a), stats(anchors[1], &b));
        let (mut ab, mut ba) = (one, other);
        ab.merge(&other);
        ba.merge(&one);
        prop_assert_eq!(ab.anchor(), anchors[0]);
        let all = [a, b].concat();
        alike(&ab, &ba, reach(&anchors, &all))?;
        alike(&ab, &stats(anchors[0], &all), reach(&anchors, &all))?;
    }

    #[test]
    fn merging_associates(
        a in set(40), b in set(40), c in set(40), anchors in prop::array::uniform3(vector(3.0)),
    ) {
        let [x, y, z] = [(&a, anchors[0]), (&b, anchors[1]), (&c, anchors[2])].map(|(set, at)| stats(at, set));
        let mut left = x;
        left.merge(&y);
        left.merge(&z);
        let mut tail = y;
        tail.merge(&z);
        let mut right = x;
        right.merge(&tail);
        alike(&left, &right, reach(&anchors, &[a, b, c].concat()))?;
    }

    #[test]
    fn the_order_of_pushes_does_not_matter(set in set(100).prop_shuffle(), anchor in vector(1.0)) {
        let mut sorted = set.clone();
        sorted.sort_by(|a, b| a.value[0].total_cmp(&b.value[0]));
        alike(&stats(anchor, &set), &stats(anchor, &sorted), reach(&[anchor], &set))?;
    }

    #[test]
    fn another_anchor_is_another_way_to_say_the_same(set in set(50), from in vector(3.0), to in vector(3.0)) {
        let moved = stats(from, &set).with_anchor(to);
        prop_assert_eq!(moved.anchor(), to);
        alike(&moved, &stats(to, &set), reach(&[from, to], &set))?;
        let sums = moved.moments();
        let direct = stats(to, &set);
        let (n, r) = (set.len() as f64, reach(&[from, to], &set));
        prop_assert!(same_vector(sums.sum(), direct.moments().sum(), ROUNDING * n * r));
        prop_assert!(same_matrix(sums.second(), direct.moments().second(), ROUNDING * n * r * r));
        prop_assert_eq!(sums.error(), direct.moments().error());
    }

    /// Coordinates that are multiples of 1/1024, so that no sum here rounds.
    #[test]
    fn translated_is_exact_against_adding_again(
        set in prop::collection::vec((prop::array::uniform3(-4096i32..4096), 1u8..5), 0..50),
        t in prop::array::uniform3(-4096i32..4096),
    ) {
        let value = |p: [i32; 3]| p.map(|x| f64::from(x) / 1024.0);
        let t = value(t);
        let (mut before, mut after) = (Moments::EMPTY, Moments::EMPTY);
        for (p, w) in set {
            let v = UncertainVector::isotropic(value(p), 0.5);
            before.push_weighted(&v, f64::from(w));
            after.push_weighted(&UncertainVector { value: [0, 1, 2].map(|i| v.value[i] + t[i]), ..v }, f64::from(w));
        }
        prop_assert_eq!(before.translated(t), after);
    }

    /// Multiples of 2⁻²⁰ m survive a move of 1e7 m without rounding, and so does everything computed from them.
    #[test]
    fn far_away_nothing_changes_that_can_be_written_down(
        set in prop::collection::vec(prop::array::uniform3(-2_000_000i32..2_000_000), 1..50),
        signs in prop::array::uniform3(any::<bool>()),
    ) {
        let far = signs.map(|negative| if negative { -1e7 } else { 1e7 });
        let near: Vec<_> =
            set.iter().map(|p| UncertainVector::isotropic(p.map(|x| f64::from(x) / 1_048_576.0), 0.01)).collect();
        let moved: Vec<_> = near
            .iter()
            .map(|v| UncertainVector { value: [0, 1, 2].map(|i| v.value[i] + far[i]), ..*v })
            .collect();
        prop_assert_eq!(*stats([0.0; 3], &near).moments(), *stats(far, &moved).moments());
    }

    /// Other coordinates are rounded by up to 1e-9 m when they are moved: half the spacing of numbers at 1e7.
    #[test]
    fn far_away_nothing_changes_but_the_rounding_of_coordinates(
        set in set(50), anchor in vector(1.0), probe in uncertain(),
    ) {
        let shift = |p: [f64; 3]| p.map(|x| x + 1e7);
        let shifted = |v: &UncertainVector| UncertainVector { value: shift(v.value), ..*v };
        let moved: Vec<_> = set.iter().map(shifted).collect();
        let (near, far) = (stats(anchor, &set), stats(shift(anchor), &moved));
        let coordinate = 1e-9;
        prop_assert!(same_vector(far.mean().unwrap(), shift(near.mean().unwrap()), 3.0 * coordinate));
        // Products of two differences of less than 2 m, each off by two roundings.
        let product = 2.0 * 2.0 * 2.0 * coordinate;
        prop_assert!(same_matrix(near.covariance().unwrap(), far.covariance().unwrap(), product));
        let [d, e] = [(near, probe), (far, shifted(&probe))].map(|(s, v)| s.expected_squared_distance(&v).unwrap());
        prop_assert!((d - e).abs() < 3.0 * product);
    }

    #[test]
    fn equation_3_from_sums_is_equation_2_from_points(set in set(50), probe in uncertain(), anchor in vector(1.0)) {
        // Eq. (2) term by term, with the errors as what they are: independent and of mean zero, so that the expectation of
        // the square of their sum is the sum of their squares.
        let n = set.len() as f64;
        let p = probe.value;
        let sum = [0, 1, 2].map(|i| set.iter().map(|v| v.value[i]).sum::<f64>());
        let errors: f64 = set.iter().map(|v| dot(v.error, v.error)).sum();
        let equation_2 = dot(p, p) + dot(probe.error, probe.error) + dot(sum, sum) / (n * n) + errors / (n * n)
            - 2.0 * dot(p, sum) / n;
        let equation_3 = stats(anchor, &set).expected_squared_distance(&probe).unwrap();
        prop_assert!((equation_2 - equation_3).abs() < 1e-13);
        // And literally from the sums of Definition 1, about the origin.
        let moments = *stats([0.0; 3], &set).moments();
        let (l, e, d) = (moments.sum(), moments.error(), moments.count() as f64);
        let literal = dot(p, p) + dot(probe.error, probe.error) + dot(l, l) / (d * d) + e.iter().sum::<f64>() / (d * d)
            - 2.0 * dot(p, l) / d;
        prop_assert!((literal - equation_3).abs() < 1e-13);
    }

    #[test]
    fn weights_of_one_over_variance_give_the_least_variance(
        set in prop::collection::vec((vector(1.0), 0.01..1.0f64), 1..30),
        other in prop::collection::vec(0.1..10.0, 30),
    ) {
        let (mut best, mut any) = (Stats::new([0.0; 3]), Stats::new([0.0; 3]));
        for ((value, sigma), weight) in set.iter().zip(&other) {
            let v = UncertainVector::isotropic(*value, *sigma);
            best.push_weighted(&v, 1.0 / (sigma * sigma));
            any.push_weighted(&v, *weight);
        }
        let variance = |s: &Stats| s.moments().error()[1] / (s.weight() * s.weight());
        let information: f64 = set.iter().map(|(_, sigma)| 1.0 / (sigma * sigma)).sum();
        prop_assert!((variance(&best) * information - 1.0).abs() < 1e-12);
        prop_assert!(variance(&best) <= variance(&any) * (1.0 + 1e-12));
        let mean = [0, 1, 2].map(|i| set.iter().map(|(v, s)| v[i] / (s * s)).sum::<f64>() / information);
        prop_assert!(same_vector(best.mean().unwrap(), mean, 1e-13));
    }

    #[test]
    fn variance_with_error_equals_two_passes(set in set(50), anchor in vector(1.0)) {
        let (_, covariance) = two_passes(&set, &vec![1.0; set.len()]);
        let squared_errors = |i: usize| set.iter().map(|v| v.error[i] * v.error[i]).sum::<f64>() / set.len() as f64;
        let expected = [0, 1, 2].map(|i| covariance.get(i, i) + squared_errors(i));
        prop_assert!(same_vector(stats(anchor, &set).variance_with_error().unwrap(), expected, 1e-13));
    }

    #[test]
    fn covariances_are_positive_semidefinite(
        inside in prop::collection::vec(vector(1.0), 1..100),
        across in vector(1.0).prop_filter("too short", |v| dot(*v, *v) > 1e-4),
        flat in any::<bool>(),
        probe in vector(1.0),
        anchor in vector(1.0),
    ) {
        let unit = across.map(|x| x / dot(across, across).sqrt());
        let onto = |p: [f64; 3]| minus(p, unit.map(|x| x * dot(unit, p)));
        let set: Vec<_> = inside.into_iter().map(|p| UncertainVector::exact(if flat { onto(p) } else { p })).collect();
        let covariance = stats(anchor, &set).covariance().unwrap();
        let r = reach(&[anchor], &set).max(1e-3);
        prop_assert!(covariance.diagonal_entries().iter().all(|x| *x >= 0.0));
        prop_assert!(covariance.quadratic_form(unit) >= -ROUNDING * r * r);
        prop_assert!(!flat || covariance.quadratic_form(unit) <= ROUNDING * r * r);
        prop_assert!(covariance.quadratic_form(probe) >= -ROUNDING * r * r * dot(probe, probe));
    }

    #[test]
    fn matrices_do_what_their_rows_do(m in prop::array::uniform6(-9.0..9.0), u in vector(9.0), v in vector(9.0), f in -9.0..9.0f64) {
        let matrix = SymmetricMatrix3(m);
        let rows = matrix.rows();
        let near = |a: f64, b: f64| (a - b).abs() < 1e-10;
        prop_assert!(near(matrix.quadratic_form(v), dot(v, rows.map(|row| dot(row, v)))));
        prop_assert!(near(matrix.trace(), matrix.diagonal_entries().iter().sum()));
        for i in 0..3 {
            prop_assert_eq!(matrix.diagonal_entries()[i], rows[i][i]);
            for j in 0..3 {
                prop_assert_eq!(rows[i][j], rows[j][i]);
                prop_assert_eq!(matrix.get(i, j), rows[i][j]);
                prop_assert_eq!(SymmetricMatrix3::outer(v).get(i, j), v[i] * v[j]);
                prop_assert!(near(SymmetricMatrix3::symmetric_product(u, v).get(i, j), u[i] * v[j] + v[i] * u[j]));
                prop_assert_eq!((matrix * f).get(i, j), rows[i][j] * f);
                prop_assert_eq!((matrix + SymmetricMatrix3::outer(u)).get(i, j), rows[i][j] + u[i] * u[j]);
            }
        }
    }

    #[test]
    fn a_flipped_vector_keeps_its_errors(v in uncertain()) {
        prop_assert_eq!(v.flipped().value, v.value.map(|x| -x));
        prop_assert_eq!(v.flipped().variance(), v.error.map(|x| x * x));
        prop_assert_eq!(v.flipped().flipped(), v);
    }
}

#[test]
fn known_answers() {
    // x = 1, 2, 6 with errors 1, 2, 2; y and z are constant.
    let mut set = Stats::new([2.0, 5.0, 7.0]);
    for (x, error) in [(1.0, 1.0), (2.0, 2.0), (6.0, 2.0)] {
        set.push(&UncertainVector { value: [x, 5.0, 7.0], error: [error, 0.0, 3.0] });
    }
    assert_eq!(set.mean(), Some([3.0, 5.0, 7.0]));
    // Variance (4 + 1 + 9) / 3, and Σε² = 9 along x, 27 along z.
    let near =
        |found: f64, expected: f64| assert!((found - expected).abs() < 1e-14, "{found} for {expected}");
    near(set.covariance().unwrap().get(0, 0), 14.0 / 3.0);
    near(set.covariance_of_mean().unwrap().get(0, 0), 14.0 / 9.0 + 9.0 / 9.0);
    near(set.covariance_of_mean().unwrap().get(2, 2), 27.0 / 9.0);
    let variance = set.variance_with_error().unwrap();
    near(variance[0], 14.0 / 3.0 + 9.0 / 3.0);
    near(variance[2], 9.0);
    // ‖(4, 5, 9) − (3, 5, 7)‖² + ‖(1, 1, 2)‖² + 36/9.
    let probe = UncertainVector { value: [4.0, 5.0, 9.0], error: [1.0, 1.0, 2.0] };
    near(set.expected_squared_distance(&probe).unwrap(), 5.0 + 6.0 + 4.0);
}

#[test]
fn known_answers_with_weights() {
    // x = 0 with weight 3 and error 1, x = 4 with weight 1 and error 3.
    let mut set = Stats::new([1.0, 0.0, 0.0]);
    set.push_weighted(&UncertainVector { value: [0.0; 3], error: [1.0, 0.0, 0.0] }, 3.0);
    set.push_weighted(&UncertainVector { value: [4.0, 0.0, 0.0], error: [3.0, 0.0, 0.0] }, 1.0);
    assert_eq!((set.count(), set.weight()), (2, 4.0));
    assert_eq!(set.mean(), Some([1.0, 0.0, 0.0]));
    // (3·1 + 1·9)/4, and Σw²ε² = 9 + 9 over 16.
    assert_eq!(set.covariance().unwrap().get(0, 0), 3.0);
    assert_eq!(set.covariance_of_mean().unwrap().get(0, 0), 1.5 + 18.0 / 16.0);
}

#[test]
fn statistics_take_as_many_bytes_as_told() {
    assert_eq!((size_of::<Moments>(), size_of::<Stats>()), (136, 160));
}

proptest! {
    /// Errors along the axes are those with a diagonal covariance, to the last bit; any other adds up and turns as a
    /// covariance does.
    #[test]
    fn covariances_of_errors_add_up(set in set(50), anchor in vector(1.0), tilts in prop::collection::vec(vector(0.1), 50)) {
        let (mut by_axis, mut by_matrix, mut tilted) = (Stats::new(anchor), Stats::new(anchor), Stats::new(anchor));
        let mut sum = SymmetricMatrix3::ZERO;
        for (v, tilt) in set.iter().zip(&tilts) {
            by_axis.push(v);
            let [x, y, z] = v.variance();
            by_matrix.push_covariant(v.value, &SymmetricMatrix3::diagonal([x, y, z]));
            let covariance = SymmetricMatrix3::outer(*tilt);
            tilted.push_covariant(v.value, &covariance);
            sum += covariance;
        }
        prop_assert_eq!(by_axis, by_matrix);
        prop_assert_eq!(tilted.moments().noise(), sum);
        prop_assert_eq!(tilted.moments().error(), sum.diagonal_entries());
        let (n, n2) = (set.len() as f64, (set.len() * set.len()) as f64);
        let (scatter, of_mean) = (tilted.covariance().unwrap(), tilted.covariance_of_mean().unwrap());
        for i in 0..6 {
            let expected = scatter.0[i] / n + sum.0[i] / n2;
            prop_assert!((of_mean.0[i] - expected).abs() <= 1e-12 * (expected.abs() + sum.trace()));
        }
        // Merged in two halves, in any anchor.
        let mut halves = [Stats::new(anchor), Stats::new([0.0; 3])];
        for (i, (v, tilt)) in set.iter().zip(&tilts).enumerate() {
            halves[i % 2].push_covariant(v.value, &SymmetricMatrix3::outer(*tilt));
        }
        let [mut all, other] = halves;
        all.merge(&other);
        prop_assert!(same_matrix(all.moments().noise(), sum, 1e-13 * sum.trace()));
    }
}
