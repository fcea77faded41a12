//! Uncertain region growing.

use terrace_stats::UncertainVector;

use crate::candidates::candidates;
use crate::growth::{Position, Rules, grow};
use crate::{ClusterError, Interval, SeedOrder, Segmentation};

/// Settings of the clustering.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Params {
    /// Orientation threshold φ: a node joins a cluster when its [distance](crate::orientation_distance) is at most
    /// this. Between 0 and 1 in the paper; without errors, `1 − cos` of an angle. Too high a value rounds corners.
    pub phi: f64,
    /// Uncertainty threshold ω: nodes whose normal has `s_x + s_y + s_z` of ω and more take no part. Too low a value
    /// leaves noisy surfaces out.
    pub omega: f64,
    /// Where clusters begin.
    pub seeds: SeedOrder,
}

impl Default for Params {
    /// φ = 0.1 (26 degrees without errors), ω = 0.4, most certain seeds first.
    fn default() -> Self {
        Self { phi: 0.1, omega: 0.4, seeds: SeedOrder::MostCertain }
    }
}

/// Clusters the same nodes at any number of thresholds, on reused memory.
///
/// `neighbours` answers the nodes directly connected to a node.
#[derive(Debug, Clone)]
pub struct Grower<'n, N> {
    normals: &'n [Option<UncertainVector>],
    neighbours: N,
    /// Nodes that take part, in the order in which they may found a cluster.
    candidates: Vec<u32>,
    takes_part: Vec<bool>,
    /// Which of them belong to no cluster yet.
    free: Vec<bool>,
    result: Segmentation,
}

/// Clusters nodes once: [`Grower::new`] and [`Grower::grow`].
///
/// # Errors
/// [`ClusterError`] for thresholds and normals that are not finite, and normals that are not of unit length.
pub fn segment<'g>(
    normals: &[Option<UncertainVector>],
    neighbours: impl Fn(usize) -> &'g [u32],
    params: &Params,
) -> Result<Segmentation, ClusterError> {
    let mut grower = Grower::new(normals, neighbours, params.omega, params.seeds)?;
    grower.grow(params.phi)?;
    Ok(grower.result)
}

impl<'n, 'g, N: Fn(usize) -> &'g [u32]> Grower<'n, N> {
    /// Prepares the clustering of nodes with these normals; nodes without one take no part.
    ///
    /// # Errors
    /// [`ClusterError`] when ω is not above 0, a normal is not finite or not of unit length, or there are too many nodes.
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
        let free = takes_part.clone();
        Ok(Self { normals, neighbours, candidates, takes_part, free, result: Segmentation::empty() })
    }

    /// How many nodes take part: those with a normal that is certain enough.
    pub fn candidates(&self) -> usize {
        self.candidates.len()
    }

    /// Clusters the nodes at the threshold `phi`.
    ///
    /// # Algorithm (section IV-A)
    /// 1. The first unvisited candidate founds a cluster, whose statistics are those of its normal.
    /// 2. Members are taken in the order in which they joined. Each unvisited neighbour is compared with the cluster as
    ///    it is *now*; when its distance is at most φ it joins, and the statistics are updated. A neighbour that was
    ///    refused is compared again when another member touches it.
    /// 3. When no member is left, go on at 1, until every candidate is visited.
    ///
    /// # Errors
    /// [`ClusterError::Phi`] when `phi` is negative or not finite.
    pub fn grow(&mut self, phi: f64) -> Result<&Segmentation, ClusterError> {
        if !phi.is_finite() || phi < 0.0 {
            return Err(ClusterError::Phi { phi });
        }
        let Segmentation { nodes, clusters, cluster_of, .. } = &mut self.result;
        nodes.clear();
        clusters.clear();
        cluster_of.clear();
        cluster_of.resize(self.normals.len(), None);
        self.free.clone_from(&self.takes_part);
        let mut run = Run { phi, interval: Interval::ALL, free: &mut self.free, cluster_of, number: 0 };
        let mut tests = 0;
        for founder in &self.candidates {
            let (true, Some(normal)) = (run.is_free(*founder), &self.normals[*founder as usize]) else {
                continue;
            };
            nodes.push(*founder);
            run.joined(*founder);
            let start = Position::founded(normal, nodes.len());
            let end = grow(self.normals, &self.neighbours, nodes, start, &mut run);
            tests += end.tests;
            clusters.push((nodes.len(), end.moments));
            run.number += 1;
        }
        self.result.interval = run.interval;
        self.result.phi = phi;
        self.result.tests = tests;
        Ok(&self.result)
    }
}

/// What a run knows while it goes.
struct Run<'r> {
    phi: f64,
    interval: Interval,
    free: &'r mut [bool],
    cluster_of: &'r mut [Option<u32>],
    /// The number of the cluster that grows.
    number: u32,
}

impl Rules for Run<'_> {
    #[inline]
    fn is_free(&self, node: u32) -> bool {
        self.free.get(node as usize) == Some(&true)
    }

    #[inline]
    fn joins(&mut self, distance: f64, _: impl FnOnce() -> Position) -> bool {
        self.interval.decide(distance, self.phi)
    }

    #[inline]
    fn joined(&mut self, node: u32) {
        self.free[node as usize] = false;
        self.cluster_of[node as usize] = Some(self.number);
    }
}
