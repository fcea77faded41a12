//! From the grid to planes.

use std::borrow::Cow;

use rayon::prelude::*;
use terrace_grid::VoxelGrid;
use terrace_normals::{canonical, fit_plane};
use terrace_stats::Stats;
use terrace_types::{Plane, PlaneId};

use crate::estimate::{Errors, Owned, estimate_planes};
use crate::facing::{face_sensors, seen_by};
use crate::first::First;
use crate::mapper::{FineCells, Kept, Tags, in_one_piece, number_of};
use crate::nodes::Nodes;
use crate::optimise::{Part, split};
use crate::{CellCounts, ExtractError, ExtractedPlane, LabelledCell, Mapper, Optimised, Params, PlaneMap};

/// A part of the work, reported when it begins: for progress and timings.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Planes are fitted to the neighbourhoods of the dense cells.
    Normals {
        /// Number of cells with a point. Those that are dense get a plane.
        cells: usize,
    },
    /// Regions are grown.
    Grow {
        /// Number of cells with a point.
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
    ///
    /// Where points are [not kept](Mapper::streaming) there are no labels, see [`Mapper::extract_streamed`]; planes then face the sensors
    /// from which most points of their cells were seen.
    pub fn extract(&self) -> Result<PlaneMap, ExtractError> {
        self.extract_observed(|_| {})
    }

    /// [`Mapper::extract`], telling when each stage begins.
    ///
    /// # Errors
    /// As [`Mapper::extract`].
    pub fn extract_observed(&self, begins: impl FnMut(Stage)) -> Result<PlaneMap, ExtractError> {
        if self.is_streaming() {
            let (mut map, labels) = self.extract_streamed(begins)?;
            labels.face_by_cells(&mut map);
            return Ok(map);
        }
        self.extract_kept(self.fine_cells(), Cow::Borrowed(self.kept()), begins)
    }

    /// [`Mapper::extract_observed`], to the bit, of a map that is not needed any more: labels take the place of what is kept of the points,
    /// in less memory and time.
    ///
    /// ```
    /// use terrace::{Frame, Mapper, Params, Scan, Sigma};
    ///
    /// let floor = (0..10_000).map(|k| [0.02 * f64::from(k % 100), 0.02 * f64::from(k / 100), 0.0]);
    /// let scan = Scan::new(floor.collect(), Sigma::Uniform(0.005), Frame::World { sensor: None })?;
    /// let mut mapper = Mapper::new(Params::default())?;
    /// mapper.insert(&scan)?;
    /// let map = mapper.into_planes(|stage| println!("{stage:?}"))?;
    /// assert_eq!((map.planes.len(), map.labels.len()), (1, 10_000));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`Mapper::extract`]; the map is gone then, too.
    pub fn into_planes(mut self, begins: impl FnMut(Stage)) -> Result<PlaneMap, ExtractError> {
        if self.is_streaming() {
            let (mut map, labels) = self.into_streamed(begins)?;
            labels.face_by_cells(&mut map);
            return Ok(map);
        }
        let kept = Cow::Owned(self.take_kept());
        // Clusters are made of the cells themselves.
        let cells = if self.params().grows().is_some() { self.take_fine() } else { None };
        self.extract_kept(cells, kept, begins)
    }

    /// The planes, and the labels of all points that are kept; as regions of these fine cells, which a map that is given away forgets.
    pub(crate) fn extract_kept(
        &self,
        cells: Option<FineCells<'_>>,
        kept: Cow<'_, [Kept]>,
        begins: impl FnMut(Stage),
    ) -> Result<PlaneMap, ExtractError> {
        match self.params().grows() {
            Some(regions) => self.extract_regions(cells, &regions, kept, begins),
            None => self.extract_clusters(kept, begins),
        }
    }

    /// The planes as clusters.
    fn extract_clusters(
        &self,
        kept: Cow<'_, [Kept]>,
        begins: impl FnMut(Stage),
    ) -> Result<PlaneMap, ExtractError> {
        let (mut map, plane_of_cell) = self.clusters(&kept, begins)?;
        map.labels = match in_one_piece(kept) {
            Ok(Kept { cells, .. }) => {
                let mut tags = Tags::of(cells);
                tags.as_mut_slice().par_iter_mut().for_each(|tag| {
                    let plane = number_of(*tag).and_then(|cell| plane_of_cell[cell as usize]);
                    *tag = plane.map_or(0, PlaneId::get);
                });
                tags.into_labels()
            }
            Err(kept) => {
                let mut labels = Vec::with_capacity(self.len());
                for kept in kept.iter() {
                    labels.par_extend(kept.cells.par_iter().map(|cell| plane_of_cell[(*cell)?.index()]));
                }
                labels
            }
        };
        let seen = seen_by(self.views(), &map.labels, map.planes.len());
        face_sensors(&mut map.planes, &seen, self.views());
        Ok(map)
    }

    /// The planes as clusters, the uncertain ones at the φ of least cost, and the plane of each cell.
    pub(crate) fn clusters(
        &self,
        kept: &[Kept],
        mut begins: impl FnMut(Stage),
    ) -> Result<(PlaneMap, Vec<Option<PlaneId>>), ExtractError> {
        let first = First::cluster(self, &mut begins)?;
        begins(Stage::Optimise { clusters: first.uncertain(self.params()).count() });
        let (parts, optimised) = improve(&first, self.params())?;

        begins(Stage::Label { points: self.len() });
        let First { grid, nodes, used, clustered, .. } = first;
        let (mut planes, plane_of_node) = fit_parts(&parts, (grid, &nodes), self.params().min_cells);
        let mut plane_of_cell = vec![None; grid.len()];
        for (cell, plane) in nodes.dense.cells().iter().zip(&plane_of_node) {
            plane_of_cell[cell.index()] = *plane;
        }
        let estimated = self.params().estimate.filter(|_| self.params().by_place()).map(|settings| {
            let errors = Errors::of(self, kept, nodes.know_errors(grid), settings.floor);
            let cells = Owned { grid, nodes: &nodes, plane_of_cell: &plane_of_cell, tau: used.tau, errors };
            estimate_planes(&mut planes, cells, &plane_of_node)
        });
        let noise = estimated.and_then(|errors| errors.level);
        let cells = nodes
            .all_stats(grid)
            .zip(plane_of_node)
            .filter_map(|(s, plane)| Some(LabelledCell { centroid: s.mean()?, points: s.count(), plane }))
            .collect();
        let cell_counts = CellCounts { occupied: grid.len(), dense: nodes.dense.len(), clustered };
        let (points, labels) = (self.len(), Vec::new());
        let map = PlaneMap { planes, points, labels, used, noise, cells, cell_counts, optimised };
        Ok((map, plane_of_cell))
    }
}

