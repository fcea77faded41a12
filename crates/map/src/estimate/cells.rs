//! The plane around each dense cell, with both measures of how sure it is.

use rayon::prelude::*;
use terrace_grid::{CellId, VoxelKey, Walk};
use terrace_normals::UncertainNormal;

use super::columns::Near;
use super::level::{NoiseLevel, Residuals};
use super::noise_around::Among;
use super::{Errors, Owned, PlaneEstimate};
use crate::first::used_of;
use crate::nodes::Nodes;
use crate::{ExtractError, Mapper};

/// A dense cell and the plane through its neighbourhood.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CellPlane {
    /// The cell.
    pub cell: CellId,
    /// The index of its voxel.
    pub key: VoxelKey,
    /// Number of its points.
    pub points: u64,
    /// The plane fitted to its neighbourhood as [`Params::fit`](crate::Params::fit) says, with its min-max uncertainty
    /// (Definition 3).
    pub fitted: UncertainNormal,
    /// The plane of least variance through the block of columns around it, as many cells to each side as
    /// [`Params::depth`](crate::Params::depth), with its first-order covariance. Cells near an edge hold points of two surfaces:
    /// their [`growth`](PlaneEstimate::growth) tells. `None` as for planes.
    pub estimate: Option<PlaneEstimate>,
}

impl Mapper {
    /// The planes around the dense cells, in the order of their keys; cells whose neighbourhood determines none are left
    /// out. What [`Mapper::extract`] clusters are the fitted normals; the estimates are made here alone.
    ///
    /// # Errors
    /// [`ExtractError::Empty`] when no point was inserted.
    pub fn cell_planes(&self) -> Result<Vec<CellPlane>, ExtractError> {
        let params = self.params();
        let (grid, used) = used_of(self)?;
        let nodes = Nodes::of(grid, used.tau, params);
        let known = nodes.know_errors(grid);
        let floor = params.estimate.map_or(0.0, |settings| settings.floor);
        let mut owned = Owned {
            grid,
            nodes: &nodes,
            plane_of_cell: &[],
            tau: used.tau,
            errors: Errors::of(self, self.kept(), known, floor),
        };
        let mut possible = params.estimate.is_some() && params.by_place();
        if possible && !known {
            owned.errors.level = owned.level_of_neighbourhoods();
            possible = owned.errors.level.is_some();
        }
        let planes = (0..nodes.dense.len())
            .into_par_iter()
            .map_init(Walk::default, |walk, node| {
                let fitted = *nodes.normals.get(node)?.as_ref().ok()?;
                let cell = grid.get(*nodes.dense.cells().get(node)?)?;
                let around = walk.neighbourhood(&nodes.dense, node, params.depth.saturating_add(1));
                let estimate =
                    if possible { owned.around(cell.key(), around, &fitted, params.depth) } else { None };
                Some(CellPlane { cell: cell.id(), key: cell.key(), points: cell.density(), fitted, estimate })
            })
            .collect::<Vec<_>>();
        Ok(planes.into_iter().flatten().collect())
    }
}

impl Owned<'_, '_> {
    /// The level of noise that cells show along their normals.
    fn level_of_neighbourhoods(&self) -> Option<NoiseLevel> {
        let mut residuals = Residuals::default();
        for ((stats, normal), cell) in
            self.nodes.all_stats(self.grid).zip(&self.nodes.normals).zip(self.nodes.dense.cells())
        {
            if let Ok(normal) = normal {
                residuals.push(&self.errors, self.errors.seen(cell.index()), &stats, normal.fit.normal);
            }
        }
        NoiseLevel::of(&residuals)
    }

    /// Through the columns up to `depth` cells to each side of a cell; the nodes `around` it reach one further, so that it is
    /// known where the surface goes on.
    fn around(
        &self,
        key: VoxelKey,
        around: &[u32],
        fitted: &UncertainNormal,
        depth: u32,
    ) -> Option<PlaneEstimate> {
        let near = Near { centroid: fitted.fit.centroid.into(), normal: fitted.fit.normal.into() };
        let mut columns = self.columns(None, around, &near, self.errors.level.as_ref());
        if self.errors.level.is_some() {
            columns.take_noise_from_around(&near, Among::All);
        }
        let counts = columns.block(columns.place(key), depth);
        let mut found = columns.fit(&counts, near.normal)?;
        columns.take_back_cuts(&counts, &mut found, self.grid.cell_size());
        PlaneEstimate::of(&self.complete(found, &columns, &counts)?, fitted.fit.normal)
    }
}
