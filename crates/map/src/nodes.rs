//! The dense cells with their statistics and normals: the nodes of the clustering.

use rayon::prelude::*;
use terrace_grid::{CellId, DenseCells, VoxelGrid, Walk};
use terrace_normals::{Degenerate, Summary, UncertainNormal, estimate};
use terrace_stats::Stats;

use crate::Params;

/// Cells that are handed to a thread at once.
const AT_ONCE: usize = 1 << 10;

/// Dense cells in the order of their keys, with what is known of each.
#[derive(Debug, Clone)]
pub(crate) struct Nodes {
    pub(crate) dense: DenseCells,
    /// None before they are [found](Self::find_normals).
    pub(crate) normals: Vec<Result<UncertainNormal, Degenerate>>,
}

impl Nodes {
    /// Finds the dense cells and fits a plane to the neighbourhood of each (Definitions 2 and 3).
    pub(crate) fn of(grid: &VoxelGrid, tau: u64, params: &Params) -> Self {
        let mut nodes = Self::without_normals(grid, tau, params);
        nodes.find_normals(grid, params);
        nodes
    }

    pub(crate) fn without_normals(grid: &VoxelGrid, tau: u64, params: &Params) -> Self {
        let dense = grid.dense(tau, params.connectivity);
        Self { dense, normals: Vec::new() }
    }

    /// The statistics of the cell of a node of the grid.
    #[inline]
    pub(crate) fn stats(&self, grid: &VoxelGrid, node: usize) -> Option<Stats> {
        Some(grid.get(*self.dense.cells().get(node)?)?.stats())
    }

    /// Those of all nodes, which are cells of the grid.
    pub(crate) fn all_stats(&self, grid: &VoxelGrid) -> impl Iterator<Item = Stats> {
        self.dense.cells().iter().filter_map(|id| grid.get(*id)).map(|cell| cell.stats())
    }

    pub(crate) fn find_normals(&mut self, grid: &VoxelGrid, params: &Params) {
        let Self { dense, normals } = self;
        let summary = |id: &CellId| {
            // All are cells of the grid.
            Summary::of(&grid.get(*id).map_or(Stats::new([0.0; 3]), |cell| cell.stats()))
        };
        let cells: Vec<Summary> = dense.cells().par_iter().with_min_len(AT_ONCE).map(summary).collect();
        let found = (0..dense.len()).into_par_iter().map_init(Walk::default, |walk, node| {
            let around = walk.neighbourhood(dense, node, params.depth);
            estimate(around.iter().map(|near| &cells[*near as usize]), params.fit)
        });
        found.collect_into_vec(normals);
    }

    /// Whether the errors of any point are known.
    pub(crate) fn know_errors(&self, grid: &VoxelGrid) -> bool {
        self.all_stats(grid).any(|cell| cell.moments().noise().trace() > 0.0)
    }
}