/// Splits the uncertain clusters at their own φ and keeps the others.
fn improve(first: &First<'_>, params: &Params) -> Result<(Vec<Part>, Vec<Optimised>), ExtractError> {
    let uncertain: Vec<usize> = first.uncertain(params).collect();
    let run = &first.segmentation;
    let splits = (0..run.len())
        .into_par_iter()
        .filter_map(|number| Some((number, run.cluster(number)?)))
        .map(|(number, cluster)| match &params.optimise {
            Some(optimise) if uncertain.binary_search(&number).is_ok() => {
                let split = split(&first.part(number), params, optimise)?;
                Ok((split.parts, Some(split.record)))
            }
            _ => Ok((vec![Part::of(cluster, run, |node| node)], None)),
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

/// The planes of the parts with enough cells, sorted by points, and the plane of each node.
pub(crate) fn fit_parts(
    parts: &[Part],
    (grid, nodes): (&VoxelGrid, &Nodes),
    min_cells: usize,
) -> (Vec<ExtractedPlane>, Vec<Option<PlaneId>>) {
    let mut fitted: Vec<(Stats, Plane, f64, &Part)> = parts
        .iter()
        .filter(|part| part.nodes.len() >= min_cells)
        .filter_map(|part| {
            let stats = union(part, (grid, nodes))?;
            let fit = fit_plane(&stats).ok()?;
            let plane = Plane::through(fit.centroid, canonical(fit.normal)).ok()?;
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
                normal_uncertainty: Some(part.uncertainty),
                estimate: None,
                points: stats.count(),
                cells: part.nodes.len(),
                rms,
                phi: Some(part.phi),
                phi_interval: Some(part.interval),
            })
        })
        .collect();
    (planes, plane_of_node)
}

fn union(part: &Part, (grid, nodes): (&VoxelGrid, &Nodes)) -> Option<Stats> {
    let mut all = Stats::new(nodes.stats(grid, *part.nodes.first()? as usize)?.anchor());
    for node in &part.nodes {
        all.merge(&nodes.stats(grid, *node as usize)?);
    }
    Some(all)
}
