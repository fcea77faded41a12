//! How far the orientation of a node is from that of a cluster.

use terrace_stats::{Moments, UncertainVector};

/// The expected orientation distance `D = ½ E‖n − n_C‖²` of an uncertain unit normal `n` from the uncertain mean normal
/// `n_C` of a cluster, by Eq. (3) from the cluster's statistics. `None` for an empty cluster.
///
/// A normal and its opposite mean the same plane: the sign of `n` is chosen so that `n · L ≥ 0`. It does not matter which
/// of the two is given.
///
/// Without errors, and for a cluster of one direction, `D = 1 − cos` of the angle between them: 0 for parallel, 1 for
/// perpendicular. Errors add to it, half their squares.
///
/// ```
/// use terrace_cluster::orientation_distance;
/// use terrace_stats::{Moments, UncertainVector};
///
/// let mut cluster = Moments::default();
/// cluster.push(&UncertainVector::exact([0.0, 0.0, 1.0]));
/// let at = |degrees: f64| UncertainVector::exact([degrees.to_radians().sin(), 0.0, degrees.to_radians().cos()]);
/// let d = |degrees| orientation_distance(&at(degrees), &cluster).unwrap();
/// assert!((d(60.0) - 0.5).abs() < 1e-15);
/// assert!((d(180.0)).abs() < 1e-15);
/// ```
#[inline]
pub fn orientation_distance(normal: &UncertainVector, cluster: &Moments) -> Option<f64> {
    cluster.expected_squared_distance(&aligned(normal, cluster)).map(|squared| 0.5 * squared)
}

/// The normal with the sign that agrees with the cluster.
#[inline]
pub(crate) fn aligned(normal: &UncertainVector, cluster: &Moments) -> UncertainVector {
    let sum = cluster.sum();
    let along: f64 = (0..3).map(|i| normal.value[i] * sum[i]).sum();
    // Perpendicular, both signs are as near. The choice must not depend on the sign that was given, or the clusters would.
    let flip = along < 0.0 || along == 0.0 && first_is_negative(normal.value) != first_is_negative(sum);
    if flip { normal.flipped() } else { *normal }
}

/// Whether the first component that is not zero is negative: true for one of a vector and its opposite.
fn first_is_negative(v: [f64; 3]) -> bool {
    v.iter().find(|x| **x != 0.0).is_some_and(|x| *x < 0.0)
}

/// The mean of a cluster and the variance of it that the errors make: for many distances from one cluster.
pub(crate) struct Centre {
    mean: [f64; 3],
    variance: [f64; 3],
}

impl Centre {
    /// Of a cluster that is not empty.
    #[inline]
    pub(crate) fn of(cluster: &Moments) -> Self {
        let squared = cluster.weight() * cluster.weight();
        Self { mean: cluster.mean().unwrap_or_default(), variance: cluster.error().map(|e| e / squared) }
    }

    /// The same bits as [`Moments::expected_squared_distance`], with the divisions done before.
    #[inline]
    pub(crate) fn expected_squared_distance(&self, v: &UncertainVector) -> f64 {
        let terms = [0, 1, 2].map(|i| {
            let difference = v.value[i] - self.mean[i];
            difference * difference + v.error[i] * v.error[i] + self.variance[i]
        });
        terms[0] + terms[1] + terms[2]
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn vector() -> impl Strategy<Value = UncertainVector> {
        let value = prop::array::uniform3(-1.0..1.0f64);
        (value, prop::array::uniform3(0.0..1.0f64))
            .prop_map(|(value, error)| UncertainVector { value, error })
    }

    proptest! {
        #[test]
        fn the_centre_has_the_bits_of_the_moments(
            members in prop::collection::vec(vector(), 1..20),
            v in vector(),
        ) {
            let mut cluster = Moments::default();
            for member in &members {
                cluster.push(member);
                let squared = Centre::of(&cluster).expected_squared_distance(&v);
                prop_assert_eq!(Some(squared.to_bits()), cluster.expected_squared_distance(&v).map(f64::to_bits));
            }
        }
    }
}
