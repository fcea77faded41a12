//! The eigen-solver against faer, on matrices at random and matrices made to be hard.

// A test has no caller to report to, and compares bits.
#![allow(clippy::unwrap_used, clippy::float_cmp)]

use faer::{Mat, Side};
use proptest::prelude::*;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use terrace_normals::{Eigen3, symmetric_eigen, symmetric_eigen_batch};
use terrace_stats::SymmetricMatrix3;

const EPS: f64 = f64::EPSILON;

/// Eigenvalues that solvers fail on.
const SPECTRA: [[f64; 3]; 22] = [
    [1.0, 1.0, 1.0],
    [2.0, 1.0, 1.0],
    [2.0, 2.0, 1.0],
    [1.0, 1.0 + EPS, 1.0 - EPS],
    [1.0, 1.0 + 1e-15, 2.0],
    [1.0, 1.0 + 1e-12, 1.0 - 1e-12],
    [1.0, 1.0 + 1e-8, 3.0],
    [1.0, 1e-8, 1e-16],
    [1.0, 1e-16, 1e-8],
    [1.0, 1e-16, 1e-32],
    [1.0, 0.0, 0.0],
    [1.0, 1.0, 0.0],
    [2.0, 1.0, 0.0],
    [0.0, 0.0, 0.0],
    [1.0, 1.0, 1e-9],
    [1.0, 0.5, 1e-12],
    [-1.0, 0.0, 1.0],
    [-1.0, -2.0, -3.0],
    [1.0, -1.0, 1e-15],
    [1e-300, 2e-300, 3e-300],
    [1e300, -1e300, 5e299],
    [1e-300, 1e-308, 0.0],
];

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn rotation(rng: &mut ChaCha8Rng) -> [[f64; 3]; 3] {
    loop {
        let [a, b]: [[f64; 3]; 2] =
            std::array::from_fn(|_| std::array::from_fn(|_| rng.random_range(-1.0..1.0)));
        let c = cross(a, b);
        let (length, width) = (dot(a, a).sqrt(), dot(c, c).sqrt());
        if width > 0.1 {
            let (a, c) = (a.map(|x| x / length), c.map(|x| x / width));
            return [a, cross(c, a), c];
        }
    }
}

fn with_spectrum(spectrum: [f64; 3], axes: [[f64; 3]; 3]) -> SymmetricMatrix3 {
    let [a, b, c] = [0, 1, 2].map(|k| SymmetricMatrix3::outer(axes[k]) * spectrum[k]);
    a + b + c
}

/// Ten thousand matrices and more.
fn matrices() -> Vec<SymmetricMatrix3> {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let identity = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let mut all = Vec::new();
    for spectrum in SPECTRA {
        for order in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
            all.push(SymmetricMatrix3::diagonal(order.map(|k| spectrum[k])));
            // An eighth of a turn and less about one axis: zeros stay zeros.
            for angle in [std::f64::consts::FRAC_PI_4, 0.1, 1e-5, 1e-9, 1e-14] {
                let (s, c) = f64::sin_cos(angle);
                let turned = [[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]];
                all.push(with_spectrum(order.map(|k| spectrum[k]), turned));
            }
        }
        for _ in 0..200 {
            all.push(with_spectrum(spectrum, rotation(&mut rng)));
        }
        all.push(with_spectrum(spectrum, identity));
    }
    // The diagonal vanishes, or one entry stands alone.
    for k in 0..6 {
        let mut alone = [0.0; 6];
        alone[k] = -3.0;
        all.push(SymmetricMatrix3(alone));
    }
    all.push(SymmetricMatrix3([0.0, 1.0, 1.0, 0.0, 1.0, 0.0]));
    all.push(SymmetricMatrix3([1.0; 6]));
    while all.len() < 12_000 {
        let entries: [f64; 6] = std::array::from_fn(|_| rng.random_range(-1.0..1.0));
        // Half of them with entries of very different sizes.
        let graded = entries.map(|x| x * 10f64.powi(rng.random_range(-20..20)));
        all.push(SymmetricMatrix3(if all.len() % 2 == 0 { entries } else { graded }));
    }
    all
}

/// The matrix over a power of two near its largest entry, so that squares of its entries can be taken; and the power.
fn scaled(m: &SymmetricMatrix3) -> (SymmetricMatrix3, f64) {
    let largest = m.0.iter().fold(0.0, |a: f64, x| a.max(x.abs()));
    let power = if largest == 0.0 { 1.0 } else { largest.log2().floor().exp2() };
    (SymmetricMatrix3(m.0.map(|x| x / power)), power)
}

