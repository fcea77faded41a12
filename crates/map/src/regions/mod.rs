//! Planes as regions that are grown over cells at several resolutions.

mod coplanar;
mod error_level;
mod fine;

use rayon::prelude::*;
use terrace_grid::{CellId, VoxelGrid};
use terrace_normals::{UncertainNormal, canonical};
use terrace_regions::{Found, Region, find};
use terrace_stats::{Moments, UncertainVector};
use terrace_types::{Plane, PlaneId};

use crate::estimate::{Errors, Owned, estimate_planes};
use crate::facing::face_sensors;
use crate::first::used_of;
use crate::nodes::Nodes;
use crate::{
    CellCounts, ExtractError, ExtractedPlane, Grown, Join, LabelledCell, Mapper, PlaneMap, Regions, Stage,
    Used,
};

use coplanar::joined;
use fine::Fine;

/// A cell is of a plane when that share of its points is: what else it holds would pull at the covariance.
const MOSTLY: f64 = 0.9;
/// Points that are labelled by a thread at once.
const AT_ONCE: usize = 1 << 14;

impl Mapper {
    /// The planes as regions.
    pub(crate) fn extract_regions(
        &self,
        settings: &Regions,
        mut begins: impl FnMut(Stage),
    ) -> Result<PlaneMap, ExtractError> {
        let (grid, used) = used_of(self)?;
        let (Some(cells), Some(coarse)) = (self.fine(), self.coarse()) else {
            return Err(ExtractError::Empty);
        };
        begins(Stage::Normals { cells: grid.len() });
        let nodes = Nodes::of(grid, used.tau, self.params());

        begins(Stage::Grow { cells: cells.len() });
        let floor = self.params().estimate.unwrap_or_default().floor;
        let mut errors = Errors::of(self, &nodes, floor);
        let mut fine = Fine::of(cells, coarse);
        if !nodes.know_errors() {
            fine.find_errors(&mut errors);
        }
        let samples = |place: usize| fine.number(place).map_or(&[][..], |number| self.samples().of(number));
        let found = find(
            &fine.cells,
            cells.cell_size(),
            fine.cells.iter().map(|cell| cell.stats.count()).sum(),
            samples,
            &settings.settings(nodes.know_errors() && settings.errors_are_complete),
        )?;

        begins(Stage::Label { points: self.len() });
        let label = |(cell, place): (&Option<CellId>, &[f32; 3])| {
            let label = found.labeller.label(fine.place((*cell)?)?, *place)?;
            PlaneId::from_index(label as usize)
        };
        let kept = self.kept();
        let mut labels: Vec<Option<PlaneId>> =
            kept.cells.par_iter().zip(&kept.places).with_min_len(AT_ONCE).map(label).collect();
        let mut owner = OwnerOfCells { nodes: &nodes, of: fine.planes_of_cells(&found) };
        let mut planes = extracted(&found, &owner);
        if self.params().estimate.is_some() || settings.join == Join::Coplanar {
            errors = owner.estimate(&mut planes, grid, used.tau, errors);
        }
        if settings.join == Join::Coplanar
            && let Some(anew) = joined(&mut planes)
        {
            let renamed =
                |id: &mut Option<PlaneId>| *id = id.and_then(|id| anew.get(id.index()).copied().flatten());
            labels.par_iter_mut().for_each(renamed);
            owner.of.iter_mut().for_each(renamed);
            owner.describe(&mut planes);
            errors = owner.estimate(&mut planes, grid, used.tau, errors);
        }
        face_sensors(&mut planes, &labels, self.views());
        if self.params().estimate.is_none() {
            for plane in &mut planes {
                plane.estimate = None;
            }
        }
        let cells = owner.labelled();
        let cell_counts = CellCounts { occupied: grid.len(), dense: nodes.dense.len(), clustered: 0 };
        let grown =
            Grown { noise_scale: found.noise_scale, min_points: found.min_points, min_area: found.min_area };
        let used = Used { grown: Some(grown), ..used };
        Ok(PlaneMap { planes, labels, used, noise: errors.level, cells, cell_counts, optimised: Vec::new() })
    }
}

/// The plane that each cell is of.
struct OwnerOfCells<'n> {
    nodes: &'n Nodes,
    /// By cell.
    of: Vec<Option<PlaneId>>,
}

impl OwnerOfCells<'_> {
    fn of_nodes(&self) -> Vec<Option<PlaneId>> {
        self.nodes.dense.cells().iter().map(|cell| self.of.get(cell.index()).copied().flatten()).collect()
    }

    fn labelled(&self) -> Vec<LabelledCell> {
        let cells = self.nodes.stats.iter().zip(self.of_nodes());
        let labelled = cells
            .filter_map(|(s, plane)| Some(LabelledCell { centroid: s.mean()?, points: s.count(), plane }));
        labelled.collect()
    }

    /// Puts the estimates beside the planes, and gives back the errors.
    fn estimate<'m>(
        &self,
        planes: &mut [ExtractedPlane],
        grid: &VoxelGrid,
        tau: u64,
        errors: Errors<'m>,
    ) -> Errors<'m> {
        let cells = Owned { grid, nodes: self.nodes, plane_of_cell: &self.of, tau, errors };
        estimate_planes(planes, cells, &self.of_nodes())
    }

    /// Counts the cells of each plane, and how its normals scatter over them.
    fn describe(&self, planes: &mut [ExtractedPlane]) {
        let mut sums: Vec<(usize, Moments)> = vec![(0, Moments::EMPTY); planes.len()];
        for (normal, plane) in self.nodes.normals.iter().zip(self.of_nodes()) {
            let Some((id, (cells, sum))) = plane.and_then(|id| Some((id, sums.get_mut(id.index())?))) else {
                continue;
            };
            *cells += 1;
            let Ok(vector) = normal.as_ref().map(UncertainNormal::as_vector) else { continue };
            // A normal and its opposite are one plane.
            let towards = planes.get(id.index()).map_or([0.0; 3], |plane| plane.plane.normal());
            let turned = (0..3).map(|i| vector.value[i] * towards[i]).sum::<f64>() < 0.0;
            let value = if turned { vector.value.map(|x| -x) } else { vector.value };
            sum.push(&UncertainVector { value, ..vector });
        }
        for (plane, (cells, sum)) in planes.iter_mut().zip(sums) {
            plane.cells = cells;
            plane.normal_uncertainty = sum.variance_with_error().map(|v| v.map(|v| v.max(0.0).sqrt()));
        }
    }
}

fn extracted(found: &Found, owner: &OwnerOfCells) -> Vec<ExtractedPlane> {
    let plane = |(index, region): (usize, &Region)| {
        let plane = Plane::through(region.point, canonical(region.normal)).ok()?;
        Some(ExtractedPlane {
            id: PlaneId::from_index(index)?,
            plane,
            centroid: region.centroid,
            normal_uncertainty: None,
            estimate: None,
            points: region.points,
            cells: 0,
            rms: region.rms,
            phi: None,
            phi_interval: None,
        })
    };
    let mut planes: Vec<ExtractedPlane> = found.regions.iter().enumerate().filter_map(plane).collect();
    owner.describe(&mut planes);
    planes
}
