//! Sums of points that are quickly added.

use glam::DVec3;
use terrace_stats::{Moments, Stats, SymmetricMatrix3};

/// Numbers in the sums of some points: how many, their places, products of these, covariances of their errors.
const NUMBERS: usize = 16;

/// Sums of points about an anchor that is kept elsewhere, as numbers in a row: cells that are near each other have the same anchor, so
/// that adding is all there is to a union.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sum([f64; NUMBERS]);

impl Sum {
    pub(crate) const ZERO: Self = Self([0.0; NUMBERS]);

    /// Of points with this mean, relative to the anchor, and scatter about it, each with this covariance of its error in the mean.
    // Into what callers are dispatched to.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    pub(crate) fn of_mean(
        points: f64,
        mean: DVec3,
        scatter: &SymmetricMatrix3,
        noise: &SymmetricMatrix3,
    ) -> Self {
        let [x, y, z] = mean.to_array();
        let SymmetricMatrix3([xx, xy, xz, yy, yz, zz]) = scatter;
        let [a, b, c, d, e, f] = noise.0;
        let second = [xx + x * x, xy + x * y, xz + x * z, yy + y * y, yz + y * z, zz + z * z];
        let [xx, xy, xz, yy, yz, zz] = second;
        Self([1.0, x, y, z, xx, xy, xz, yy, yz, zz, a, b, c, d, e, f].map(|mean| points * mean))
    }

    pub(crate) fn points(&self) -> f64 {
        self.0[0]
    }

    // Into what callers are dispatched to.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    pub(crate) fn add(&mut self, other: &Self) {
        for (sum, more) in self.0.iter_mut().zip(&other.0) {
            *sum += more;
        }
    }

    /// The same points about an anchor that is less by `t`: see [`Moments::translated`].
    pub(crate) fn translated(&self, t: DVec3) -> Self {
        let moved = self.moments().translated(t.to_array());
        let mut numbers = self.0;
        numbers[1..4].copy_from_slice(&moved.sum());
        numbers[4..10].copy_from_slice(&moved.second().0);
        Self(numbers)
    }

    /// Scatter of the points about their mean, in m².
    pub(crate) fn covariance(&self) -> SymmetricMatrix3 {
        let [n, x, y, z, xx, xy, xz, yy, yz, zz, ..] = self.0;
        let share = 1.0 / n;
        let [x, y, z] = [x, y, z].map(|s| s * share);
        SymmetricMatrix3([
            (xx * share - x * x).max(0.0),
            xy * share - x * y,
            xz * share - x * z,
            (yy * share - y * y).max(0.0),
            yz * share - y * z,
            (zz * share - z * z).max(0.0),
        ])
    }

    /// Mean covariance of the errors, in m².
    pub(crate) fn noise(&self) -> SymmetricMatrix3 {
        let share = 1.0 / self.0[0];
        SymmetricMatrix3([10, 11, 12, 13, 14, 15].map(|i| self.0[i] * share))
    }

    pub(crate) fn stats(&self, anchor: DVec3) -> Stats {
        Stats::from_moments(anchor.to_array(), self.moments())
    }

    fn moments(&self) -> Moments {
        let [n, x, y, z, a, b, c, d, e, f, noise @ ..] = self.0;
        // Points are counted in whole numbers.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let count = n as u64;
        Moments::from_sums(count, [x, y, z], SymmetricMatrix3([a, b, c, d, e, f]), SymmetricMatrix3(noise))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cell::Sums;
    use terrace_stats::UncertainVector;

    #[test]
    fn unions_are_those_of_stats() {
        let place = |k: u32| [0.3, 0.7, 0.9].map(|by| 5.0 + (f64::from(k) * by).fract());
        let stats = |range: std::ops::Range<u32>| {
            let mut stats = Stats::new([5.5; 3]);
            range.for_each(|k| stats.push(&UncertainVector::isotropic(place(k), 0.01)));
            stats
        };
        let (one, other, mut both) = (stats(0..7), stats(7..20), stats(0..7));
        both.merge(&other);
        let about = |stats: &Stats, anchor| Sums::of(stats).unwrap().about(anchor);
        let (here, there) = (DVec3::new(5.0, 6.0, 4.0), DVec3::new(7.0, 5.0, 5.0));
        let mut sum = about(&one, here);
        sum.add(&about(&other, there).translated(there - here));
        let found = sum.stats(here);
        assert_eq!(found.count(), 20);
        let (a, b) = (found.covariance().unwrap(), both.covariance().unwrap());
        for i in 0..6 {
            assert!((a.0[i] - b.0[i]).abs() < 1e-12 && (sum.covariance().0[i] - b.0[i]).abs() < 1e-12);
            assert!((sum.noise().0[i] - both.moments().noise().0[i] / 20.0).abs() < 1e-15);
        }
    }
}