fn by_faer(m: &SymmetricMatrix3) -> [f64; 3] {
    let rows = m.rows();
    let values = Mat::from_fn(3, 3, |i, j| rows[i][j]).self_adjoint_eigenvalues(Side::Lower).unwrap();
    [values[0], values[1], values[2]]
}

fn bits(e: &Eigen3) -> Vec<u64> {
    e.values.iter().chain(e.vectors.iter().flatten()).map(|x| x.to_bits()).collect()
}

#[test]
fn twelve_thousand_random_and_nasty_matrices_against_faer() {
    // All in units of the rounding of the largest eigenvalue (or of 1, for vectors).
    let (mut apart, mut residual, mut skew) = (0.0f64, 0.0f64, 0.0f64);
    for m in matrices() {
        let e = symmetric_eigen(&m);
        let (m, power) = scaled(&m);
        let values = e.values.map(|v| v / power);
        assert!(values[0] <= values[1] && values[1] <= values[2], "{m:?} {e:?}");
        let theirs = by_faer(&m);
        let ulp = EPS * theirs.iter().fold(f64::MIN_POSITIVE, |a, v| a.max(v.abs()));
        for k in 0..3 {
            apart = apart.max((values[k] - theirs[k]).abs() / ulp);
            let v = e.vectors[k];
            let off = m.rows().map(|row| dot(row, v));
            let off = [0, 1, 2].map(|i| off[i] - values[k] * v[i]);
            residual = residual.max(dot(off, off).sqrt() / ulp);
            for j in 0..3 {
                let expected = if j == k { 1.0 } else { 0.0 };
                skew = skew.max((dot(v, e.vectors[j]) - expected).abs() / EPS);
            }
        }
        let handed = dot(cross(e.vectors[0], e.vectors[1]), e.vectors[2]);
        assert!((handed - 1.0).abs() < 32.0 * EPS, "{m:?} {e:?}");
    }
    println!(
        "largest error in units of rounding: eigenvalues {apart:.1}, residuals {residual:.1}, products {skew:.1}"
    );
    assert!(apart < 12.0, "eigenvalues differ from those of faer by {apart} roundings");
    assert!(residual < 12.0, "residual of {residual} roundings");
    assert!(skew < 6.0, "vectors are off by {skew} roundings");
}

#[test]
fn small_eigenvalues_keep_their_digits_where_the_matrix_defines_them() {
    // Graded by rows and columns: D C D with a well-conditioned C. The determinant is known exactly.
    let d = [1.0, 2f64.powi(-30), 2f64.powi(-60)];
    let c = [[4.0, 1.0, 1.0], [1.0, 4.0, 1.0], [1.0, 1.0, 4.0]];
    let at = |i: usize, j: usize| c[i][j] * d[i] * d[j];
    let m = SymmetricMatrix3([at(0, 0), at(0, 1), at(0, 2), at(1, 1), at(1, 2), at(2, 2)]);
    let product: f64 = symmetric_eigen(&m).values.iter().product();
    let determinant = 54.0 * (d[0] * d[1] * d[2]).powi(2);
    assert!((product / determinant - 1.0).abs() < 16.0 * EPS, "{product:e} {determinant:e}");
}

#[test]
fn scaling_by_powers_of_two_changes_no_bit() {
    for m in matrices().iter().map(|m| scaled(m).0) {
        let e = symmetric_eigen(&m);
        for power in [2f64.powi(-900), 2f64.powi(900)] {
            let other = symmetric_eigen(&(m * power));
            // Entries a hundred orders smaller than the largest may be lost to underflow.
            if m.0.iter().all(|x| *x == 0.0 || x.abs() > 1e-30) {
                assert_eq!(other.vectors, e.vectors);
                assert_eq!(other.values, e.values.map(|v| v * power));
            }
        }
    }
}

#[test]
fn entries_that_are_not_finite_make_all_numbers_nan() {
    for bad in [f64::NAN, -f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for k in 0..6 {
            let mut entries = [3.0, 0.5, 0.25, 2.0, 0.125, 1.0];
            entries[k] = bad;
            let e = symmetric_eigen(&SymmetricMatrix3(entries));
            assert!(e.values.iter().chain(e.vectors.iter().flatten()).all(|x| x.is_nan()), "{e:?}");
        }
    }
}

