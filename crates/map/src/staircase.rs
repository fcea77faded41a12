//! The cost β over φ, step by step.

use terrace_crs::Cost;

use crate::first::First;
use crate::optimise::phi_cost;
use crate::{ExtractError, Interval, Mapper};

/// A step of the staircase: the cost and where it holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BetaStep {
    /// The cost.
    pub beta: f64,
    /// The φ for which it is the cost.
    pub interval: Interval,
}

impl Mapper {
    /// The cost β(φ), 0 ≤ φ ≤ 1, of an uncertain cluster, walked from step to step (φ ← hi): exact, and as long as the
    /// cluster has decisions. `number` counts the uncertain clusters as
    /// [`PlaneMap::optimised`](crate::PlaneMap::optimised) does; there are none without [`Params::optimise`]. At most
    /// `most` steps are walked.
    ///
    /// [`Params::optimise`]: crate::Params::optimise
    ///
    /// # Errors
    /// [`ExtractError::Empty`] when no point was inserted.
    pub fn staircase(&self, number: usize, most: usize) -> Result<Vec<BetaStep>, ExtractError> {
        let first = First::cluster(self, |_| {})?;
        let optimise = self.params().optimise.unwrap_or_default();
        let Some(cluster) = first.uncertain(self.params()).nth(number) else { return Ok(Vec::new()) };
        let cluster = first.part(cluster);
        let mut cost = phi_cost(&cluster, self.params(), &optimise)?;
        let mut steps = Vec::new();
        let mut phi = 0.0;
        while phi <= 1.0 && steps.len() < most {
            let beta = cost.evaluate(&[phi]).value;
            let interval = cost.interval();
            steps.push(BetaStep { beta, interval });
            let Some(hi) = interval.hi else { break };
            phi = hi;
        }
        Ok(steps)
    }
}
