//! An error measured in its own standard deviations.

/// Correlations of the two triangles may differ by this much, which is rounding; beyond it a matrix is no covariance.
const ASYMMETRY: f64 = 1e-6;

/// The squared Mahalanobis distance of an error, `eᵀ C⁻¹ e`: its squared length in standard deviations.
///
/// With `D` coordinates, and when the covariance is right and the error Gaussian, it is a χ² variable with `D` degrees of
/// freedom and mean `D`. Unit of the covariance: that of `error`, squared; each coordinate may have its own, such as
/// radians for tilts and metres for offsets. The result has none.
///
/// Each coordinate is first divided by its standard deviation and a Cholesky factor is taken of the *correlations*, so
/// that variances of 1e-8 and 1e4 side by side cost no digits.
///
/// `None` when something is not finite, when the matrix is not symmetric but for rounding, when it is not positive
/// definite, or when coordinates are correlated so fully that rounding alone decides.
///
/// ```
/// use terrace_calibration::squared_mahalanobis;
///
/// // One standard deviation in the first coordinate, two in the second.
/// assert_eq!(squared_mahalanobis([1e-4, 0.02], [[1e-8, 0.0], [0.0, 1e-4]]), Some(5.0));
/// // Without any scatter in a coordinate there is nothing to measure it in.
/// assert_eq!(squared_mahalanobis([0.1, 0.1], [[1.0, 0.0], [0.0, 0.0]]), None);
/// ```
pub fn squared_mahalanobis<const D: usize>(error: [f64; D], covariance: [[f64; D]; D]) -> Option<f64> {
    let deviation: [f64; D] = std::array::from_fn(|i| covariance[i][i].sqrt());
    if !deviation.iter().all(|s| s.is_finite() && *s > 0.0) {
        return None;
    }
    let mut factor = [[0.0; D]; D];
    let mut solved = [0.0; D];
    let mut sum = 0.0;
    for i in 0..D {
        for j in 0..i {
            let [lower, upper] =
                [covariance[i][j], covariance[j][i]].map(|c| c / deviation[i] / deviation[j]);
            let asymmetry = (lower - upper).abs();
            if asymmetry.is_nan() || asymmetry > ASYMMETRY {
                return None;
            }
            let known: f64 = (0..j).map(|k| factor[i][k] * factor[j][k]).sum();
            factor[i][j] = (f64::midpoint(lower, upper) - known) / factor[j][j];
        }
        let rest = 1.0 - (0..i).map(|k| factor[i][k] * factor[i][k]).sum::<f64>();
        if rest.is_nan() || rest <= D as f64 * f64::EPSILON {
            return None;
        }
        factor[i][i] = rest.sqrt();
        let known: f64 = (0..i).map(|k| factor[i][k] * solved[k]).sum();
        solved[i] = (error[i] / deviation[i] - known) / factor[i][i];
        sum += solved[i] * solved[i];
    }
    sum.is_finite().then_some(sum)
}

#[cfg(test)]
mod tests {
    use super::squared_mahalanobis;

    #[test]
    fn what_is_no_covariance_is_refused() {
        let nan = f64::NAN;
        for covariance in [
            [[0.0, 0.0], [0.0, 1.0]],
            [[-1.0, 0.0], [0.0, 1.0]],
            [[nan, 0.0], [0.0, 1.0]],
            [[1.0, nan], [nan, 1.0]],
            [[f64::INFINITY, 0.0], [0.0, 1.0]],
            [[1.0, 2.0], [2.0, 1.0]],
            [[1.0, 1.0], [1.0, 1.0]],
            [[1.0, 0.5], [0.4, 1.0]],
        ] {
            assert_eq!(squared_mahalanobis([1.0, 1.0], covariance), None, "{covariance:?}");
        }
        for error in [[nan, 0.0], [0.0, f64::INFINITY]] {
            assert_eq!(squared_mahalanobis(error, [[1.0, 0.0], [0.0, 1.0]]), None);
        }
    }

    #[test]
    fn known_distances() {
        assert_eq!(squared_mahalanobis([3.0], [[4.0]]), Some(2.25));
        assert_eq!(squared_mahalanobis([0.0, 0.0], [[1.0, 0.0], [0.0, 1.0]]), Some(0.0));
        // The inverse of [[2, 1], [1, 2]] is [[2, -1], [-1, 2]] / 3.
        let distance = squared_mahalanobis([1.0, -1.0], [[2.0, 1.0], [1.0, 2.0]]).unwrap();
        assert!((distance - 2.0).abs() < 1e-15);
        // Extremes of scale, where the product of variances overflows.
        assert_eq!(squared_mahalanobis([1e150, 1e-150], [[1e300, 0.0], [0.0, 1e-300]]), Some(2.0));
    }
}
