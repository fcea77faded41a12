//! Planes as regions that are grown over cells at several resolutions.

mod coplanar;
mod directed;
mod error_level;
mod fine;
mod kept;
mod streamed;
mod tallies;

use std::borrow::Cow;

use rayon::prelude::*;
use terrace_grid::{CellIndex, VoxelGrid};
use terrace_normals::{UncertainNormal, canonical};
use terrace_regions::{Found, Grown as Surfaces, Labeller, Measure, Region};
use terrace_stats::{Moments, UncertainVector};
use terrace_types::{Plane, PlaneId};

use crate::estimate::{Errors, Owned, estimate_planes};
use crate::facing::{Seen, face_sensors};
use crate::first::used_of;
use crate::mapper::{FineCells, Kept};
use crate::nodes::Nodes;
use crate::{
    CellCounts, ExtractError, ExtractedPlane, Join, LabelledCell, Mapper, PlaneMap, Regions, Stage, Used,
};

use coplanar::joined;
use fine::Fine;
pub(crate) use streamed::RegionLabels;
use tallies::{Borrowed, Measures};

/// A cell is of a plane when that share of its points is: what else it holds would pull at the covariance.
const MOSTLY: f64 = 0.9;
/// Points whose labels change by a thread at once.
const AT_ONCE: usize = 1 << 13;

/// Regions of a map, before their points are labelled.
pub(crate) struct Grown<'m> {
    mapper: &'m Mapper,
    settings: Regions,
    grid: &'m VoxelGrid,
    used: Used,
    nodes: Nodes,
    errors: Errors<'m>,
    pub(crate) fine: Fine<'m>,
    /// What places of points are whole multiples of, in metres.
    unit: f64,
    /// Which cells there were, of a grid that was given away.
    index: Option<CellIndex>,
    pub(crate) found: Found,
}

impl Mapper {
    /// The planes as regions, and the labels of all points, of which these are kept. Of its fine cells, as [`Grown::of`] takes them.
    pub(crate) fn extract_regions(
        &self,
        cells: Option<FineCells<'_>>,
        settings: &Regions,
        kept: Cow<'_, [Kept]>,
        mut begins: impl FnMut(Stage),
    ) -> Result<PlaneMap, ExtractError> {
        let mut grown = Grown::of(self, cells, &kept, settings, &mut begins)?;
        begins(Stage::Label { points: self.len() });
        let (tags, by_view) = grown.label_kept(kept);
        let measures = summed(&by_view, grown.found.regions.len());
        let numbers = grown.found.by_measures(&measures);
        let number = |old: usize| PlaneId::from_index((*numbers.get(old)?)? as usize);
        // One list that becomes another is on one thread.
        let (mut labels, Planes { mut map, joined, .. }) =
            rayon::join(|| tags.into_labels(), || grown.planes());
        let numbers: Vec<Option<PlaneId>> = (0..numbers.len())
            .map(|old| number(old).and_then(|id| joined.as_ref().map_or(Some(id), |anew| anew[id.index()])))
            .collect();
        if (0..).zip(&numbers).any(|(old, new)| *new != PlaneId::from_index(old)) {
            let renamed = |id: &mut Option<PlaneId>| *id = id.and_then(|id| numbers[id.index()]);
            labels.par_iter_mut().with_min_len(AT_ONCE).for_each(renamed);
        }
        let seen = renumbered(&by_view, &numbers);
        face_sensors(&mut map.planes, &seen, self.views());
        map.labels = labels;
        Ok(map)
    }
}

/// How many points of each plane each view saw, by the numbers that planes have now.
pub(crate) fn renumbered(by_view: &[Measures], numbers: &[Option<PlaneId>]) -> Vec<Seen> {
    let of_view = |measures: &Measures| {
        let mut seen = Seen::new();
        for (region, measure) in measures {
            if let Some(number) = numbers.get(*region as usize).copied().flatten() {
                *seen.entry(number).or_default() += measure.points;
            }
        }
        seen
    };
    by_view.iter().map(of_view).collect()
}

