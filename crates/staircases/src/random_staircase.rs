//! Staircases from a seed.

use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;
use terrace_crs::{Bounds, Cost, Evaluation};

use crate::draw::unit;
use crate::error::check_steps;
use crate::{ParameterError, Staircase, TestCost};

/// How the values of neighbouring steps of a [`RandomStaircase`] hang together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Kind {
    /// Not at all: vᵢ = uᵢ. The lowest step has neighbours like any other, so that no method can do better than to look
    /// at one step after another.
    White,
    /// By a random walk: vᵢ = Σ_{j ≤ i} (2 uⱼ - 1) / √*n*. Low steps have low neighbours, on all scales.
    Walk,
    /// By a valley with jitter: vᵢ = 2 |mᵢ - t| + uᵢ / 5, with mᵢ the middle of the step and t one place drawn in [0, 1):
    /// the cost of a threshold on noisy data.
    Trend,
}

/// A staircase with random borders and values, the same for the same seed.
///
/// * Formula: that of [`Staircase`]. The widths of the *n* steps are proportional to 0.1 - ln(1 - u): most are narrow, a
///   few wide, none is narrower than about a tenth of the mean. The values are those of the [`Kind`]. All u are drawn
///   uniformly in [0, 1) from ChaCha8: the widths, then t for [`Kind::Trend`], then the values.
/// * Domain: [0, 1].
/// * Optimum: the lowest value drawn.
/// * Steps: *n*.
///
/// ```
/// use terrace_staircases::{Kind, RandomStaircase, TestCost};
///
/// let cost = RandomStaircase::from_seed(7, 200, Kind::Walk)?;
/// assert_eq!(cost.step_count(), 200);
/// assert_eq!(cost, RandomStaircase::from_seed(7, 200, Kind::Walk)?);
/// assert_ne!(cost, RandomStaircase::from_seed(8, 200, Kind::Walk)?);
/// # Ok::<(), terrace_staircases::ParameterError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct RandomStaircase {
    staircase: Staircase,
    kind: Kind,
}

impl RandomStaircase {
    /// A staircase of so many `steps`.
    ///
    /// # Errors
    ///
    /// No steps, or more than ten million.
    pub fn from_seed(seed: u64, steps: usize, kind: Kind) -> Result<Self, ParameterError> {
        check_steps(steps)?;
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let widths: Vec<f64> = (0..steps).map(|_| 0.1 - (1.0 - unit(&mut rng)).ln()).collect();
        let total: f64 = widths.iter().sum();
        let mut sum = 0.0;
        let mut borders = vec![0.0];
        for width in &widths[1..] {
            sum += width;
            borders.push(sum / total);
        }
        borders.push(1.0);
        let values = values(&borders, kind, &mut rng);
        Ok(Self { staircase: Staircase::new(borders, values)?, kind })
    }

    /// The lists of borders and values.
    pub fn staircase(&self) -> &Staircase {
        &self.staircase
    }
}

fn values(borders: &[f64], kind: Kind, rng: &mut ChaCha8Rng) -> Vec<f64> {
    let steps = borders.windows(2);
    match kind {
        Kind::White => steps.map(|_| unit(rng)).collect(),
        Kind::Walk => {
            let scale = 1.0 / (steps.len() as f64).sqrt();
            let mut height = 0.0;
            let mut walk = |_| {
                height += (2.0 * unit(rng) - 1.0) * scale;
                height
            };
            steps.map(&mut walk).collect()
        }
        Kind::Trend => {
            let valley = unit(rng);
            steps.map(|ends| (ends[0] + ends[1] - 2.0 * valley).abs() + unit(rng) / 5.0).collect()
        }
    }
}

impl Cost for RandomStaircase {
    fn evaluate(&mut self, x: &[f64]) -> Evaluation {
        self.staircase.evaluate(x)
    }

    fn dimension(&self) -> Option<usize> {
        self.staircase.dimension()
    }
}

impl TestCost for RandomStaircase {
    fn name(&self) -> String {
        let kind = match self.kind {
            Kind::White => "white",
            Kind::Walk => "walk",
            Kind::Trend => "trend",
        };
        format!("{kind}-{}", self.step_count())
    }

    fn bounds(&self) -> Bounds {
        self.staircase.bounds()
    }

    fn minimum(&self) -> f64 {
        self.staircase.minimum()
    }

    fn minimiser(&self) -> Vec<f64> {
        self.staircase.minimiser()
    }

    fn step_count(&self) -> u128 {
        self.staircase.step_count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(kind: Kind) -> Vec<f64> {
        RandomStaircase::from_seed(1, 10_000, kind).unwrap().staircase().values().to_vec()
    }

    /// The mean of products of neighbouring deviations from the mean, over the variance.
    fn correlation(values: &[f64]) -> f64 {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let variance: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
        values.windows(2).map(|pair| (pair[0] - mean) * (pair[1] - mean)).sum::<f64>() / variance
    }

    #[test]
    fn white_values_are_uniform_and_do_not_hang_together() {
        let values = values(Kind::White);
        assert!(values.iter().all(|v| (0.0..1.0).contains(v)));
        assert!(correlation(&values).abs() < 0.05);
    }

    #[test]
    fn the_steps_of_a_walk_are_independent_and_of_its_size() {
        let values = values(Kind::Walk);
        let steps: Vec<f64> = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
        assert!(steps.iter().all(|step| step.abs() <= 0.01 + 1e-12) && correlation(&steps).abs() < 0.05);
        assert!(correlation(&values) > 0.99);
    }

    #[test]
    fn a_trend_is_a_valley_within_its_jitter() {
        let cost = RandomStaircase::from_seed(1, 10_000, Kind::Trend).unwrap();
        let valley = cost.minimiser()[0];
        for (ends, &value) in cost.staircase().borders().windows(2).zip(cost.staircase().values()) {
            let middle = f64::midpoint(ends[0], ends[1]);
            // The lowest step lies within 0.1 of the valley, which is 0.2 in value.
            assert!((value - 2.0 * (middle - valley).abs()).abs() <= 0.4 + 1e-9);
        }
    }

    #[test]
    fn widths_differ_but_none_is_too_narrow() {
        let cost = RandomStaircase::from_seed(1, 1000, Kind::White).unwrap();
        let widths: Vec<f64> = cost.staircase().borders().windows(2).map(|ends| ends[1] - ends[0]).collect();
        let narrowest = widths.iter().copied().fold(f64::INFINITY, f64::min);
        let widest = widths.iter().copied().fold(0.0, f64::max);
        assert!(narrowest > 0.5e-4 && widest > 4e-3, "{narrowest} {widest}");
    }

    #[test]
    fn one_step_is_possible_and_none_is_not() {
        assert_eq!(RandomStaircase::from_seed(1, 1, Kind::Trend).unwrap().step_count(), 1);
        assert_eq!(RandomStaircase::from_seed(1, 0, Kind::White), Err(ParameterError::NoSteps));
    }
}
