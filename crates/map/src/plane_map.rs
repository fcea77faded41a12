//! What comes out: planes with their uncertainty, a label per point, and every parameter used.

use terrace_cluster::Interval;
use terrace_types::{Plane, PlaneId};

use crate::{CellSizeChoice, NoiseLevel, Optimised, Params, PlaneEstimate};

/// A plane of the scene.
#[derive(Debug, Clone, PartialEq)]
pub struct ExtractedPlane {
    /// Its number, from 1: planes are sorted by their points, the largest first; where regions were
    /// [streamed](crate::Mapper::extract_streamed), by points as samples tell.
    pub id: PlaneId,
    /// The plane: that of [`estimate`](Self::estimate) where there is one, else that of least squares through all points of
    /// its cells; for a region those over which it was grown. The normal points to the side from which most of them were seen, or,
    /// when no sensor position is known, has a positive largest component.
    pub plane: Plane,
    /// Mean of the points, in metres.
    pub centroid: [f64; 3],
    /// (s_x, s_y, s_z): the root of dispersion plus mean squared error of the normals of its cells, per axis. `None` when none of
    /// its cells has a normal.
    pub normal_uncertainty: Option<[f64; 3]>,
    /// The plane of least variance with its covariance, when [`Params::estimate`] asks for it; `None` also where too little is
    /// left of the cells once those that hold something else are left out, or all points lie exactly in a plane.
    pub estimate: Option<PlaneEstimate>,
    /// Points with its label: those near it, or, where cells were clustered, those in its cells.
    pub points: u64,
    /// Number of cells.
    pub cells: usize,
    /// Root mean square distance of its points from the plane of least squares, in metres.
    pub rms: f64,
    /// The threshold φ at which it was found; `None` where planes are regions.
    pub phi: Option<f64>,
    /// The thresholds at which the same clusters are found; `None` where planes are regions.
    pub phi_interval: Option<Interval>,
}

/// The parameters of a run, with what was chosen from the data filled in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Used {
    /// The parameters as given.
    pub params: Params,
    /// The cell size, in metres.
    pub cell_size: f64,
    /// What the cell size was chosen from; `None` when it was given.
    pub chosen: Option<CellSizeChoice>,
    /// The density threshold.
    pub tau: u64,
    /// What was chosen for regions; `None` where cells were clustered.
    pub grown: Option<Grown>,
}

/// What regions chose from the data.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grown {
    /// What the variances of errors were multiplied by, because planes scatter by more: 1 where the errors explain them.
    pub noise_scale: f64,
    /// The fewest points of a plane.
    pub min_points: f64,
    /// The least area of a plane, in m².
    pub min_area: f64,
}

/// A dense cell and the plane it belongs to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LabelledCell {
    /// Mean of its points, in metres.
    pub centroid: [f64; 3],
    /// Number of its points.
    pub points: u64,
    /// Its plane.
    pub plane: Option<PlaneId>,
}

/// How many cells came how far.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CellCounts {
    /// Cells with a point.
    pub occupied: usize,
    /// Cells with at least τ points.
    pub dense: usize,
    /// Dense cells whose normal was certain enough to take part in the clustering.
    pub clustered: usize,
}

/// Counts and averages.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Summary {
    /// Input points, absent ones included.
    pub points: usize,
    /// Points with a label.
    pub labelled: usize,
    /// Number of planes.
    pub planes: usize,
    /// Mean of (s_x, s_y, s_z) over the planes that have them; `None` without any.
    pub normal_uncertainty_mean: Option<[f64; 3]>,
}

/// The planes of a map.
#[derive(Debug, Clone, PartialEq)]
pub struct PlaneMap {
    /// The planes, in the order of their numbers.
    pub planes: Vec<ExtractedPlane>,
    /// Number of input points, absent ones included.
    pub points: usize,
    /// The plane of each input point, over all scans in the order of insertion; empty when points were not kept.
    pub labels: Vec<Option<PlaneId>>,
    /// The parameters used.
    pub used: Used,
    /// The standard errors of the points, where none were given and they were found from the residuals of flat places.
    pub noise: Option<NoiseLevel>,
    /// The dense cells in the order of their keys, with the plane each belongs to.
    pub cells: Vec<LabelledCell>,
    /// How many cells there are of each kind.
    pub cell_counts: CellCounts,
    /// What was done for each uncertain cluster, in the order of the first clustering.
    pub optimised: Vec<Optimised>,
}

impl PlaneMap {
    /// Counts and averages.
    pub fn summary(&self) -> Summary {
        Summary {
            points: self.points,
            labelled: self
                .planes
                .iter()
                .map(|plane| usize::try_from(plane.points).unwrap_or(usize::MAX))
                .sum(),
            planes: self.planes.len(),
            normal_uncertainty_mean: mean(self.planes.iter().filter_map(|p| p.normal_uncertainty)),
        }
    }

    /// The plane of this number.
    pub fn plane(&self, id: PlaneId) -> Option<&ExtractedPlane> {
        self.planes.get(id.index())
    }
}

fn mean(vectors: impl Iterator<Item = [f64; 3]>) -> Option<[f64; 3]> {
    let (mut sum, mut count) = ([0.0; 3], 0_usize);
    for vector in vectors {
        sum = [0, 1, 2].map(|i| sum[i] + vector[i]);
        count += 1;
    }
    (count > 0).then(|| sum.map(|s| s / count as f64))
}
