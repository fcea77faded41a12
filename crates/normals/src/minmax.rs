//! The normal of a neighbourhood and its min-max uncertainty (Definition 3).

use glam::DVec3;
use terrace_stats::{Stats, UncertainVector};

use crate::{Degenerate, PlaneFit, fit_centres, fit_plane};

/// What the plane of a neighbourhood is fitted to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FitTo {
    /// The virtual centres of the cells, each with the same weight: the paper's fit.
    Centres,
    /// All points of the cells, through their summed statistics: uses the scatter within cells as well.
    #[default]
    Points,
}

/// A plane fitted to a neighbourhood, and how far its normal may be off.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UncertainNormal {
    /// The plane.
    pub fit: PlaneFit,
    /// Largest change of each component of the unit normal under the min-max perturbations, without unit: the paper's
    /// (s_x, s_y, s_z) of a cell.
    pub uncertainty: [f64; 3],
}

impl UncertainNormal {
    /// The unit normal as an uncertain vector, with the min-max uncertainty as its standard error.
    pub fn as_vector(&self) -> UncertainVector {
        UncertainVector { value: self.fit.normal, error: self.uncertainty }
    }

    /// `s_x + s_y + s_z`, what the threshold ω is compared with.
    pub fn total(&self) -> f64 {
        self.uncertainty.iter().sum()
    }
}

/// The normal of a neighbourhood of cells, with its min-max uncertainty.
///
/// # Algorithm
/// 1. Fit the plane: mean c, normal n, axes e₁, e₂ in the plane.
/// 2. The centre of cell i is uncertain by δᵢ along n: δᵢ² = nᵀ (scatter of its points / dᵢ + diag(E) / dᵢ²) n.
/// 3. For k = 1, 2 and both signs, move every centre cᵢ by ±δᵢ sign((cᵢ − c)·e_k) along n and fit again. To first order
///    no errors of these sizes tilt the plane about the other axis by more.
/// 4. The uncertainty is the largest change of each component of the normal over the four fits.
///
/// # Parameters
/// * `cells`: the statistics of the cells of the neighbourhood, at least three with points.
/// * `to`: what is fitted, see [`FitTo`].
///
/// # Errors
/// [`Degenerate`] when the plane or the tilt is not determined. The *centres* must not be on a line, whatever is fitted:
/// the perturbations turn the plane at the centres, and would find centres in a row to be certain.
pub fn estimate(cells: &[Stats], to: FitTo) -> Result<UncertainNormal, Degenerate> {
    let mut centres = Vec::with_capacity(cells.len());
    centres.extend(cells.iter().filter_map(Stats::mean));
    let through_centres = fit_centres(&centres)?;
    let fit = match to {
        FitTo::Centres => through_centres,
        FitTo::Points => fit_plane(&union(cells.iter().copied(), through_centres.centroid))?,
    };
    let normal = DVec3::from_array(fit.normal);
    let mut uncertainty = DVec3::ZERO;
    let mut moved = Vec::with_capacity(cells.len());
    for axis in fit.axes {
        for sign in [1.0, -1.0] {
            moved.clear();
            moved.extend(cells.iter().filter_map(|cell| perturbed(cell, &fit, axis, sign)));
            let refit = match to {
                FitTo::Centres => {
                    centres.clear();
                    centres.extend(moved.iter().filter_map(Stats::mean));
                    fit_centres(&centres)?
                }
                FitTo::Points => fit_plane(&union(moved.iter().copied(), fit.centroid))?,
            };
            let turned = DVec3::from_array(refit.normal);
            let turned = if turned.dot(normal) < 0.0 { -turned } else { turned };
            uncertainty = uncertainty.max((turned - normal).abs());
        }
    }
    Ok(UncertainNormal { fit, uncertainty: uncertainty.to_array() })
}

/// The cell with all of its points moved along the normal, by as much as its centre is uncertain, up on one side of
/// the centroid and down on the other.
fn perturbed(cell: &Stats, fit: &PlaneFit, axis: [f64; 3], sign: f64) -> Option<Stats> {
    let (centre, covariance) = (cell.mean()?, cell.covariance_of_mean()?);
    let arm: f64 = (0..3).map(|i| (centre[i] - fit.centroid[i]) * axis[i]).sum();
    let delta = covariance.quadratic_form(fit.normal).max(0.0).sqrt();
    let side = if arm > 0.0 {
        sign
    } else if arm < 0.0 {
        -sign
    } else {
        0.0
    };
    let anchor = cell.anchor();
    Some(Stats::from_moments([0, 1, 2].map(|i| anchor[i] + side * delta * fit.normal[i]), *cell.moments()))
}

fn union(cells: impl Iterator<Item = Stats>, anchor: [f64; 3]) -> Stats {
    let mut all = Stats::new(anchor);
    for cell in cells {
        all.merge(&cell);
    }
    all
}
