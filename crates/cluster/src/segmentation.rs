//! The clusters found.

use terrace_stats::Moments;

use crate::{Interval, Stair};

/// The result of one run of the clustering. Clusters are in the order in which they were founded.
#[derive(Debug, Clone, PartialEq)]
pub struct Segmentation {
    /// Nodes of the first cluster, then those of the second, and so on.
    pub(crate) nodes: Vec<u32>,
    /// Where each cluster ends in `nodes`, and the statistics of its normals.
    pub(crate) clusters: Vec<(usize, Moments)>,
    pub(crate) cluster_of: Vec<Option<u32>>,
    pub(crate) phi: f64,
    pub(crate) interval: Interval,
    pub(crate) tests: u64,
}

/// One cluster of a [`Segmentation`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cluster<'a> {
    nodes: &'a [u32],
    moments: &'a Moments,
}

impl<'a> Cluster<'a> {
    /// The member nodes in the order in which they joined, the seed first.
    pub fn nodes(&self) -> &'a [u32] {
        self.nodes
    }

    /// Statistics of the members' normals, each with the sign in which it joined, about the origin.
    pub fn moments(&self) -> &'a Moments {
        self.moments
    }

    /// The mean of the members' normals, not of unit length: the shorter, the more they differ.
    pub fn mean_normal(&self) -> [f64; 3] {
        self.moments.mean().unwrap_or_default()
    }

    /// The uncertainty (s_x, s_y, s_z) of the orientation: per axis the root of the dispersion of the members' normals
    /// plus their mean squared error, `s² = S/n − (L/n)² + E/n`.
    pub fn uncertainty(&self) -> [f64; 3] {
        uncertainty_of(self.moments)
    }
}

/// (s_x, s_y, s_z) of a cluster; zero for one without members.
pub(crate) fn uncertainty_of(moments: &Moments) -> [f64; 3] {
    moments.variance_with_error().unwrap_or_default().map(f64::sqrt)
}

impl Segmentation {
    pub(crate) fn empty() -> Self {
        Self {
            nodes: Vec::new(),
            clusters: Vec::new(),
            cluster_of: Vec::new(),
            phi: 0.0,
            interval: Interval::ALL,
            tests: 0,
        }
    }

    /// Number of clusters.
    pub fn len(&self) -> usize {
        self.clusters.len()
    }

    /// Whether no node could take part.
    pub fn is_empty(&self) -> bool {
        self.clusters.is_empty()
    }

    /// The cluster of this number, from 0.
    pub fn cluster(&self, number: usize) -> Option<Cluster<'_>> {
        let (end, moments) = self.clusters.get(number)?;
        let start = number.checked_sub(1).map_or(0, |before| self.clusters[before].0);
        Some(Cluster { nodes: &self.nodes[start..*end], moments })
    }

    /// All clusters.
    pub fn clusters(&self) -> impl ExactSizeIterator<Item = Cluster<'_>> {
        let mut start = 0;
        self.clusters.iter().map(move |(end, moments)| {
            let nodes = &self.nodes[start..*end];
            start = *end;
            Cluster { nodes, moments }
        })
    }

    /// The number of the cluster that `node` belongs to; `None` for nodes that took no part.
    pub fn cluster_of(&self, node: usize) -> Option<usize> {
        self.cluster_of.get(node).copied().flatten().map(|cluster| cluster as usize)
    }

    /// The threshold of the run.
    pub fn phi(&self) -> f64 {
        self.phi
    }

    /// The thresholds for which this is the result.
    pub fn interval(&self) -> Interval {
        self.interval
    }

    /// What the clusters add up to.
    pub fn stair(&self) -> Stair {
        let mut sums = Stair {
            clusters: self.len(),
            uncertainty: 0.0,
            weighted_uncertainty: 0.0,
            interval: self.interval,
        };
        for cluster in self.clusters() {
            let own: f64 = cluster.uncertainty().iter().sum();
            sums.uncertainty += own;
            sums.weighted_uncertainty += own * cluster.nodes().len() as f64;
        }
        sums
    }

    /// How many distances were compared with the threshold.
    pub fn tests(&self) -> u64 {
        self.tests
    }
}
