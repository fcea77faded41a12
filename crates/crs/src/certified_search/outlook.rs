//! How likely it is that an uncovered place lies lower: a trend with jitter.

/// Two variances in the square of the unit of the cost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Outlook {
    /// By which the trend differs between places that are the whole axis apart; it grows in proportion to the distance.
    pub(super) trend: f64,
    /// By which a single step differs from the trend.
    pub(super) jitter: f64,
}

/// The trend at a place: an estimate and its variance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Level {
    pub(super) mean: f64,
    pub(super) variance: f64,
}

/// The difference of two known values, and how far apart they are as a share of the axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pair {
    pub(super) distance: f64,
    pub(super) difference: f64,
}

/// The median of the absolute value of a standard normal variable.
const MEDIAN: f64 = 0.674_489_75;

/// Fewer pairs than this tell no jitter from trend.
const FEW: usize = 6;

impl Outlook {
    /// From the differences of neighbours. Medians, so that single steps that jump count as one.
    pub(super) fn estimate(pairs: &mut [Pair]) -> Self {
        // Not all of it is finite when values reach over half of all numbers: then no scale is known.
        for pair in &mut *pairs {
            pair.difference = pair.difference.abs().min(1e150);
        }
        if pairs.len() < FEW {
            let squares = pairs.iter().map(|pair| pair.difference.powi(2) / pair.distance.max(1e-3));
            let trend = squares.sum::<f64>() / pairs.len().max(1) as f64;
            return Self { trend, jitter: 0.0 };
        }
        let third = pairs.len() / 3;
        pairs.sort_unstable_by(|a, b| a.distance.total_cmp(&b.distance));
        let end = pairs.len() - third.max(2);
        let (near_distance, near) = typical(&mut pairs[..third.max(2)]);
        let (far_distance, far) = typical(&mut pairs[end..]);
        let (_, all) = typical(pairs);
        // Var = trend · distance + 2 jitter, near and far.
        let apart = far_distance - near_distance;
        let rise = if apart > 1e-3 * far_distance { (far - near) / apart } else { 0.0 };
        let trend = rise.max(0.1 * all / far_distance.max(1e-9));
        let jitter = ((near - trend * near_distance) / 2.0).max(0.0);
        Self { trend, jitter }
    }

    /// The value to be fallen below: lower than the lowest so far by a fiftieth of what the trend varies from end to end,
    /// lest the search stays where hardly anything is to be gained.
    pub(super) fn goal(&self, lowest: f64) -> f64 {
        lowest - 0.02 * self.trend.sqrt()
    }

    /// How many standard deviations `goal` lies above the mean at the place between two levels `width` apart, `at` from
    /// the first to the second. The higher, the more likely is a value below the goal.
    pub(super) fn between(&self, a: Level, b: Level, width: f64, at: f64, goal: f64) -> f64 {
        let Level { mean, variance } = self.level(a, b, width, at);
        standardised(goal - mean, variance + self.jitter)
    }

    /// The trend there.
    pub(super) fn level(&self, a: Level, b: Level, width: f64, at: f64) -> Level {
        let rest = 1.0 - at;
        let mean = rest * a.mean + at * b.mean;
        let variance = self.trend * width * at * rest + rest * rest * a.variance + at * at * b.variance;
        Level { mean, variance }
    }

    /// The trend `distance` away from the only known level.
    pub(super) fn beyond(&self, a: Level, distance: f64) -> Level {
        Level { mean: a.mean, variance: a.variance + self.trend * distance }
    }

    /// As [`between`](Self::between), with a level on one side only.
    pub(super) fn chance(&self, level: Level, goal: f64) -> f64 {
        standardised(goal - level.mean, level.variance + self.jitter)
    }

    /// The level at a place where `value` was found and `prior` expected.
    pub(super) fn update(&self, prior: Level, value: f64) -> Level {
        let gain = if prior.variance > 0.0 { prior.variance / (prior.variance + self.jitter) } else { 0.0 };
        Level { mean: prior.mean + gain * (value - prior.mean), variance: (1.0 - gain) * prior.variance }
    }

    /// The trend at all known steps: values in ascending order of place, each with its distance from the one before.
    /// The smoother of Rauch, Tung and Striebel for a random walk.
    pub(super) fn smooth(&self, known: &[(f64, f64)]) -> Vec<Level> {
        let mut levels: Vec<Level> = Vec::with_capacity(known.len());
        for &(distance, value) in known {
            levels.push(match levels.last() {
                None => Level { mean: value, variance: self.jitter },
                Some(before) => self.update(self.beyond(*before, distance), value),
            });
        }
        for here in (0..levels.len().saturating_sub(1)).rev() {
            let (next, filtered) = (levels[here + 1], levels[here]);
            let predicted = filtered.variance + self.trend * known[here + 1].0;
            if predicted > 0.0 {
                let gain = filtered.variance / predicted;
                levels[here] = Level {
                    mean: filtered.mean + gain * (next.mean - filtered.mean),
                    variance: filtered.variance + gain * gain * (next.variance - predicted),
                };
            }
        }
        levels
    }
}

