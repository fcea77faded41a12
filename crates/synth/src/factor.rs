//! A root of a covariance, by which independent deviates become correlated ones.

use std::array::from_fn;

/// What rounding leaves of a variance that is explained by others, as a share of it.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// An `F` with `F Fᵀ = C`, for a covariance of any rank.
///
/// Cholesky's elimination of the correlations with the largest pivot first, which ends where nothing but rounding is
/// left. A row of `C` without variance is a row of zeros in `F`, and of a diagonal `C` the `F` is diagonal. Where `C`
/// misses being positive semidefinite by rounding, the variances are kept and the correlations give way.
pub(crate) fn factor<const N: usize>(covariance: &[[f64; N]; N]) -> [[f64; N]; N] {
    let deviation: [f64; N] = from_fn(|i| covariance[i][i].max(0.0).sqrt());
    // Scaled to correlations, metres and radians compare.
    let mut rest: [[f64; N]; N] = from_fn(|i| {
        from_fn(|j| match (deviation[i], deviation[j]) {
            (a, b) if a > 0.0 && b > 0.0 && i != j => covariance[i][j] / a / b,
            (a, _) if a > 0.0 && i == j => 1.0,
            _ => 0.0,
        })
    });
    let mut factor = [[0.0; N]; N];
    let mut left: Vec<usize> = (0..N).collect();
    while let Some(place) =
        (0..left.len()).max_by(|a, b| rest[left[*a]][left[*a]].total_cmp(&rest[left[*b]][left[*b]]))
    {
        let k = left.swap_remove(place);
        let pivot = rest[k][k];
        if pivot <= ROUNDING {
            break;
        }
        let root = pivot.sqrt();
        let mut column = [0.0; N];
        column[k] = root;
        for i in &left {
            // No entry explains more than what is left of its variance, which rounding may have made too small.
            let most = (rest[*i][*i].max(0.0) + ROUNDING).sqrt();
            column[*i] = (rest[*i][k] / root).min(most).max(-most);
        }
        for i in &left {
            for j in &left {
                rest[*i][*j] -= column[*i] * column[*j];
            }
        }
        for i in 0..N {
            factor[i][k] = deviation[i] * column[i];
        }
    }
    factor
}

/// `F g`.
pub(crate) fn apply<const N: usize>(factor: &[[f64; N]; N], deviates: [f64; N]) -> [f64; N] {
    factor.map(|row| row.into_iter().zip(deviates).map(|(a, b)| a * b).sum())
}

/// The rows of a covariance given as `xx, xy, xz, yy, yz, zz`.
pub(crate) fn rows([xx, xy, xz, yy, yz, zz]: [f64; 6]) -> [[f64; 3]; 3] {
    [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn gram<const N: usize>(a: &[[f64; N]; N]) -> [[f64; N]; N] {
        from_fn(|i| from_fn(|j| (0..N).map(|k| a[i][k] * a[j][k]).sum()))
    }

    /// Largest difference, as a share of the two standard deviations.
    fn difference<const N: usize>(a: &[[f64; N]; N], b: &[[f64; N]; N]) -> f64 {
        let entry = |i: usize, j: usize| {
            let scale = (b[i][i] * b[j][j]).sqrt();
            let gap = (a[i][j] - b[i][j]).abs();
            if gap == 0.0 { 0.0 } else { gap / scale }
        };
        (0..N).flat_map(|i| (0..N).map(move |j| (i, j))).map(|(i, j)| entry(i, j)).fold(0.0, f64::max)
    }

    fn any_root<const N: usize>() -> impl Strategy<Value = [[f64; N]; N]> {
        let row = prop::collection::vec(-1.0..1.0_f64, N);
        let scales =
            prop::collection::vec(prop_oneof![Just(0.0), (-9..3_i32).prop_map(|e| 10_f64.powi(e))], N);
        (prop::collection::vec(row, N), scales, 0..=N).prop_map(|(rows, scales, rank)| {
            from_fn(|i| from_fn(|k| if k < rank { scales[i] * rows[i][k] } else { 0.0 }))
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2_000))]

        #[test]
        fn the_factor_times_itself_is_the_covariance_whatever_the_rank(a in any_root::<3>(), b in any_root::<6>()) {
            let differences = [
                difference(&gram(&factor(&gram(&a))), &gram(&a)),
                difference(&gram(&factor(&gram(&b))), &gram(&b)),
            ];
            prop_assert!(differences.iter().all(|d| *d < 1e-12), "{differences:?}");
        }

        // Written with seven digits, a covariance of low rank is no longer quite semidefinite.
        #[test]
        fn variances_stay_when_correlations_are_rounded(a in any_root::<6>(), rounding in any_root::<6>()) {
            let mut c = gram(&a);
            for i in 0..6 {
                for j in 0..i {
                    c[i][j] *= 1.0 + 1e-7 * rounding[i][j].clamp(-1.0, 1.0);
                    c[j][i] = c[i][j];
                }
            }
            let made = gram(&factor(&c));
            for i in 0..6 {
                prop_assert!((made[i][i] - c[i][i]).abs() <= 1e-13 * c[i][i]);
            }
            prop_assert!(difference(&made, &c) < 1e-2, "{}", difference(&made, &c));
        }
    }

    #[test]
    fn a_diagonal_stays_a_diagonal() {
        let made = factor(&[[4.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 9.0]]);
        assert_eq!(
            made.map(|row| row.map(f64::to_bits)),
            [[2.0, 0.0, 0.0], [0.0; 3], [0.0, 0.0, 3.0]].map(|row: [f64; 3]| row.map(f64::to_bits))
        );
    }
}
