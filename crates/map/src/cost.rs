//! The cost β of a threshold φ (section V).

use terrace_cluster::{ClusterError, Interval, Outcome, Stair, Staircase};
use terrace_crs::{Answer, Cost, Evaluation};

/// How the uncertainties of the clusters are summed up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum CostForm {
    /// Each cluster once, as the formula is printed: `Σᵢ (s_x + s_y + s_z)ᵢ`. It grows with every cluster, so that a
    /// cluster of many planes is hardly ever split.
    Sum,
    /// Each cluster by its share of the cells: `Σᵢ (nᵢ/n) (s_x + s_y + s_z)ᵢ`. It falls as clusters become purer,
    /// which is what the paper says of its first term.
    #[default]
    Share,
}

/// Bits of β's mantissa that are left out.
const ROUNDED_BITS: u32 = 22;

/// By how much a lower bound stays below: more than the rounding of β and of the sums it is made of.
const SLACK: f64 = 1e-8;

/// The cost of a clustering: its form and weights.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beta {
    /// How the clusters' uncertainties are summed up.
    pub form: CostForm,
    /// Weight w_nv of the uncertainties.
    pub weight_uncertainty: f64,
    /// Weight w_nc of the number of clusters.
    pub weight_clusters: f64,
}

impl Beta {
    /// `β = w_nv Σᵢ fᵢ (s_x + s_y + s_z)ᵢ + w_nc N_c`, with fᵢ = 1 or nᵢ/n by the [`CostForm`], n = `cells`.
    ///
    /// Rounded to 30 binary digits after the first, about 1e-9 of its size: the same clusters may be grown in another
    /// order, which changes their sums in the last digits, and a search must not take that for a lower cost.
    pub fn of(&self, stair: &Stair, cells: usize) -> f64 {
        rounded(self.exactly(stair, cells))
    }

    /// A number that [`Beta::of`] larger sums is never below.
    fn at_least(&self, stair: &Stair, cells: usize) -> f64 {
        self.exactly(stair, cells) * (1.0 - SLACK)
    }

    fn exactly(&self, stair: &Stair, cells: usize) -> f64 {
        let uncertainty = match self.form {
            CostForm::Sum => stair.uncertainty,
            CostForm::Share => stair.weighted_uncertainty / cells.max(1) as f64,
        };
        self.weight_uncertainty * uncertainty + self.weight_clusters * stair.clusters as f64
    }
}

/// To the nearest number with fewer digits; 0, infinities and NaN are as they were.
pub(crate) fn rounded(value: f64) -> f64 {
    let half = 1 << (ROUNDED_BITS - 1);
    // A carry out of the mantissa rightly raises the exponent.
    f64::from_bits((value.to_bits() + half) >> ROUNDED_BITS << ROUNDED_BITS)
}

/// β as a function of φ for the cells of one cluster: a staircase of one axis that knows its steps, and gives up early where
/// it is too high.
#[derive(Debug)]
pub struct PhiCost<'n, N> {
    staircase: Staircase<'n, N>,
    beta: Beta,
}

impl<'n, 'g, N: Fn(usize) -> &'g [u32]> PhiCost<'n, N> {
    /// The cost of the clusters that this staircase tells of.
    pub fn new(staircase: Staircase<'n, N>, beta: Beta) -> Self {
        Self { staircase, beta }
    }

    /// β at φ and the interval on which it is the same.
    ///
    /// # Errors
    /// [`ClusterError::Phi`] when `phi` is negative or not finite.
    pub fn step_at(&mut self, phi: f64) -> Result<BetaStep, ClusterError> {
        let cells = self.staircase.candidates();
        let stair = self.staircase.at(phi)?;
        Ok(BetaStep { beta: self.beta.of(&stair, cells), interval: stair.interval })
    }
}

impl<'g, N: Fn(usize) -> &'g [u32]> Cost for PhiCost<'_, N> {
    fn evaluate(&mut self, x: &[f64]) -> Evaluation {
        let [phi] = x else { return Evaluation::point(f64::NAN) };
        // A negative or non-finite φ has no cost; the search reports such an answer with its x.
        self.step_at(*phi).map_or(Evaluation::point(f64::NAN), |step| step.evaluation())
    }

    fn evaluate_below(&mut self, x: &[f64], ceiling: f64) -> Answer {
        let [phi] = x else { return Answer::Exact(Evaluation::point(f64::NAN)) };
        let (beta, cells) = (self.beta, self.staircase.candidates());
        match self.staircase.at_while(*phi, |stair| beta.at_least(stair, cells) < ceiling) {
            Ok(Outcome::Complete(stair)) => Answer::Exact(
                BetaStep { beta: beta.of(&stair, cells), interval: stair.interval }.evaluation(),
            ),
            Ok(Outcome::GivenUp(stair)) => {
                let least = BetaStep { beta: beta.at_least(&stair, cells), interval: stair.interval };
                Answer::AtLeast(least.evaluation())
            }
            Err(_) => Answer::Exact(Evaluation::point(f64::NAN)),
        }
    }

    fn dimension(&self) -> Option<usize> {
        Some(1)
    }
}

/// A step of the staircase: the cost and where it holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BetaStep {
    /// The cost.
    pub beta: f64,
    /// The φ for which it is the cost.
    pub interval: Interval,
}

impl BetaStep {
    fn evaluation(&self) -> Evaluation {
        Evaluation::interval(self.beta, self.interval.lo..self.interval.hi.unwrap_or(f64::INFINITY))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[allow(clippy::float_cmp, reason = "the values are exact")]
    fn rounding_leaves_a_billionth() {
        for same in [0.0, 1.0, 0.5, 3.0, f64::INFINITY] {
            assert_eq!(rounded(same), same);
            assert_eq!(rounded(same * (1.0 + 1e-14)), same);
            assert_eq!(rounded(same * (1.0 - 1e-14)), same);
        }
        assert!(rounded(f64::NAN).is_nan());
        let mut value = 1e-300;
        while value < 1e300 {
            assert!((rounded(value) / value - 1.0).abs() < 1e-9);
            value *= 1.37;
        }
    }
}
