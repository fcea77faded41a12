//! The whole distribution of the values against χ²: Q-Q points, median, Kolmogorov and Smirnov.

use std::f64::consts::PI;

use crate::calibration::Calibration;
use crate::chi_squared::chi_squared_quantile;

/// What the test of Kolmogorov and Smirnov says of the values against χ².
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KolmogorovSmirnov {
    /// The greatest distance between the share of values below any point and the probability of χ² there, from 0 to 1.
    pub statistic: f64,
    /// The probability of at least this distance when the predictions are right and the errors Gaussian and independent,
    /// by the asymptotic distribution with Stephens' correction for small numbers. With thousands of values it is tiny
    /// for deviations that do not matter: look at the statistic as well.
    pub p_value: f64,
}

impl Calibration {
    /// Points of a Q-Q plot, as `[expected, observed]` in rising order: Mahalanobis distances, the roots of the values.
    ///
    /// The i-th value of n, counted from the least, stands against the χ² quantile of `(i − ½) / n`. Right predictions of
    /// Gaussian errors give points near the diagonal, variances too small by a factor f points near a line of slope √f,
    /// and heavy tails a curve that leaves the diagonal upwards.
    ///
    /// Of more than `points` values about so many are kept, never more, spread evenly over the expected distances so that
    /// the sparse ends stay, and always the least and the greatest; of `points = 1` the greatest. Empty without values.
    pub fn quantiles(&self, points: usize) -> Vec<[f64; 2]> {
        let sorted = self.sorted();
        let expected = |rank: usize| {
            let position = (rank as f64 + 0.5) / sorted.len() as f64;
            chi_squared_quantile(self.dimension(), position).map(f64::sqrt)
        };
        let point = |rank: usize| Some([expected(rank)?, sorted.get(rank)?.sqrt()]);
        let ranks = self.ranks(sorted.len(), points, expected);
        ranks.into_iter().filter_map(point).collect()
    }

    /// The ranks to show, in rising order.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to 0..n")]
    fn ranks(&self, n: usize, points: usize, expected: impl Fn(usize) -> Option<f64>) -> Vec<usize> {
        let Some(last) = n.checked_sub(1) else { return Vec::new() };
        if n <= points {
            return (0..n).collect();
        }
        let ends = (points > 1).then(|| Some((expected(0)?, expected(last)?))).flatten();
        let Some((low, high)) = ends else { return (last..n).take(points).collect() };
        let mut ranks: Vec<usize> = (0..points)
            .filter_map(|k| {
                let distance = low + (high - low) * k as f64 / (points - 1) as f64;
                let rank = self.probability(distance * distance)? * n as f64 - 0.5;
                Some(rank.round().clamp(0.0, last as f64) as usize)
            })
            .collect();
        // The ends by name: rounding must not lose them.
        if let (Some(first), true) = (ranks.first_mut(), points > 1) {
            *first = 0;
        }
        if let Some(end) = ranks.last_mut() {
            *end = last;
        }
        ranks.dedup();
        ranks
    }

    /// The median of the values over that of χ² with `D` degrees of freedom: like [`nees`](Self::nees) 1 when predictions
    /// are right and in proportion to how much too small variances are, but unmoved by a few errors however large.
    ///
    /// Far below `nees`, it tells of outliers rather than of a wrong scale. `None` without values.
    pub fn median_ratio(&self) -> Option<f64> {
        let sorted = self.sorted();
        let middle = sorted.len() / 2;
        let upper = *sorted.get(middle)?;
        let lower = if sorted.len().is_multiple_of(2) { *sorted.get(middle.checked_sub(1)?)? } else { upper };
        Some(f64::midpoint(lower, upper) / chi_squared_quantile(self.dimension(), 0.5)?)
    }

    /// Whether the values may come from χ² with `D` degrees of freedom at all; `None` without values.
    pub fn kolmogorov_smirnov(&self) -> Option<KolmogorovSmirnov> {
        let sorted = self.sorted();
        let n = sorted.len() as f64;
        let mut statistic: Option<f64> = None;
        for (rank, value) in sorted.iter().enumerate() {
            let probability = self.probability(*value)?;
            // The share of values steps from one to the other at this value.
            let apart = (probability - rank as f64 / n).max((rank as f64 + 1.0) / n - probability);
            statistic = Some(statistic.map_or(apart, |s| s.max(apart)));
        }
        let statistic = statistic?;
        Some(KolmogorovSmirnov {
            statistic,
            p_value: exceeded((n.sqrt() + 0.12 + 0.11 / n.sqrt()) * statistic),
        })
    }
}

/// The probability that Kolmogorov's variable exceeds x ≥ 0, by the series that converges faster on each side of 1.18.
fn exceeded(x: f64) -> f64 {
    let probability = if x < 0.04 {
        // Below e^(-π²/8x²) there is nothing left to add, and the series divides by x.
        1.0
    } else if x < 1.18 {
        let term = |j: i32| (-(f64::from(2 * j - 1) * PI / x).powi(2) / 8.0).exp();
        1.0 - (2.0 * PI).sqrt() / x * (1..=4).map(term).sum::<f64>()
    } else {
        let term = |j: i32| (-2.0 * (f64::from(j) * x).powi(2)).exp() * if j % 2 == 1 { 2.0 } else { -2.0 };
        (1..=4).map(term).sum()
    };
    probability.clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::exceeded;

    #[test]
    fn known_probabilities_of_kolmogorov() {
        // The usual critical values, and the two series where they meet.
        for (x, p) in [(0.0, 1.0), (1.223_848, 0.1), (1.358_099, 0.05), (1.627_624, 0.01), (1.949_475, 0.001)]
        {
            assert!((exceeded(x) - p).abs() < 1e-6, "{x} {}", exceeded(x));
        }
        assert!((exceeded(1.18 - 1e-12) - exceeded(1.18)).abs() < 1e-11);
        assert_eq!(exceeded(f64::INFINITY).to_bits(), 0.0_f64.to_bits());
    }
}