#[test]
fn zero_subnormal_and_huge() {
    let identity = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    assert_eq!(symmetric_eigen(&SymmetricMatrix3::ZERO), Eigen3 { values: [0.0; 3], vectors: identity });
    let least = f64::from_bits(1);
    assert_eq!(symmetric_eigen(&SymmetricMatrix3([least; 6])).values, [0.0, 0.0, 3.0 * least]);
    assert_eq!(symmetric_eigen(&SymmetricMatrix3::diagonal([f64::MAX; 3])).values, [f64::MAX; 3]);
    assert_eq!(symmetric_eigen(&SymmetricMatrix3([f64::MAX; 6])).values[2], f64::INFINITY);
}

#[test]
fn batches_give_the_bits_of_the_single_solver() {
    let matrices = matrices();
    let (batches, _) = matrices.as_chunks::<4>();
    for batch in batches {
        let together = symmetric_eigen_batch(batch);
        for (m, e) in batch.iter().zip(&together) {
            assert_eq!(bits(e), bits(&symmetric_eigen(m)), "{m:?}");
        }
    }
    let (batches, _) = matrices.as_chunks::<7>();
    for batch in batches {
        let together = symmetric_eigen_batch(batch);
        assert!(batch.iter().zip(&together).all(|(m, e)| bits(e) == bits(&symmetric_eigen(m))));
    }
}

#[test]
fn entries_whose_squares_underflow_keep_the_vectors_perpendicular() {
    for power in 140..170 {
        let small = 10f64.powi(-power);
        for m in [[0.0, small, 0.0, 0.0, 0.0, 1.0], [small, small, -small, 0.0, small, 1.0]] {
            let e = symmetric_eigen(&SymmetricMatrix3(m));
            for (j, k) in [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)] {
                let expected = if j == k { 1.0 } else { 0.0 };
                assert!((dot(e.vectors[j], e.vectors[k]) - expected).abs() < 6.0 * EPS, "{m:?} {e:?}");
            }
        }
    }
}

#[test]
fn zeros_of_either_sign_have_the_same_bits_in_every_company() {
    let busy = SymmetricMatrix3([1.0, 0.5, 0.3, 2.0, -0.4, 1.5]);
    let zeros = [0.0, -0.0];
    for signs in 0..64usize {
        let at = |k: usize| zeros[signs >> k & 1];
        for (x, y) in [(at(3), at(4)), (1.0, at(4)), (1.0, -2.0)] {
            for off in [at(5), 0.25, -0.25] {
                let m = SymmetricMatrix3([x, off, at(0), y, at(1), at(2)]);
                let [_, e] = symmetric_eigen_batch(&[busy, m]);
                assert_eq!(bits(&e), bits(&symmetric_eigen(&m)), "{m:?}");
            }
        }
    }
}

fn entry() -> impl Strategy<Value = f64> {
    prop_oneof![
        6 => -1.0..1.0f64,
        1 => Just(0.0),
        1 => Just(-0.0),
        1 => (-300..300i32).prop_map(|p| 10f64.powi(p)),
    ]
}

proptest! {
    #[test]
    fn what_stands_in_the_other_lanes_does_not_matter(
        m in prop::array::uniform6(entry()),
        others in prop::array::uniform4(prop::array::uniform6(prop_oneof![entry(), any::<f64>()])),
        lane in 0..4usize,
    ) {
        let mut batch = others.map(SymmetricMatrix3);
        batch[lane] = SymmetricMatrix3(m);
        let together = symmetric_eigen_batch(&batch);
        prop_assert_eq!(bits(&together[lane]), bits(&symmetric_eigen(&SymmetricMatrix3(m))));
        batch.swap(0, lane);
        let swapped = symmetric_eigen_batch(&batch);
        prop_assert_eq!(bits(&together[lane]), bits(&swapped[0]));
    }

    #[test]
    fn any_bits_at_all_give_numbers_or_nan(m in prop::array::uniform6(any::<f64>())) {
        let m = SymmetricMatrix3(m);
        let e = symmetric_eigen(&m);
        prop_assert_eq!(e.vectors[0][0].is_nan(), !m.is_finite());
        prop_assert!(!m.is_finite() || e.values[0] <= e.values[1] && e.values[1] <= e.values[2]);
    }
}
