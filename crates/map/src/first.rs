//! The first clustering: all dense cells at one φ.

use terrace_cluster::{Grower, Segmentation, Subgraph};
use terrace_grid::VoxelGrid;
use terrace_normals::UncertainNormal;
use terrace_stats::UncertainVector;

use crate::nodes::Nodes;
use crate::{ExtractError, Mapper, Params, Stage, Used};

/// What the first clustering saw and found.
pub(crate) struct First<'m> {
    pub(crate) grid: &'m VoxelGrid,
    pub(crate) used: Used,
    pub(crate) nodes: Nodes,
    /// The normals of the nodes, as the clustering takes them.
    pub(crate) normals: Vec<Option<UncertainVector>>,
    /// How many nodes took part.
    pub(crate) clustered: usize,
    pub(crate) segmentation: Segmentation,
}

/// One cluster of the first clustering, on its own: what is needed to cluster it again.
pub(crate) struct Alone {
    /// Its number among the clusters: tells its random numbers from those of the others, whatever thread works on it.
    pub(crate) number: usize,
    /// Its nodes, in rising order: what follows then depends on the set of cells alone.
    pub(crate) nodes: Vec<u32>,
    /// Their normals and connections, numbered as in `nodes`.
    pub(crate) normals: Vec<Option<UncertainVector>>,
    pub(crate) graph: Subgraph,
    pub(crate) uncertainty: [f64; 3],
}

impl<'m> First<'m> {
    pub(crate) fn cluster(mapper: &'m Mapper, mut begins: impl FnMut(Stage)) -> Result<Self, ExtractError> {
        let (grid, used) = used_of(mapper)?;
        let (params, tau) = (used.params, used.tau);

        begins(Stage::Normals { cells: grid.len() });
        let nodes = Nodes::of(grid, tau, &params);
        let normals: Vec<_> =
            nodes.normals.iter().map(|n| n.as_ref().ok().map(UncertainNormal::as_vector)).collect();

        let neighbours = |node| nodes.dense.neighbours(node);
        let mut grower = Grower::new(&normals, neighbours, params.omega, params.seed_order())?;
        let clustered = grower.candidates();
        begins(Stage::Cluster { cells: clustered });
        let segmentation = grower.grow(params.phi)?.clone();
        Ok(Self { grid, used, nodes, normals, clustered, segmentation })
    }

    /// The numbers of the clusters whose orientation is uncertain, in rising order.
    pub(crate) fn uncertain(&self, params: &Params) -> impl Iterator<Item = usize> {
        let above = params.optimise.map_or(f64::INFINITY, |optimise| optimise.above);
        self.segmentation.clusters().enumerate().filter_map(move |(number, cluster)| {
            let worst = cluster.uncertainty().into_iter().fold(0.0, f64::max);
            (cluster.nodes().len() > 1 && worst > above).then_some(number)
        })
    }

    /// A cluster on its own; empty for a number that does not exist.
    pub(crate) fn part(&self, number: usize) -> Alone {
        let cluster = self.segmentation.cluster(number);
        let mut nodes = cluster.map(|c| c.nodes().to_vec()).unwrap_or_default();
        nodes.sort_unstable();
        Alone {
            number,
            normals: nodes.iter().map(|node| self.normals[*node as usize]).collect(),
            graph: Subgraph::induced(&nodes, |node| self.nodes.dense.neighbours(node)),
            uncertainty: cluster.map(|c| c.uncertainty()).unwrap_or_default(),
            nodes,
        }
    }
}

/// The grid, and the parameters with what is chosen from it.
pub(crate) fn used_of(mapper: &Mapper) -> Result<(&VoxelGrid, Used), ExtractError> {
    let grid = mapper.grid().filter(|grid| !grid.is_empty()).ok_or(ExtractError::Empty)?;
    let params = *mapper.params();
    let tau = params.tau.unwrap_or_else(|| tenth_of_median_density(grid));
    Ok((
        grid,
        Used { params, cell_size: grid.cell_size(), chosen: mapper.chosen_cell_size(), tau, grown: None },
    ))
}

/// A tenth of the median number of points of a cell, and at least 4, so that a plane through a cell is more than its
/// three points.
pub(crate) fn tenth_of_median_density(grid: &VoxelGrid) -> u64 {
    let mut densities: Vec<u64> = grid.founded().map(|cell| cell.density()).collect();
    let middle = densities.len() / 2;
    let median = if densities.is_empty() { 0 } else { *densities.select_nth_unstable(middle).1 };
    (median / 10).max(4)
}
