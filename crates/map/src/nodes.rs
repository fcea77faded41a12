//! The dense cells with their statistics and normals: the nodes of the clustering.

use rayon::prelude::*;
use terrace_grid::{DenseCells, VoxelGrid, Walk};
use terrace_normals::{Degenerate, Summary, UncertainNormal, estimate};
use terrace_stats::Stats;

use crate::Params;

/// Cells that are handed to a thread at once.
const AT_ONCE: usize = 1 << 10;

/// Dense cells in the order of their keys, with what is known of each.
#[derive(Debug, Clone)]
pub(crate) struct Nodes {
    pub(crate) dense: DenseCells,
    pub(crate) stats: Vec<Stats>,
    /// None before they are [found](Self::find_normals).
    pub(crate) normals: Vec<Result<UncertainNormal, Degenerate>>,
}

impl Nodes {
    /// Finds the dense cells and fits a plane to the neighbourhood of each (Definitions 2 and 3).
    pub(crate) fn of(grid: &VoxelGrid, tau: u64, params: &Params) -> Self {
        let mut nodes = Self::without_normals(grid, tau, params);
        nodes.find_normals(params);
        nodes
    }

    pub(crate) fn without_normals(grid: &VoxelGrid, tau: u64, params: &Params) -> Self {
        let dense = grid.dense(tau, params.connectivity);
        let stats: Vec<Stats> =
            dense.cells().iter().filter_map(|id| grid.get(*id)).map(|cell| cell.stats()).collect();
        Self { dense, stats, normals: Vec::new() }
    }

    pub(crate) fn find_normals(&mut self, params: &Params) {
        let Self { dense, stats, normals } = self;
        let cells: Vec<Summary> = stats.par_iter().with_min_len(AT_ONCE).map(Summary::of).collect();
        let found = (0..dense.len()).into_par_iter().map_init(Walk::default, |walk, node| {
            let around = walk.neighbourhood(dense, node, params.depth);
            estimate(around.iter().map(|near| &cells[*near as usize]), params.fit)
        });
        found.collect_into_vec(normals);
    }

    /// Whether the errors of any point are known.
    pub(crate) fn know_errors(&self) -> bool {
        self.stats.iter().any(|cell| cell.moments().noise().trace() > 0.0)
    }
}
