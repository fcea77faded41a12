//! Whether a 6×6 matrix can be a covariance.

use crate::PoseNoiseError;

/// How far a covariance may be from symmetric and from positive semidefinite, as a share of its variances: such as
/// are written with seven digits pass.
pub(crate) const TOLERANCE: f64 = 1e-6;

/// The matrix made exactly symmetric, or why it is no covariance.
pub(crate) fn checked(covariance: &[[f64; 6]; 6]) -> Result<[[f64; 6]; 6], PoseNoiseError> {
    for (row, values) in covariance.iter().enumerate() {
        for (column, value) in values.iter().copied().enumerate() {
            if !value.is_finite() {
                return Err(PoseNoiseError::NotFinite { row, column, value });
            }
        }
        let value = values[row];
        if value < 0.0 {
            return Err(PoseNoiseError::NegativeVariance { index: row, value });
        }
    }
    let mut symmetric = *covariance;
    for row in 0..6 {
        for column in 0..row {
            let (lower, upper) = (covariance[row][column], covariance[column][row]);
            // Metres and radians differ in size: an entry is compared with its own two variances.
            let scale = covariance[row][row].sqrt() * covariance[column][column].sqrt();
            if (lower - upper).abs() > TOLERANCE * scale {
                return Err(PoseNoiseError::NotSymmetric { row, column, lower, upper });
            }
            let mean = lower / 2.0 + upper / 2.0;
            symmetric[row][column] = mean;
            symmetric[column][row] = mean;
        }
    }
    let defect = defect(&correlations(&symmetric));
    if defect > TOLERANCE {
        return Err(PoseNoiseError::NotSemidefinite { defect });
    }
    Ok(symmetric)
}

/// The matrix with a diagonal of ones. A row without variance stays as zeros, so that a covariance in it shows.
fn correlations(covariance: &[[f64; 6]; 6]) -> [[f64; 6]; 6] {
    let deviation: [f64; 6] = std::array::from_fn(|i| covariance[i][i].sqrt());
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let scale = deviation[i] * deviation[j];
            if scale > 0.0 {
                covariance[i][j] / scale
            } else if covariance[i][j] == 0.0 {
                0.0
            } else {
                // No variance, and yet a covariance.
                f64::INFINITY
            }
        })
    })
}

/// By how much a matrix with a diagonal of ones and zeros misses being positive semidefinite.
///
/// No entry may be above 1. Elimination that takes the largest pivot first leaves nothing, up to rounding, once no
/// pivot is positive; what is left of any other matrix is its defect.
fn defect(matrix: &[[f64; 6]; 6]) -> f64 {
    let largest = matrix.iter().flatten().fold(0.0, |largest: f64, entry| largest.max(entry.abs()));
    if largest > 1.0 + TOLERANCE {
        return largest - 1.0;
    }
    let mut rest = *matrix;
    let mut left: Vec<usize> = (0..6).collect();
    while let Some(place) = (0..left.len()).max_by(|a, b| {
        let pivot = |place: usize| rest[left[place]][left[place]];
        pivot(*a).total_cmp(&pivot(*b))
    }) {
        let k = left.swap_remove(place);
        let pivot = rest[k][k];
        if pivot <= TOLERANCE {
            let of_row = |i: usize| left.iter().map(|j| rest[i][*j].abs()).fold(pivot.abs(), f64::max);
            return left.iter().map(|i| of_row(*i)).fold(of_row(k), f64::max);
        }
        for i in &left {
            let factor = rest[*i][k] / pivot;
            for j in &left {
                rest[*i][*j] -= factor * rest[k][*j];
            }
        }
    }
    0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `A Aᵀ` of a 6×n matrix of small whole numbers.
    fn product<const N: usize>(a: [[i8; N]; 6]) -> [[f64; 6]; 6] {
        [0, 1, 2, 3, 4, 5].map(|i| {
            [0, 1, 2, 3, 4, 5].map(|j| (0..N).map(|k| f64::from(a[i][k]) * f64::from(a[j][k])).sum())
        })
    }

    #[test]
    fn every_product_with_its_transpose_passes_whatever_its_rank() {
        for matrix in [
            product([[0]; 6]),
            product([[1], [2], [0], [-3], [1], [5]]),
            product([[1, 2], [2, -1], [0, 0], [-3, 4], [1, 1], [5, 0]]),
            product([[1, 2, 0], [2, -1, 7], [0, 0, 1], [-3, 4, 2], [1, 1, 1], [5, 0, -2]]),
        ] {
            assert_eq!(checked(&matrix), Ok(matrix));
        }
    }

    #[test]
    fn correlations_that_contradict_each_other_are_found() {
        let mut matrix = [[0.0; 6]; 6];
        for k in 0..6 {
            matrix[k][k] = 1.0;
        }
        for (i, j, correlation) in [(0, 3, 0.9), (3, 5, 0.9), (0, 5, -0.9)] {
            (matrix[i][j], matrix[j][i]) = (correlation, correlation);
        }
        assert!(matches!(checked(&matrix), Err(PoseNoiseError::NotSemidefinite { .. })));
        (matrix[0][5], matrix[5][0]) = (0.9, 0.9);
        assert!(checked(&matrix).is_ok());
    }

    #[test]
    fn a_negative_eigenvalue_is_found_in_any_place() {
        for i in 0..6 {
            for j in 0..i {
                let mut matrix = [[0.0; 6]; 6];
                for k in 0..6 {
                    matrix[k][k] = 10.0_f64.powi(2 * i32::try_from(k).unwrap() - 6);
                }
                let scale = (matrix[i][i] * matrix[j][j]).sqrt();
                (matrix[i][j], matrix[j][i]) = (scale, scale);
                assert!(checked(&matrix).is_ok(), "fully correlated {i} {j}");
                (matrix[i][j], matrix[j][i]) = (1.001 * scale, 1.001 * scale);
                assert!(matches!(checked(&matrix), Err(PoseNoiseError::NotSemidefinite { .. })), "{i} {j}");
            }
        }
    }
}
