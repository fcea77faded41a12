//! What is the same for every ω and φ: the dense cells and their normals.

use terrace_cluster::Grower;
use terrace_normals::UncertainNormal;
use terrace_stats::UncertainVector;

use crate::cost::rounded;
use crate::extract::fit_parts;
use crate::nodes::Nodes;
use crate::optimise::Part;
use crate::tune::gridded::Gridded;
use crate::tune::{Objective, Settings, TuneError, TuneStep};
use crate::{ExtractError, Params};

/// The dense cells of a grid at a density threshold, with the normals of their neighbourhoods.
pub(crate) struct Prepared {
    nodes: Nodes,
    normals: Vec<Option<UncertainVector>>,
    /// `s_x + s_y + s_z` of the normals, in rising order.
    totals: Vec<f64>,
}

impl Prepared {
    pub(crate) fn new(gridded: &Gridded, at: &Settings, params: &Params) -> Result<Self, TuneError> {
        let grid = gridded.mapper.grid().ok_or(ExtractError::Empty)?;
        let nodes = Nodes::of(grid, at.tau, &at.in_params(params));
        let certain = || nodes.normals.iter().map(|normal| normal.as_ref().ok());
        let normals: Vec<_> = certain().map(|n| n.map(UncertainNormal::as_vector)).collect();
        let mut totals: Vec<f64> = certain().flatten().map(UncertainNormal::total).collect();
        totals.sort_by(f64::total_cmp);
        Ok(Self { nodes, normals, totals })
    }

    /// The cost at settings with these dense cells and this depth.
    pub(crate) fn step(
        &self,
        gridded: &Gridded,
        at: &Settings,
        params: &Params,
        objective: &Objective,
    ) -> Result<TuneStep, TuneError> {
        let grid = gridded.mapper.grid().ok_or(ExtractError::Empty)?;
        let neighbours = |node| self.nodes.dense.neighbours(node);
        let mut grower = Grower::new(&self.normals, neighbours, at.omega, params.seed_order())
            .map_err(ExtractError::from)?;
        let run = grower.grow(at.phi).map_err(ExtractError::from)?;
        let parts: Vec<Part> = run.clusters().map(|cluster| Part::of(cluster, run, |node| node)).collect();
        let (planes, plane_of_node) = fit_parts(&parts, (grid, &self.nodes), params.min_cells);

        let mut plane_of_cell = vec![None; grid.len()];
        for (cell, plane) in self.nodes.dense.cells().iter().zip(plane_of_node) {
            plane_of_cell[cell.index()] = plane;
        }
        let value = objective.value(gridded, &planes, |cell| plane_of_cell.get(cell).copied().flatten())?;
        Ok(TuneStep {
            // The same clusters grown in another order have sums that differ in the last digits.
            value: rounded(value),
            tau: gridded.same_dense(at.tau),
            omega: self.same_certain(at.omega),
            phi: run.interval(),
        })
    }

    /// The ω with the same cells below them. A cell is certain enough when it is *below* ω, so a step begins just above
    /// one and ends just above the next.
    fn same_certain(&self, omega: f64) -> (f64, f64) {
        let at = self.totals.partition_point(|total| *total < omega);
        let below = at.checked_sub(1).and_then(|below| self.totals.get(below));
        // ω is above 0 whatever the cells.
        (below.copied().unwrap_or(0.0).next_up(), self.totals.get(at).map_or(f64::INFINITY, |t| t.next_up()))
    }
}
