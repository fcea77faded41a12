//! Which planes are kept, and which points are theirs.

use rayon::prelude::*;
use terrace_grid::{Connectivity, VoxelGrid};
use terrace_normals::fit_plane;
use terrace_stats::{Stats, SymmetricMatrix3};
use terrace_types::PlaneId;

use crate::estimate::{Errors, ROUGHEST, usual_chi_squared};
use crate::nodes::Nodes;
use crate::{Confirm, ExtractedPlane, Mapper};

/// Planes are taken out and points labelled again so many times at most.
const ROUNDS: usize = 3;
/// Points nearer than this share of a cell are on a plane whatever their error: places are rounded.
const NEAREST: f64 = 1e-4;

/// Planes that were found, and all that is known of the points.
pub(crate) struct Candidates<'a> {
    pub(crate) mapper: &'a Mapper,
    pub(crate) grid: &'a VoxelGrid,
    pub(crate) nodes: &'a Nodes,
    pub(crate) errors: &'a Errors<'a>,
    pub(crate) confirm: Confirm,
}

/// A plane near a cell, from the centre of its voxel.
struct Near {
    plane: u32,
    normal: [f64; 3],
    offset: f64,
    /// The standard error of a point of the cell along the normal, and at least what rounding is.
    sigma: f64,
}

/// For each cell the planes that its points may be of.
struct Nearby {
    starts: Vec<usize>,
    of: Vec<Near>,
}

