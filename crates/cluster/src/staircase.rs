//! The clustering at one threshold after the other, each repaired from the one before.

use terrace_stats::UncertainVector;

use crate::candidates::candidates;
use crate::growth::{Position, total};
use crate::repair::Clusters;
use crate::segmentation::uncertainty_of;
use crate::sums::{Sums, Term};
use crate::{ClusterError, Interval, SeedOrder};

/// What the clustering adds up to, at one threshold after the other: the same clusters as
/// [`Grower`](crate::Grower) makes, without listing them.
///
/// # Algorithm
/// What a cluster becomes depends on the threshold and on which of the nodes it touches belong to clusters founded
/// before it; and it knows the interval of thresholds on which its own decisions are the same. When the threshold
/// changes, the clusters whose interval does not hold the new one are grown again, earlier founded first, from the first
/// decision that comes out differently. Where a node is gained or lost by that, the later clusters that touch it are
/// grown again as well. All others stay. Every cluster is then what it would be in a run from the beginning, bit for bit.
///
/// One step up is mostly one decision: where a run compares all nodes, the repair compares part of one cluster.
///
/// # Complexity
/// Time in proportion to the nodes of the clusters grown again, and O(log n) for each of these clusters. A first or far
/// threshold costs a run. Memory: some 150 bytes per node that takes part, and 150 for each decision
/// that may be the first to come out differently at another threshold; there are few, about ln n of n.
///
/// ```
/// use terrace_cluster::{SeedOrder, Staircase};
/// use terrace_stats::UncertainVector;
///
/// // Three nodes in a row, each turned by some degrees from the one before.
/// let at = |degrees: f64| UncertainVector::exact([degrees.to_radians().cos(), degrees.to_radians().sin(), 0.0]);
/// let normals = [0.0, 10.0, 40.0].map(|degrees| Some(at(degrees)));
/// let edges: [&[u32]; 3] = [&[1], &[0, 2], &[1]];
/// let mut staircase = Staircase::new(&normals, |node| edges[node], 0.4, SeedOrder::MostCertain)?;
///
/// let mut clusters = Vec::new();
/// let mut phi = Some(0.0);
/// while let Some(at) = phi {
///     let stair = staircase.at(at)?;
///     clusters.push(stair.clusters);
///     phi = stair.interval.hi;
/// }
/// assert_eq!(clusters, [3, 2, 1]);
/// # Ok::<(), terrace_cluster::ClusterError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Staircase<'n, N> {
    normals: &'n [Option<UncertainVector>],
    neighbours: N,
    clusters: Clusters,
    /// By rank.
    sums: Sums,
    /// `s_x + s_y + s_z` over all candidates.
    errors: f64,
    /// `½ ‖ε‖²` of the candidates, falling: at a lower threshold the node is alone.
    alone: Vec<f64>,
    tests: u64,
}

/// What a segmentation adds up to, and on which thresholds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stair {
    /// Number of clusters N_c.
    pub clusters: usize,
    /// `Σᵢ (s_x + s_y + s_z)ᵢ` over the clusters.
    pub uncertainty: f64,
    /// `Σᵢ nᵢ (s_x + s_y + s_z)ᵢ`, nᵢ the nodes of cluster i.
    pub weighted_uncertainty: f64,
    /// The thresholds for which this is so.
    pub interval: Interval,
}

/// How far the clustering was repaired.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Outcome {
    /// To the end: the sums are those of the clusters.
    Complete(Stair),
    /// Not to the end: at every threshold of the interval the clusters add up to this or more, each sum.
    GivenUp(Stair),
}

impl<'n, 'g, N: Fn(usize) -> &'g [u32]> Staircase<'n, N> {
    /// Prepares the clustering of nodes with these normals, as [`Grower::new`](crate::Grower::new). Nodes that
    /// take part must be neighbours both ways.
    ///
    /// # Errors
    /// As [`Grower::new`](crate::Grower::new), and [`ClusterError::OneWay`].
    pub fn new(
        normals: &'n [Option<UncertainVector>],
        neighbours: N,
        omega: f64,
        seeds: SeedOrder,
    ) -> Result<Self, ClusterError> {
        let candidates = candidates(normals, omega, seeds)?;
        let mut takes_part = vec![false; normals.len()];
        for node in &candidates {
            takes_part[*node as usize] = true;
        }
        for from in &candidates {
            let one_way = |to: &&u32| {
                takes_part.get(**to as usize) == Some(&true) && !neighbours(**to as usize).contains(from)
            };
            if let Some(to) = neighbours(*from as usize).iter().find(one_way) {
                return Err(ClusterError::OneWay { from: *from as usize, to: *to as usize });
            }
        }
        let certain = || candidates.iter().filter_map(|node| normals[*node as usize].as_ref());
        let mut alone: Vec<f64> =
            certain().map(|n| 0.5 * n.error.iter().map(|e| e * e).sum::<f64>()).collect();
        alone.sort_unstable_by(|a, b| b.total_cmp(a));
        Ok(Self {
            normals,
            neighbours,
            sums: Sums::new(candidates.len()),
            errors: certain().map(total).sum(),
            alone,
            tests: 0,
            clusters: Clusters::new(normals.len(), candidates),
        })
    }

    /// How many nodes take part: those with a normal that is certain enough.
    pub fn candidates(&self) -> usize {
        self.clusters.len()
    }

    /// How many distances were compared with a threshold so far: a measure of the work done.
    pub fn tests(&self) -> u64 {
        self.tests
    }

