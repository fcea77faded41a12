//! The clusters whose orientation is uncertain, one by one: the cost of their φ, and searches of it.

use terrace_crs::{Cost, Minimum};

use crate::first::First;
use crate::optimise::{phi_cost, search};
use crate::{BetaStep, ExtractError, Mapper, Optimise, Params, Search};

/// The uncertain clusters of a first clustering, in the order of
/// [`PlaneMap::optimised`](crate::PlaneMap::optimised).
pub struct UncertainClusters<'m> {
    first: First<'m>,
    params: Params,
    optimise: Optimise,
    numbers: Vec<usize>,
}

impl Mapper {
    /// Clusters what was inserted so far once, to look at the clusters whose φ would be searched. There are none without
    /// [`Params::optimise`].
    ///
    /// # Errors
    /// [`ExtractError::Empty`] when no point was inserted.
    pub fn uncertain_clusters(&self) -> Result<UncertainClusters<'_>, ExtractError> {
        let first = First::cluster(self, |_| {})?;
        let params = *self.params();
        let numbers = first.uncertain(&params).collect();
        Ok(UncertainClusters { first, params, optimise: params.optimise.unwrap_or_default(), numbers })
    }
}

impl UncertainClusters<'_> {
    /// How many there are.
    pub fn len(&self) -> usize {
        self.numbers.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.numbers.is_empty()
    }

    /// The number of cells of a cluster; `None` for one that does not exist.
    pub fn cells(&self, index: usize) -> Option<usize> {
        Some(self.first.segmentation.cluster(*self.numbers.get(index)?)?.nodes().len())
    }

    /// The cost β(φ), 0 ≤ φ ≤ 1, of a cluster, step by step from 0 on, at most `most` steps: exact, and as long as the
    /// cluster has decisions. Empty for a cluster that does not exist.
    ///
    /// # Errors
    /// [`ExtractError::Cluster`] when the cluster cannot be clustered again.
    pub fn staircase(&self, index: usize, most: usize) -> Result<Vec<BetaStep>, ExtractError> {
        let Some(number) = self.numbers.get(index) else { return Ok(Vec::new()) };
        let cluster = self.first.part(*number);
        let mut cost = phi_cost(&cluster, &self.params, &self.optimise)?;
        let mut steps = Vec::new();
        let mut phi = 0.0;
        while phi <= 1.0 && steps.len() < most {
            let step = cost.step_at(phi)?;
            steps.push(step);
            let Some(hi) = step.interval.hi else { break };
            phi = hi;
        }
        Ok(steps)
    }

    /// Searches the φ of least cost of a cluster; `None` for one that does not exist.
    ///
    /// # Errors
    /// [`ExtractError`] when the search cannot be made.
    pub fn search(&self, index: usize, how: Search) -> Result<Option<Minimum>, ExtractError> {
        let Some(number) = self.numbers.get(index) else { return Ok(None) };
        let cluster = self.first.part(*number);
        let mut cost = phi_cost(&cluster, &self.params, &self.optimise)?;
        search(&mut cost, how, &cluster, &self.params).map(Some)
    }

    /// Calls `work` with the cost β(φ) of a cluster, for any other search of 0 ≤ φ ≤ 1; `None` for one that does not exist.
    ///
    /// # Errors
    /// [`ExtractError::Cluster`] when the cluster cannot be clustered again.
    pub fn with_cost<T>(
        &self,
        index: usize,
        work: impl FnOnce(&mut dyn Cost) -> T,
    ) -> Result<Option<T>, ExtractError> {
        let Some(number) = self.numbers.get(index) else { return Ok(None) };
        let cluster = self.first.part(*number);
        let mut cost = phi_cost(&cluster, &self.params, &self.optimise)?;
        Ok(Some(work(&mut cost)))
    }
}