impl Candidates<'_> {
    /// Takes out the planes that are not sure enough, labels the points, and takes out those that keep too few of their own. The
    /// planes that are left are numbered anew by their points.
    pub(crate) fn confirm(
        &self,
        planes: &mut Vec<ExtractedPlane>,
        plane_of_node: &mut [Option<PlaneId>],
        plane_of_cell: &[Option<PlaneId>],
    ) -> Vec<Option<PlaneId>> {
        let mut kept = self.sure(planes, plane_of_node);
        let mut labels = Vec::new();
        for _ in 0..ROUNDS {
            labels = self.labels(planes, &kept, plane_of_cell);
            let mut own = vec![0_u64; planes.len()];
            for (label, cell) in labels.iter().zip(self.mapper.cells_of_points()) {
                let of_cell = cell.and_then(|cell| plane_of_cell[cell.index()]);
                if let Some(plane) = label.filter(|label| of_cell == Some(*label)) {
                    own[plane.index()] += 1;
                }
            }
            let few = |(plane, own): (&ExtractedPlane, &u64)| {
                (*own as f64) < self.confirm.share * plane.points as f64
            };
            let out: Vec<bool> = planes.iter().zip(&own).map(few).collect();
            if !kept.iter().zip(&out).any(|(kept, out)| *kept && *out) {
                break;
            }
            for (kept, out) in kept.iter_mut().zip(out) {
                *kept &= !out;
            }
        }
        number_anew(planes, &kept, &mut labels, plane_of_node);
        labels
    }

    /// Which planes have an orientation that is sure enough: by their covariance, or, where there is none, by their points, if
    /// those lie as flat as errors say.
    fn sure(&self, planes: &[ExtractedPlane], plane_of_node: &[Option<PlaneId>]) -> Vec<bool> {
        let mut sums: Vec<Option<(Stats, SymmetricMatrix3)>> = vec![None; planes.len()];
        for (node, plane) in plane_of_node.iter().enumerate() {
            let without =
                plane.filter(|plane| planes.get(plane.index()).is_some_and(|p| p.estimate.is_none()));
            let (Some(plane), Some(stats)) = (without, self.nodes.stats.get(node)) else { continue };
            let Some(cell) = self.nodes.dense.cells().get(node) else { continue };
            let (sum, noise) =
                sums[plane.index()].get_or_insert((Stats::new(stats.anchor()), SymmetricMatrix3::ZERO));
            sum.merge(stats);
            *noise += self.noise(stats, cell.index()) * stats.count() as f64;
        }
        let rough = ROUGHEST * usual_chi_squared(planes);
        let sure = |(plane, sums): (&ExtractedPlane, &Option<(Stats, SymmetricMatrix3)>)| {
            if let Some(estimate) = &plane.estimate {
                return estimate.largest_tilt() <= self.confirm.tilt;
            }
            let Some((sum, noise)) = sums else { return false };
            let Ok(fit) = fit_plane(sum) else { return false };
            let points = sum.count() as f64;
            let [thickness, across, _] = fit.variances;
            let expected = noise.quadratic_form(fit.normal) / points;
            let tilt = (thickness.max(expected) / (points * across)).sqrt();
            let exact = thickness.sqrt() <= NEAREST * self.grid.cell_size();
            (exact || thickness <= rough * expected) && tilt <= self.confirm.tilt
        };
        planes.iter().zip(&sums).map(sure).collect()
    }

    /// The mean covariance of the error of a point of a cell.
    fn noise(&self, stats: &Stats, cell: usize) -> SymmetricMatrix3 {
        match &self.errors.level {
            Some(level) => level.covariance(self.errors, stats, self.errors.seen(cell)),
            None => stats.moments().noise() * (1.0 / stats.count().max(1) as f64),
        }
    }

    /// Each point gets the plane it is nearest to in standard errors.
    fn labels(
        &self,
        planes: &[ExtractedPlane],
        kept: &[bool],
        plane_of_cell: &[Option<PlaneId>],
    ) -> Vec<Option<PlaneId>> {
        let nearby = self.nearby(planes, kept, plane_of_cell);
        let label = |(cell, place): (&Option<terrace_grid::CellId>, &[f32; 3])| {
            let cell = (*cell)?.index();
            let (start, end) = (*nearby.starts.get(cell)?, *nearby.starts.get(cell + 1)?);
            let mut best: Option<(f64, u32)> = None;
            for near in nearby.of.get(start..end)? {
                let distance: f64 =
                    (0..3).map(|i| near.normal[i] * f64::from(place[i])).sum::<f64>() + near.offset;
                let errors = distance.abs() / near.sigma;
                if errors <= self.confirm.distance && best.is_none_or(|(least, _)| errors < least) {
                    best = Some((errors, near.plane));
                }
            }
            PlaneId::from_index(best?.1 as usize)
        };
        self.mapper.cells_of_points().par_iter().zip(self.mapper.places()).map(label).collect()
    }

    /// The planes of each cell and those around it, sparse cells included.
    fn nearby(&self, planes: &[ExtractedPlane], kept: &[bool], plane_of_cell: &[Option<PlaneId>]) -> Nearby {
        let all = self.grid.dense(1, Connectivity::Corners);
        let of_cell = |node: usize| {
            let id = all.cells().get(node)?;
            plane_of_cell.get(id.index()).copied().flatten().filter(|plane| kept[plane.index()])
        };
        let near: Vec<(usize, Vec<Near>)> = (0..all.len())
            .into_par_iter()
            .filter_map(|node| {
                let mut ids: Vec<PlaneId> = of_cell(node).into_iter().collect();
                ids.extend(all.neighbours(node).iter().filter_map(|near| of_cell(*near as usize)));
                ids.sort_unstable();
                ids.dedup();
                if ids.is_empty() {
                    return None;
                }
                let cell = self.grid.get(*all.cells().get(node)?)?;
                let noise = self.noise(&cell.stats(), cell.id().index());
                let near = ids.iter().map(|id| {
                    let plane = &planes[id.index()];
                    let normal = plane.plane.normal();
                    let grown = plane.estimate.map_or(1.0, |estimate| estimate.reduced_chi_squared.max(1.0));
                    let sigma = (grown * noise.quadratic_form(normal).max(0.0)).sqrt();
                    Near {
                        plane: id.get() - 1,
                        normal,
                        offset: plane.plane.signed_distance(cell.centre()),
                        sigma: sigma.max(NEAREST * self.grid.cell_size()),
                    }
                });
                Some((cell.id().index(), near.collect()))
            })
            .collect();
        let mut counts = vec![0_usize; self.grid.len() + 1];
        for (cell, of) in &near {
            counts[cell + 1] = of.len();
        }
        for cell in 0..self.grid.len() {
            counts[cell + 1] += counts[cell];
        }
        let mut by_cell = near;
        by_cell.sort_unstable_by_key(|(cell, _)| *cell);
        Nearby { starts: counts, of: by_cell.into_iter().flat_map(|(_, of)| of).collect() }
    }
}

/// Numbers the planes that are left by their points, in labels and nodes as well.
fn number_anew(
    planes: &mut Vec<ExtractedPlane>,
    kept: &[bool],
    labels: &mut [Option<PlaneId>],
    plane_of_node: &mut [Option<PlaneId>],
) {
    for plane in planes.iter_mut() {
        plane.points = 0;
    }
    for label in labels.iter().flatten() {
        planes[label.index()].points += 1;
    }
    let mut left: Vec<usize> = (0..planes.len()).filter(|at| kept[*at] && planes[*at].points > 0).collect();
    left.sort_by_key(|at| std::cmp::Reverse(planes[*at].points));
    let mut anew: Vec<Option<PlaneId>> = vec![None; planes.len()];
    for (index, at) in left.iter().enumerate() {
        anew[*at] = PlaneId::from_index(index);
    }
    for label in labels.iter_mut().chain(plane_of_node.iter_mut()) {
        *label = label.and_then(|old| anew[old.index()]);
    }
    let old = std::mem::take(planes);
    let mut numbered: Vec<ExtractedPlane> = old
        .into_iter()
        .zip(&anew)
        .filter_map(|(plane, id)| id.map(|id| ExtractedPlane { id, ..plane }))
        .collect();
    numbered.sort_by_key(|plane| plane.id);
    *planes = numbered;
}
