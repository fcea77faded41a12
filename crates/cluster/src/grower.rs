//! Uncertain region growing.

use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;
use rand::seq::SliceRandom;
use terrace_stats::{Moments, UncertainVector};

use crate::distance::aligned;
use crate::{ClusterError, Interval, Segmentation};

/// How far the length of a normal may be from 1: single precision and a few rotations are within.
const UNIT: f64 = 1e-3;

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

/// The order in which unvisited nodes found clusters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SeedOrder {
    /// Smallest `s_x + s_y + s_z` first, the smaller node on a tie: clusters begin in the middle of surfaces.
    #[default]
    MostCertain,
    /// At random, as in the paper: the same `seed` gives the same order.
    Random {
        /// Seed of a ChaCha8 generator.
        seed: u64,
    },
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
        if omega.is_nan() || omega <= 0.0 {
            return Err(ClusterError::Omega { omega });
        }
        let nodes =
            u32::try_from(normals.len()).map_err(|_| ClusterError::TooManyNodes { nodes: normals.len() })?;
        for (node, normal) in normals.iter().enumerate() {
            let Some(n) = normal else { continue };
            if !n.is_finite() {
                return Err(ClusterError::Normal { node, normal: n.value });
            }
            let length = n.value.iter().map(|x| x * x).sum::<f64>().sqrt();
            if (length - 1.0).abs() > UNIT {
                return Err(ClusterError::Length { node, length });
            }
        }
        let total = |node: u32| normals[node as usize].map(|n| n.error.iter().sum::<f64>());
        let mut candidates: Vec<u32> =
            (0..nodes).filter(|node| total(*node).is_some_and(|s| s < omega)).collect();
        let mut takes_part = vec![false; normals.len()];
        for node in &candidates {
            takes_part[*node as usize] = true;
        }
        match seeds {
            SeedOrder::MostCertain => {
                let key = |node: u32| total(node).unwrap_or(f64::INFINITY);
                candidates.sort_by(|a, b| key(*a).total_cmp(&key(*b)));
            }
            SeedOrder::Random { seed } => candidates.shuffle(&mut ChaCha8Rng::seed_from_u64(seed)),
        }
        Ok(Self { normals, neighbours, candidates, takes_part, result: Segmentation::empty() })
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
        let mut interval = Interval::ALL;
        let mut tests = 0;
        for seed in &self.candidates {
            let seed_node = *seed as usize;
            let (None, Some(normal)) = (cluster_of[seed_node], &self.normals[seed_node]) else { continue };
            // Fewer clusters than nodes, which fit 32 bits.
            #[allow(clippy::cast_possible_truncation)]
            let number = clusters.len() as u32;
            let mut moments = Moments::default();
            moments.push(normal);
            cluster_of[seed_node] = Some(number);
            let mut member = nodes.len();
            nodes.push(*seed);
            while member < nodes.len() {
                for next in (self.neighbours)(nodes[member] as usize) {
                    let node = *next as usize;
                    if self.takes_part.get(node) != Some(&true) || cluster_of[node].is_some() {
                        continue;
                    }
                    let Some(normal) = &self.normals[node] else { continue };
                    let normal = aligned(normal, &moments);
                    let Some(squared) = moments.expected_squared_distance(&normal) else { continue };
                    tests += 1;
                    if interval.decide(0.5 * squared, phi) {
                        moments.push(&normal);
                        cluster_of[node] = Some(number);
                        nodes.push(*next);
                    }
                }
                member += 1;
            }
            clusters.push((nodes.len(), moments));
        }
        self.result.phi = phi;
        self.result.interval = interval;
        self.result.tests = tests;
        Ok(&self.result)
    }
}
