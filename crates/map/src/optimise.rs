//! A better φ for an uncertain cluster (section V).

use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;
use terrace_cluster::{Cluster, ClusterError, Grower, Interval, SeedOrder, Segmentation, Subgraph};
use terrace_crs::{Bounds, ControlledRandomSearch, Minimum, Stopping};
use terrace_grid::DenseCells;
use terrace_stats::UncertainVector;

use crate::{Optimise, Params, PhiCost};

/// What the search for φ did for one uncertain cluster.
#[derive(Debug, Clone, PartialEq)]
pub struct Optimised {
    /// Cells of the cluster.
    pub cells: usize,
    /// (s_x, s_y, s_z) of the cluster as first found.
    pub uncertainty_before: [f64; 3],
    /// The search: best φ, β there, the step it holds on, and every sample.
    pub minimum: Minimum,
    /// Clusters at the best φ.
    pub clusters: usize,
}

/// The parts an uncertain cluster falls into at its own φ.
pub(crate) struct Split {
    /// Nodes of the map, per part.
    pub(crate) parts: Vec<Part>,
    pub(crate) record: Optimised,
}

/// A set of nodes of the map that makes one cluster.
#[derive(Debug, Clone)]
pub(crate) struct Part {
    pub(crate) nodes: Vec<u32>,
    pub(crate) uncertainty: [f64; 3],
    pub(crate) phi: f64,
    pub(crate) interval: Interval,
}

impl Part {
    pub(crate) fn of(cluster: Cluster<'_>, run: &Segmentation, node: impl Fn(u32) -> u32) -> Self {
        Self {
            nodes: cluster.nodes().iter().map(|local| node(*local)).collect(),
            uncertainty: cluster.uncertainty(),
            phi: run.phi(),
            interval: run.interval(),
        }
    }
}

/// Clusters the cells of one cluster again at the φ of least cost.
///
/// The φ in use is in the first population, so that the cost never rises. `number` tells this cluster's random numbers
/// from those of the others, whatever thread works on it.
pub(crate) fn split(
    cluster: Cluster<'_>,
    number: usize,
    dense: &DenseCells,
    normals: &[Option<UncertainVector>],
    params: &Params,
    optimise: &Optimise,
) -> Result<Split, ClusterError> {
    // In order of the cells' keys: what follows then depends on the set of cells alone.
    let mut nodes = cluster.nodes().to_vec();
    nodes.sort_unstable();
    let graph = Subgraph::induced(&nodes, |node| dense.neighbours(node));
    let normals: Vec<_> = nodes.iter().map(|node| normals[*node as usize]).collect();
    let seeds = match params.seed_order() {
        SeedOrder::Random { seed } => SeedOrder::Random { seed: seed ^ number as u64 },
        certain @ SeedOrder::MostCertain => certain,
    };
    let grower = Grower::new(&normals, |node| graph.neighbours(node), f64::INFINITY, seeds)?;
    let mut cost = PhiCost::new(grower, optimise.form, optimise.weight_uncertainty, optimise.weight_clusters);
    let mut rng = ChaCha8Rng::seed_from_u64(params.seed);
    rng.set_stream(number as u64);
    let search = ControlledRandomSearch {
        population: Some(optimise.population),
        subset: Some(optimise.subset),
        start: vec![vec![params.phi]],
        stopping: Stopping { rounds: Some(optimise.rounds), ..Stopping::default() },
    };
    // Parameters were checked with the mapper, and β is finite for finite normals: a refusal means φ had no cost.
    let bounds = Bounds::interval(0.0, 1.0).map_err(|_| ClusterError::Phi { phi: params.phi })?;
    let minimum =
        search.minimise(&mut cost, &bounds, &mut rng).map_err(|_| ClusterError::Phi { phi: params.phi })?;
    let mut grower = cost.into_grower();
    let run = grower.grow(minimum.x.first().copied().unwrap_or(params.phi))?;
    let parts = run.clusters().map(|part| Part::of(part, run, |local| nodes[local as usize])).collect();
    let record = Optimised {
        cells: nodes.len(),
        uncertainty_before: cluster.uncertainty(),
        clusters: run.len(),
        minimum,
    };
    Ok(Split { parts, record })
}
