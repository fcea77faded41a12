//! The clusters whose orientation is uncertain, one by one: the cost of their φ, and searches of it.

use terrace_cluster::SeedOrder;
use terrace_crs::{Cost, Minimum};
use terrace_stats::UncertainVector;

use crate::first::{Alone, First};
use crate::optimise::{phi_cost, search, seeds};
use crate::{Beta, BetaStep, ExtractError, Mapper, Optimise, Params, Search};

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

    /// A cluster on its own; `None` for one that does not exist.
    pub fn get(&self, index: usize) -> Option<UncertainCluster<'_>> {
        let alone = self.first.part(*self.numbers.get(index)?);
        Some(UncertainCluster { alone, params: &self.params, optimise: &self.optimise })
    }

    /// All of them.
    pub fn iter(&self) -> impl Iterator<Item = UncertainCluster<'_>> {
        (0..self.len()).filter_map(|index| self.get(index))
    }
}

/// One uncertain cluster, to be clustered again.
pub struct UncertainCluster<'m> {
    alone: Alone,
    params: &'m Params,
    optimise: &'m Optimise,
}

impl UncertainCluster<'_> {
    /// The number of its cells: the nodes that are clustered.
    pub fn cells(&self) -> usize {
        self.alone.nodes.len()
    }

    /// The normals of its cells, each with its uncertainty.
    pub fn normals(&self) -> &[Option<UncertainVector>] {
        &self.alone.normals
    }

    /// The cells directly connected to a cell.
    pub fn neighbours(&self, cell: usize) -> &[u32] {
        self.alone.graph.neighbours(cell)
    }

    /// The order in which cells found clusters.
    pub fn seeds(&self) -> SeedOrder {
        seeds(&self.alone, self.params)
    }

    /// The cost of a clustering.
    pub fn beta(&self) -> Beta {
        self.optimise.beta()
    }

    /// The cost β(φ) of its clusters, for any search of 0 ≤ φ ≤ 1.
    ///
    /// # Errors
    /// [`ExtractError::Cluster`] when the cells cannot be clustered again.
    pub fn cost(&self) -> Result<impl Cost, ExtractError> {
        Ok(phi_cost(&self.alone, self.params, self.optimise)?)
    }

    /// β(φ), 0 ≤ φ ≤ 1, step by step from 0 on, at most `most` steps: exact, and as long as the cluster has decisions.
    ///
    /// # Errors
    /// [`ExtractError::Cluster`] when the cells cannot be clustered again.
    pub fn staircase(&self, most: usize) -> Result<Vec<BetaStep>, ExtractError> {
        let mut cost = phi_cost(&self.alone, self.params, self.optimise)?;
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

    /// Searches the φ of least cost.
    ///
    /// # Errors
    /// [`ExtractError`] when the search cannot be made.
    pub fn search(&self, how: Search) -> Result<Minimum, ExtractError> {
        let mut cost = phi_cost(&self.alone, self.params, self.optimise)?;
        search(&mut cost, how, &self.alone, self.params)
    }
}
