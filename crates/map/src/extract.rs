//! From the grid to planes.

use rayon::prelude::*;
use terrace_cluster::{Grower, Segmentation};
use terrace_grid::VoxelGrid;
use terrace_normals::{UncertainNormal, canonical, fit_plane};
use terrace_stats::{Stats, UncertainVector};
use terrace_types::{Plane, PlaneId};

use crate::nodes::Nodes;
use crate::optimise::{Part, split};
use crate::{ExtractError, ExtractedPlane, Mapper, Optimised, PlaneMap, Used};

/// A part of the work, reported when it begins: for progress and timings.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Planes are fitted to the neighbourhoods of the dense cells.
    Normals {
        /// Number of dense cells.
        cells: usize,
    },
    /// Cells are clustered at the first φ.
    Cluster {
        /// Number of cells that take part.
        cells: usize,
    },
    /// The φ of uncertain clusters is searched.
    Optimise {
        /// Number of uncertain clusters.
        clusters: usize,
    },
    /// Planes are fitted and points labelled.
    Label {
        /// Number of points.
        points: usize,
    },
}

impl Mapper {
    /// The planes of what was inserted so far. The map can grow on, and be asked again.
    ///
    /// # Errors
    /// [`ExtractError::Empty`] when no point was inserted.
    pub fn extract(&self) -> Result<PlaneMap, ExtractError> {
        self.extract_observed(|_| {})
    }

    /// [`Mapper::extract`], telling when each stage begins.
    ///
    /// # Errors
    /// As [`Mapper::extract`].
    pub fn extract_observed(&self, mut begins: impl FnMut(Stage)) -> Result<PlaneMap, ExtractError> {
        let grid = self.grid().filter(|grid| !grid.is_empty()).ok_or(ExtractError::Empty)?;
        let params = *self.params();
        let tau = params.tau.unwrap_or_else(|| tenth_of_median_density(grid));
        let used = Used { params, cell_size: grid.cell_size(), chosen: self.chosen_cell_size(), tau };

        begins(Stage::Normals { cells: grid.len() });
        let nodes = Nodes::of(self, grid, tau, &params);
        let normals: Vec<Option<UncertainVector>> =
            nodes.normals.iter().map(|n| n.as_ref().ok().map(UncertainNormal::as_vector)).collect();

        let mut grower =
            Grower::new(&normals, |node| nodes.dense.neighbours(node), params.omega, params.seed_order())?;
        let candidates = grower.candidates();
        begins(Stage::Cluster { cells: candidates });
        let first = grower.grow(params.phi)?;

        let uncertain = |c: &terrace_cluster::Cluster<'_>| {
            let worst = c.uncertainty().into_iter().fold(0.0, f64::max);
            params.optimise.is_some_and(|o| c.nodes().len() > 1 && worst > o.above)
        };
        begins(Stage::Optimise { clusters: first.clusters().filter(uncertain).count() });
        let (parts, optimised) = self.improve(first, &nodes, &normals, uncertain)?;

        begins(Stage::Label { points: self.len() });
        let (planes, plane_of_node) = fit_parts(&parts, &nodes, params.min_cells);
        let mut plane_of_cell = vec![None; grid.len()];
        for (cell, plane) in nodes.dense.cells().iter().zip(plane_of_node) {
            plane_of_cell[cell.index()] = plane;
        }
        let labels = self.cells_of_points().iter().map(|cell| plane_of_cell[(*cell)?.index()]).collect();
        Ok(PlaneMap { planes, labels, used, cells: [grid.len(), nodes.dense.len(), candidates], optimised })
    }

    /// Splits the uncertain clusters at their own φ and keeps the others.
    fn improve(
        &self,
        first: &Segmentation,
        nodes: &Nodes,
        normals: &[Option<UncertainVector>],
        uncertain: impl Fn(&terrace_cluster::Cluster<'_>) -> bool + Sync,
    ) -> Result<(Vec<Part>, Vec<Optimised>), ExtractError> {
        let params = self.params();
        let clusters: Vec<_> = first.clusters().enumerate().collect();
        let splits = clusters
            .into_par_iter()
            .map(|(number, cluster)| match &params.optimise {
                Some(optimise) if uncertain(&cluster) => {
                    let split = split(cluster, number, &nodes.dense, normals, params, optimise)?;
                    Ok((split.parts, Some(split.record)))
                }
                _ => Ok((vec![Part::of(cluster, first, |node| node)], None)),
            })
            .collect::<Result<Vec<_>, ExtractError>>()?;
        let mut parts = Vec::new();
        let mut records = Vec::new();
        for (of_cluster, record) in splits {
            parts.extend(of_cluster);
            records.extend(record);
        }
        Ok((parts, records))
    }
}

/// A tenth of the median number of points of a cell, and at least 4, so that a plane through a cell is more than its
/// three points.
fn tenth_of_median_density(grid: &VoxelGrid) -> u64 {
    let mut densities: Vec<u64> = grid.iter().map(|cell| cell.density()).collect();
    densities.sort_unstable();
    (densities.get(densities.len() / 2).copied().unwrap_or(0) / 10).max(4)
}

/// The planes of the parts with enough cells, sorted by points, and the plane of each node.
fn fit_parts(parts: &[Part], nodes: &Nodes, min_cells: usize) -> (Vec<ExtractedPlane>, Vec<Option<PlaneId>>) {
    let mut fitted: Vec<(Stats, Plane, f64, &Part)> = parts
        .iter()
        .filter(|part| part.nodes.len() >= min_cells)
        .filter_map(|part| {
            let stats = union(part, nodes)?;
            let fit = fit_plane(&stats).ok()?;
            let plane = Plane::through(fit.centroid, facing(fit.normal, part, nodes)).ok()?;
            Some((stats, plane, fit.rms(), part))
        })
        .collect();
    // Stable, and parts come in a fixed order: ties keep it.
    fitted.sort_by_key(|(stats, ..)| std::cmp::Reverse(stats.count()));
    let mut plane_of_node = vec![None; nodes.dense.len()];
    let planes = fitted
        .into_iter()
        .enumerate()
        .filter_map(|(index, (stats, plane, rms, part))| {
            let id = PlaneId::from_index(index)?;
            for node in &part.nodes {
                plane_of_node[*node as usize] = Some(id);
            }
            Some(ExtractedPlane {
                id,
                plane,
                centroid: stats.mean()?,
                normal_uncertainty: part.uncertainty,
                points: stats.count(),
                cells: part.nodes.len(),
                rms,
                phi: part.phi,
                phi_interval: part.interval,
            })
        })
        .collect();
    (planes, plane_of_node)
}

fn union(part: &Part, nodes: &Nodes) -> Option<Stats> {
    let mut all = Stats::new(nodes.stats.get(*part.nodes.first()? as usize)?.anchor());
    for node in &part.nodes {
        all.merge(&nodes.stats[*node as usize]);
    }
    Some(all)
}

/// The normal, turned the way most of the points were seen from.
fn facing(normal: [f64; 3], part: &Part, nodes: &Nodes) -> [f64; 3] {
    let votes: f64 = part
        .nodes
        .iter()
        .filter_map(|node| {
            let stats = &nodes.stats[*node as usize];
            let (sensor, centre) = (nodes.sensors[*node as usize]?, stats.mean()?);
            let side: f64 = (0..3).map(|i| normal[i] * (sensor[i] - centre[i])).sum();
            Some(side.signum() * stats.weight())
        })
        .sum();
    if votes == 0.0 {
        canonical(normal)
    } else if votes < 0.0 {
        normal.map(|x| -x)
    } else {
        normal
    }
}
