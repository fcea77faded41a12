//! A better φ for an uncertain cluster (section V).

use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;
use terrace_cluster::{Cluster, ClusterError, Grower, Interval, SeedOrder, Segmentation, Staircase};
use terrace_crs::{Bounds, CertifiedSearch, ControlledRandomSearch, Cost, Minimum, Step, Stopping};

use crate::first::Alone;
use crate::{ExtractError, Optimise, Params, PhiCost, Search};

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

/// The order of founders in one cluster: at random, a different one for each.
pub(crate) fn seeds(cluster: &Alone, params: &Params) -> SeedOrder {
    match params.seed_order() {
        SeedOrder::Random { seed } => SeedOrder::Random { seed: seed ^ cluster.number as u64 },
        SeedOrder::MostCertain => SeedOrder::MostCertain,
    }
}

/// β as a function of φ for one cluster.
pub(crate) fn phi_cost<'a>(
    cluster: &'a Alone,
    params: &Params,
    optimise: &Optimise,
) -> Result<PhiCost<'a, impl Fn(usize) -> &'a [u32] + use<'a>>, ClusterError> {
    let neighbours = |node| cluster.graph.neighbours(node);
    let staircase = Staircase::new(&cluster.normals, neighbours, f64::INFINITY, seeds(cluster, params))?;
    Ok(PhiCost::new(staircase, optimise.beta()))
}

/// The φ of least cost. The φ in use is among the first that are asked for, so that the cost is never above the one
/// there.
pub(crate) fn search(
    cost: &mut impl Cost,
    how: Search,
    cluster: &Alone,
    params: &Params,
) -> Result<Minimum, ExtractError> {
    let start = vec![vec![params.phi]];
    // [0, 1] is an interval; the error is here for its type alone.
    let bounds = Bounds::interval(0.0, 1.0).map_err(|_| ClusterError::Phi { phi: params.phi })?;
    let minimum = match how {
        Search::Certified { evaluations } => {
            let stopping = Stopping { evaluations, ..Stopping::default() };
            let search = CertifiedSearch { start, stopping, ..CertifiedSearch::default() };
            in_the_middle(search.minimise(cost, &bounds)?)
        }
        Search::ControlledRandom { population, subset, rounds } => {
            let mut rng = ChaCha8Rng::seed_from_u64(params.seed);
            rng.set_stream(cluster.number as u64);
            let search = ControlledRandomSearch {
                population: Some(population),
                subset: Some(subset),
                start,
                stopping: Stopping { rounds: Some(rounds), ..Stopping::default() },
                ..ControlledRandomSearch::default()
            };
            search.minimise(cost, &bounds, &mut rng)?
        }
    };
    Ok(minimum)
}

/// Moves φ to the middle of its step in [0, 1]. The search likes to ask at the ends of steps, where a φ written with
/// fewer digits falls on the other side.
fn in_the_middle(mut minimum: Minimum) -> Minimum {
    if let (Step::Box { lo, hi }, [phi]) = (&minimum.step, &mut minimum.x[..])
        && let (&[lo], &[hi]) = (&lo[..], &hi[..])
    {
        let middle = f64::midpoint(lo.max(0.0), hi.min(1.0));
        if lo <= middle && middle < hi {
            *phi = middle;
        }
    }
    minimum
}

/// Clusters the cells of one cluster again at the φ of least cost.
pub(crate) fn split(cluster: &Alone, params: &Params, optimise: &Optimise) -> Result<Split, ExtractError> {
    let minimum = search(&mut phi_cost(cluster, params, optimise)?, optimise.search, cluster, params)?;
    let neighbours = |node| cluster.graph.neighbours(node);
    let mut grower = Grower::new(&cluster.normals, neighbours, f64::INFINITY, seeds(cluster, params))?;
    let run = grower.grow(minimum.x.first().copied().unwrap_or(params.phi))?;
    let parts =
        run.clusters().map(|part| Part::of(part, run, |local| cluster.nodes[local as usize])).collect();
    let record = Optimised {
        cells: cluster.nodes.len(),
        uncertainty_before: cluster.uncertainty,
        clusters: run.len(),
        minimum,
    };
    Ok(Split { parts, record })
}