    /// What the clusters at the threshold `phi` add up to. Cheapest at the end of the last interval.
    ///
    /// # Errors
    /// [`ClusterError::Phi`] when `phi` is negative or not finite.
    pub fn at(&mut self, phi: f64) -> Result<Stair, ClusterError> {
        match self.at_while(phi, |_| true)? {
            Outcome::Complete(stair) | Outcome::GivenUp(stair) => Ok(stair),
        }
    }

    /// As [`at`](Self::at), but gives up as soon as `keep` says `false` of what the clusters add up to at least: for
    /// a search that has seen something better. Clusters that were not looked at wait for a threshold that needs them.
    /// Once `false`, `keep` must stay so for larger sums.
    ///
    /// # What is certain before the end
    /// On one axis, with Q the squared deviations of n normals from their mean plus their squared errors, `n s = √(n Q)`.
    /// Two sets put together never have less than the sum of both: deviations from the joint mean are not smaller, and
    /// `√((n₁+n₂)(Q₁+Q₂)) ≥ √(n₁Q₁) + √(n₂Q₂)` (Cauchy and Schwarz). So `Σᵢ nᵢ sᵢ` is at least that of the clusters that
    /// are known, plus the errors of all other nodes, as if each stayed alone; and there is one more cluster at least if
    /// a node is left. All sums rise with the number of known clusters.
    ///
    /// A node whose own `½ ‖ε‖²` is above φ joins no cluster, and none joins it: with many such nodes no cluster need be known.
    /// The interval may then end inside a step: at the `½ ‖ε‖²` of a node.
    ///
    /// Sums are rounded, and so is what they are at least.
    ///
    /// # Errors
    /// As [`at`](Self::at).
    pub fn at_while(&mut self, phi: f64, keep: impl Fn(&Stair) -> bool) -> Result<Outcome, ClusterError> {
        if !phi.is_finite() || phi < 0.0 {
            return Err(ClusterError::Phi { phi });
        }
        let at_phi = self.alone.partition_point(|own| *own > phi);
        if let Some(stair) = fewest(at_phi, |alone| self.with_alone(alone), &keep) {
            return Ok(Outcome::GivenUp(stair));
        }
        let mut repaired = 0;
        loop {
            let other = self.sums.first_other(repaired, phi);
            let rank = self.clusters.first_waiting().into_iter().chain(other).min();
            let known = rank.unwrap_or(self.candidates());
            if let Some(stair) = fewest(known, |known| self.with_known(known), &keep) {
                return Ok(Outcome::GivenUp(stair));
            }
            let Some(rank) = rank else { return Ok(Outcome::Complete(self.with_known(known))) };
            let regrown = self.clusters.repair(rank, phi, self.normals, &self.neighbours);
            let term = regrown.map_or(Term::NOTHING, |regrown| {
                self.tests += regrown.tests;
                term(&regrown.end, regrown.interval)
            });
            self.sums.set(rank, term);
            repaired = rank + 1;
        }
    }

    /// What the clustering adds up to at least, when the clusters of all ranks before `known` are known.
    fn with_known(&self, known: usize) -> Stair {
        let sum = if known == self.candidates() { self.sums.total() } else { self.sums.before(known) };
        let others = sum.members < self.candidates();
        let errors_of_others = if others { (self.errors - sum.errors).max(0.0) } else { 0.0 };
        Stair {
            clusters: sum.clusters + usize::from(others),
            uncertainty: sum.uncertainty,
            weighted_uncertainty: sum.weighted + errors_of_others,
            interval: sum.interval,
        }
    }

    /// What the clustering adds up to at least, when this many nodes are alone: so at all thresholds below that of the
    /// last of them.
    fn with_alone(&self, alone: usize) -> Stair {
        let last = alone.checked_sub(1).and_then(|last| self.alone.get(last)).copied();
        // As everywhere, no end where no finite distance is refused.
        let hi = last.filter(|own| own.is_finite());
        Stair {
            clusters: alone + usize::from(alone < self.candidates()),
            uncertainty: 0.0,
            weighted_uncertainty: self.errors,
            interval: Interval { lo: 0.0, hi },
        }
    }
}

/// The sums with the least knowledge that are not to be kept, if those with all of it are not: fewer decisions
/// are shared by more thresholds.
fn fewest(all: usize, sums: impl Fn(usize) -> Stair, keep: impl Fn(&Stair) -> bool) -> Option<Stair> {
    if all == 0 || keep(&sums(all)) {
        return None;
    }
    let (mut few, mut enough) = (1, all);
    while few < enough {
        let middle = usize::midpoint(few, enough);
        if keep(&sums(middle)) {
            few = middle + 1;
        } else {
            enough = middle;
        }
    }
    Some(sums(enough))
}

fn term(end: &Position, interval: Interval) -> Term {
    let own: f64 = uncertainty_of(&end.moments).iter().sum();
    let (members, errors) = (end.nodes, end.errors);
    Term { clusters: 1, members, uncertainty: own, weighted: own * members as f64, errors, interval }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fewest_are_the_first_that_are_not_kept() {
        let stair = |clusters| Stair {
            clusters,
            uncertainty: 0.0,
            weighted_uncertainty: 0.0,
            interval: Interval::ALL,
        };
        for all in 0..20 {
            for ceiling in 0..25 {
                // Each number twice, so that there is a first.
                let found = fewest(all, |known| stair(known + known % 2), |stair| stair.clusters <= ceiling);
                let first = (1..=all).map(|known| known + known % 2).find(|clusters| *clusters > ceiling);
                assert_eq!(found.map(|stair| stair.clusters), first, "{all} {ceiling}");
            }
        }
    }
}