fn standardised(difference: f64, variance: f64) -> f64 {
    if variance > 0.0 {
        difference / variance.sqrt()
    } else if difference > 0.0 {
        f64::INFINITY
    } else {
        f64::NEG_INFINITY
    }
}

/// The median distance, and the variance of differences of the median size.
fn typical(pairs: &mut [Pair]) -> (f64, f64) {
    let half = pairs.len() / 2;
    let distance = pairs.select_nth_unstable_by(half, |a, b| a.distance.total_cmp(&b.distance)).1.distance;
    let difference =
        pairs.select_nth_unstable_by(half, |a, b| a.difference.total_cmp(&b.difference)).1.difference;
    (distance, (difference / MEDIAN).powi(2))
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand::rngs::ChaCha8Rng;

    use super::*;
    use crate::draw::unit;

    /// About standard normal.
    fn normal(rng: &mut ChaCha8Rng) -> f64 {
        (0..12).map(|_| unit(rng)).sum::<f64>() - 6.0
    }

    /// A random walk with jitter, seen at unequal distances: distances, values, and the walk itself.
    fn walk(trend: f64, jitter: f64, count: usize) -> (Vec<(f64, f64)>, Vec<f64>) {
        let mut rng = ChaCha8Rng::seed_from_u64(8);
        let (mut known, mut levels, mut level) = (Vec::new(), Vec::new(), 0.0);
        for i in 0..count {
            let distance = if i % 3 == 0 { 5.0 } else { 0.05 } / count as f64;
            level += (trend * distance).sqrt() * normal(&mut rng);
            known.push((distance, level + jitter.sqrt() * normal(&mut rng)));
            levels.push(level);
        }
        (known, levels)
    }

    fn pairs(known: &[(f64, f64)]) -> Vec<Pair> {
        let pair = |pair: &[(f64, f64)]| Pair { distance: pair[1].0, difference: pair[1].1 - pair[0].1 };
        known.windows(2).map(pair).collect()
    }

    #[test]
    fn both_variances_are_found_again_within_a_third() {
        for (trend, jitter) in [(4.0, 1e-3), (1.0, 1e-4), (100.0, 0.01)] {
            let mut pairs = pairs(&walk(trend, jitter, 3000).0);
            // One in fifty jumps wildly.
            pairs.iter_mut().step_by(50).for_each(|pair| pair.difference *= 1e6);
            let found = Outlook::estimate(&mut pairs);
            assert!((found.trend / trend - 1.0).abs() < 0.33, "{found:?} for {trend}");
            assert!((found.jitter / jitter - 1.0).abs() < 0.33, "{found:?} for {jitter}");
        }
    }

    #[test]
    fn the_smoother_comes_nearer_to_the_trend_than_the_values_and_knows_by_how_much() {
        let (trend, jitter) = (1.0, 1e-3);
        let (known, levels) = walk(trend, jitter, 3000);
        let smooth = Outlook { trend, jitter }.smooth(&known);
        let count = levels.len() as f64;
        let off: f64 = smooth.iter().zip(&levels).map(|(s, l)| (s.mean - l).powi(2)).sum::<f64>() / count;
        let said: f64 = smooth.iter().map(|s| s.variance).sum::<f64>() / count;
        assert!(off < 0.6 * jitter, "{off}");
        assert!((off / said - 1.0).abs() < 0.1, "{off} and not {said}");
    }

    #[test]
    fn three_values_are_smoothed_as_by_hand() {
        // Minimise Σ (yᵢ - mᵢ)² / 1 + Σ (mᵢ₊₁ - mᵢ)² / 1 with y = 0, 0, 4: (2, -1, 0; -1, 3, -1; 0, -1, 2) m = y.
        let smooth = Outlook { trend: 1.0, jitter: 1.0 }.smooth(&[(0.0, 0.0), (1.0, 0.0), (1.0, 4.0)]);
        for (level, mean) in smooth.iter().zip([0.5, 1.0, 2.5]) {
            assert!((level.mean - mean).abs() < 1e-12, "{smooth:?}");
        }
    }

    #[test]
    fn the_chance_is_that_of_a_bridge() {
        let outlook = Outlook { trend: 2.0, jitter: 0.5 };
        let at = |mean| Level { mean, variance: 0.0 };
        // Variance 2 · 1 · 1/4 of the path and 1/2 of the jitter.
        assert_eq!(outlook.between(at(3.0), at(5.0), 1.0, 0.5, 2.0), -2.0);
        let certain = Outlook { trend: 0.0, jitter: 0.0 };
        assert_eq!(certain.between(at(1.0), at(1.0), 1.0, 0.5, 2.0), f64::INFINITY);
        assert_eq!(certain.between(at(1.0), at(1.0), 1.0, 0.5, 1.0), f64::NEG_INFINITY);
    }
}