impl<'m> Grown<'m> {
    /// Of the fine cells of a map, and what it keeps of its points: sums of cells that are given away are forgotten once
    /// regions can grow without them.
    pub(crate) fn of(
        mapper: &'m Mapper,
        cells: Option<FineCells<'_>>,
        kept: &[Kept],
        settings: &Regions,
        mut begins: impl FnMut(Stage),
    ) -> Result<Self, ExtractError> {
        let (grid, used) = used_of(mapper)?;
        let (Some(cells), Some(coarse), Some(samples)) = (cells, mapper.coarse(), mapper.samples()) else {
            return Err(ExtractError::Empty);
        };
        let FineCells { grid: cells, order } = cells;
        begins(Stage::Normals { cells: grid.len() });
        let (mut nodes, mut fine) = rayon::join(
            || Nodes::without_normals(grid, used.tau, mapper.params()),
            || Fine::of(&cells, coarse, samples),
        );

        begins(Stage::Grow { cells: grid.len() });
        let floor = mapper.params().estimate.unwrap_or_default().floor;
        let known = nodes.know_errors(grid);
        let mut errors = Errors::of(mapper, kept, known, floor);
        let settings_of_find = settings.settings(known && settings.errors_are_complete);
        let mut field = fine.field(&cells, order)?;
        if known {
            fine.add_errors_of_poses(&cells, &mut field, &errors)?;
        } else {
            fine.find_errors(&cells, &mut field, &mut errors)?;
        }
        let unit = cells.place_unit();
        let index = match cells {
            Cow::Borrowed(_) => None,
            // Only points that come again are told by where they are.
            Cow::Owned(cells) => mapper.is_streaming().then(|| cells.into_index()),
        };
        // Regions grow one after the other: what does not need them has the other threads.
        let beside = || {
            nodes.find_normals(grid, mapper.params());
            fine.sample_wholes();
        };
        let (grown, ()) = Surfaces::beside(field, &settings_of_find, beside)?;
        let mut found = grown.find(fine.points, |place| fine.sample(place));
        if !fine.places.is_empty() {
            found.labeller = found.labeller.by_parts(fine.places.iter().copied());
        }
        let grown = crate::Grown {
            noise_scale: found.noise_scale,
            min_points: found.min_points,
            min_area: found.min_area,
        };
        let used = Used { grown: Some(grown), ..used };
        Ok(Self { mapper, settings: *settings, grid, used, nodes, errors, fine, unit, index, found })
    }

    /// The planes with their covariances, joined where that is asked for.
    fn planes(self) -> Planes {
        let Self { mapper, settings, grid, used, nodes, mut errors, fine, index, found, .. } = self;
        let mut owner = OwnerOfCells { nodes: &nodes, of: fine.planes_of_cells(&found) };
        let mut planes = extracted(&found, &owner);
        let asked = mapper.params().estimate.is_some();
        if asked || settings.join == Join::Coplanar {
            errors = owner.estimate(&mut planes, grid, used.tau, errors);
        }
        for plane in &mut planes {
            if let Some(region) = found.regions.get(plane.id.index()) {
                plane.centroid = region.centroid;
            }
        }
        let anew = if settings.join == Join::Coplanar { joined(&mut planes) } else { None };
        if let Some(anew) = &anew {
            let renamed =
                |id: &mut Option<PlaneId>| *id = id.and_then(|id| anew.get(id.index()).copied().flatten());
            owner.of.iter_mut().for_each(renamed);
            owner.describe(&mut planes);
            errors = owner.estimate(&mut planes, grid, used.tau, errors);
        }
        if !asked {
            for plane in &mut planes {
                plane.estimate = None;
            }
        }
        let Found { labeller, .. } = found;
        let map = PlaneMap {
            planes,
            points: mapper.len(),
            labels: Vec::new(),
            used,
            noise: errors.level,
            cells: owner.labelled(grid),
            cell_counts: CellCounts { occupied: grid.len(), dense: nodes.dense.len(), clustered: 0 },
            optimised: Vec::new(),
        };
        Planes { map, joined: anew, labeller, index, of_cells: owner.of }
    }
}

/// The planes of regions, and what tells points of them.
struct Planes {
    map: PlaneMap,
    /// Which plane each region has become, where planes were joined.
    joined: Option<Vec<Option<PlaneId>>>,
    labeller: Labeller,
    index: Option<CellIndex>,
    /// The plane of each cell of the grid.
    of_cells: Vec<Option<PlaneId>>,
}

/// Labels points by their cells and places, and measures them by their regions.
fn label_each<P>(
    labeller: &Labeller,
    points: impl Iterator<Item = ((Option<u32>, [f32; 3]), P)>,
    measured: &mut Borrowed<'_>,
    label: impl FnMut(P, Option<u32>),
) {
    let points = points.map(|((cell, place), point)| (cell, place, point));
    labeller.label_into(points, &mut measured.tally, label);
}

/// What the points of all views measure together, by region.
fn summed(by_view: &[Measures], regions: usize) -> Vec<Measure> {
    let mut measures = vec![Measure::default(); regions];
    for (region, more) in by_view.iter().flatten() {
        if let Some(sum) = measures.get_mut(*region as usize) {
            sum.add(more);
        }
    }
    measures
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

    fn labelled(&self, grid: &VoxelGrid) -> Vec<LabelledCell> {
        let cells = self.nodes.all_stats(grid).zip(self.of_nodes());
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
            // Where covariances begin from: the same before and after points are labelled.
            centroid: region.point,
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
