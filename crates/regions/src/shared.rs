//! Errors that points have in common.

use glam::DVec3;
use terrace_stats::SymmetricMatrix3;

/// Errors that some points of a cell have in common, as those of one scan have that of its pose: they do not average out over these.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SharedNoise {
    /// The covariance that they give to a point, in the mean, in m².
    pub of_points: SymmetricMatrix3,
    /// The covariance that they give to the mean of all points, in m²: the same where all points are of one scan, half of it where half of
    /// them are of each of two.
    pub of_mean: SymmetricMatrix3,
}

impl SharedNoise {
    /// Points that are known apart from each other.
    pub const NONE: Self = Self { of_points: SymmetricMatrix3::ZERO, of_mean: SymmetricMatrix3::ZERO };

    pub(crate) fn is_finite(&self) -> bool {
        self.of_points.is_finite() && self.of_mean.is_finite()
    }

    /// By how much the mean square of these errors along a direction may be off, as a standard deviation, in m²: `σ² √(2/m)` of m scans
    /// that have as many points each.
    pub(crate) fn uncertainty(&self, direction: DVec3) -> f64 {
        let [of_points, of_mean] =
            [&self.of_points, &self.of_mean].map(|c| c.quadratic_form(direction.to_array()).max(0.0));
        (2.0 * of_points * of_mean).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_square_of_errors_of_a_few_scans_is_as_uncertain_as_that_of_a_few_deviates() {
        let of_points = SymmetricMatrix3::diagonal([4.0, 1.0, 0.0]);
        for scans in [1.0, 2.0, 8.0_f64] {
            let shared = SharedNoise { of_points, of_mean: of_points * (1.0 / scans) };
            // σ² √(2/m), of χ² with m degrees of freedom.
            for (axis, variance) in [(DVec3::X, 4.0), (DVec3::Y, 1.0), (DVec3::Z, 0.0)] {
                let expected = variance * (2.0 / scans).sqrt();
                assert!((shared.uncertainty(axis) - expected).abs() < 1e-12);
            }
        }
        assert_eq!(SharedNoise::NONE.uncertainty(DVec3::X).to_bits(), 0.0_f64.to_bits());
    }
}
