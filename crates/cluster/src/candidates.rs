//! The nodes that take part, and the order in which they found clusters.

use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;
use rand::seq::SliceRandom;
use terrace_stats::UncertainVector;

use crate::ClusterError;
use crate::growth::total;

/// How far the length of a normal may be from 1: single precision and a few rotations are within.
const UNIT: f64 = 1e-3;

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

/// Checks the normals; the nodes whose normal is certain enough, in the order in which they may found a cluster.
///
/// # Errors
/// [`ClusterError`] when ω is not above 0, a normal is not finite or not of unit length, or there are too many nodes.
pub(crate) fn candidates(
    normals: &[Option<UncertainVector>],
    omega: f64,
    seeds: SeedOrder,
) -> Result<Vec<u32>, ClusterError> {
    if omega.is_nan() || omega <= 0.0 {
        return Err(ClusterError::Omega { omega });
    }
    let nodes =
        u32::try_from(normals.len()).map_err(|_| ClusterError::TooManyNodes { nodes: normals.len() })?;
    let mut certain = Vec::new();
    for (node, normal) in (0..nodes).zip(normals) {
        let Some(n) = normal else { continue };
        if !n.is_finite() {
            return Err(ClusterError::Normal { node: node as usize, normal: n.value });
        }
        let length = n.value.iter().map(|x| x * x).sum::<f64>().sqrt();
        if (length - 1.0).abs() > UNIT {
            return Err(ClusterError::Length { node: node as usize, length });
        }
        let total = total(n);
        if total < omega {
            certain.push((total, node));
        }
    }
    if seeds == SeedOrder::MostCertain {
        certain.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    }
    let mut order: Vec<u32> = certain.into_iter().map(|(_, node)| node).collect();
    if let SeedOrder::Random { seed } = seeds {
        order.shuffle(&mut ChaCha8Rng::seed_from_u64(seed));
    }
    Ok(order)
}
