//! What is to become small.

use terrace_eval::{Contingency, EvalError};
use terrace_types::PlaneId;

use crate::tune::TuneError;
use crate::tune::gridded::Gridded;
use crate::{ExtractedPlane, ParamsError};

/// What is to become small.
#[derive(Debug, Clone, PartialEq)]
pub enum Objective {
    /// The paper's cost over a whole map:
    /// `β = w_nv [Σᵢ (nᵢ/n) (s_x + s_y + s_z)ᵢ + (n₀/n) √3] + w_nc N_c`, summed over the N_c planes.
    ///
    /// The shares are of points, since cells change their size. The n₀ points of no plane count as if their normal were
    /// anyone's, `s = 1/√3` along each axis: otherwise it would be best to leave out whatever is uncertain.
    Uncertainty {
        /// Weight w_nv of the uncertainties.
        weight_uncertainty: f64,
        /// Weight w_nc of the number of planes.
        weight_clusters: f64,
    },
    /// 1 minus the agreement with true labels.
    Labels {
        /// The true label of each point of all scans, in order.
        truth: Vec<TrueLabel>,
        /// How the agreement is measured.
        quality: Quality,
    },
}

impl Default for Objective {
    /// The paper's cost with the weights 1 and 0.001.
    fn default() -> Self {
        Self::Uncertainty { weight_uncertainty: 1.0, weight_clusters: 0.001 }
    }
}

/// What is known of the true plane of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum TrueLabel {
    /// It belongs to this plane.
    Plane(PlaneId),
    /// It belongs to no plane.
    NoPlane,
    /// Nothing: the point is left out of the comparison.
    Unknown,
}

impl From<i32> for TrueLabel {
    /// As in label files: a plane from 1 on, 0 for none, below 0 not known.
    fn from(number: i32) -> Self {
        match u32::try_from(number) {
            Ok(number) => PlaneId::new(number).map_or(Self::NoPlane, Self::Plane),
            Err(_) => Self::Unknown,
        }
    }
}

/// How the agreement of labels is measured; see [`terrace_eval`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Quality {
    /// By the best intersection over union of each true plane, weighted by its points.
    #[default]
    Cover,
    /// By the F1 score of the planes that match above an intersection over union.
    F1 {
        /// That intersection over union, from ½ to 1.
        at_iou: f64,
    },
}

impl Quality {
    /// From 0 to 1; `None` without true planes.
    fn of(self, both: &Contingency) -> Result<Option<f64>, EvalError> {
        match self {
            Self::Cover => Ok(both.weighted_cover()),
            Self::F1 { at_iou } => Ok(both.matches(at_iou)?.f1()),
        }
    }
}

impl Objective {
    /// Checks weights, measure, and labels for this number of points.
    pub(crate) fn check(&self, points: usize) -> Result<(), TuneError> {
        match self {
            Self::Uncertainty { weight_uncertainty, weight_clusters } => {
                let weights =
                    [("weight_uncertainty", *weight_uncertainty), ("weight_clusters", *weight_clusters)];
                match weights.into_iter().find(|(_, weight)| !(weight.is_finite() && *weight >= 0.0)) {
                    Some((name, weight)) => {
                        Err(ParamsError::new(name, weight, "finite and at least 0").into())
                    }
                    None => Ok(()),
                }
            }
            Self::Labels { truth, quality } => {
                if truth.len() != points {
                    return Err(TuneError::Labels { labels: truth.len(), points });
                }
                if !truth.iter().any(|label| matches!(label, TrueLabel::Plane(_))) {
                    return Err(TuneError::NoTruePlanes { labels: truth.len() });
                }
                quality.of(&Contingency::default())?;
                Ok(())
            }
        }
    }

    /// The true labels, if they matter.
    pub(crate) fn truth(&self) -> Option<&[TrueLabel]> {
        match self {
            Self::Uncertainty { .. } => None,
            Self::Labels { truth, .. } => Some(truth),
        }
    }

    /// The cost of these planes; `plane_of_cell` tells the plane of each cell of the grid.
    pub(crate) fn value(
        &self,
        gridded: &Gridded,
        planes: &[ExtractedPlane],
        plane_of_cell: impl Fn(usize) -> Option<PlaneId>,
    ) -> Result<f64, TuneError> {
        match self {
            Self::Uncertainty { weight_uncertainty, weight_clusters } => {
                let shared: f64 = planes
                    .iter()
                    .map(|p| p.points as f64 * p.normal_uncertainty.iter().flatten().sum::<f64>())
                    .sum();
                let on_planes: u64 = planes.iter().map(|p| p.points).sum();
                let free = gridded.present.saturating_sub(on_planes) as f64;
                let mean = (shared + free * 3.0_f64.sqrt()) / gridded.present.max(1) as f64;
                Ok(weight_uncertainty * mean + weight_clusters * planes.len() as f64)
            }
            Self::Labels { quality, .. } => {
                let groups = gridded.groups.iter().filter_map(|group| {
                    let truth = match group.truth {
                        TrueLabel::Plane(plane) => Some(plane),
                        TrueLabel::NoPlane => None,
                        TrueLabel::Unknown => return None,
                    };
                    Some((truth, group.cell.and_then(&plane_of_cell), group.points))
                });
                Ok(1.0 - quality.of(&Contingency::of_counts(groups))?.unwrap_or(0.0))
            }
        }
    }
}
