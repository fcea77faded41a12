//! The plane of least squares.

use terrace_stats::{Stats, SymmetricMatrix3};

use crate::{Degenerate, symmetric_eigen};

/// Variance across a line below this share of the variance along it is a line: points a hundredth of their extent away.
/// Rounding alone would be 1e-16; but a plane that rests on so narrow a strip may turn about it at the slightest error.
const COLLINEAR: f64 = 1e-4;

/// Standard deviations below this share of the coordinates' size are rounding.
const COINCIDENT: f64 = 1e-12;

/// A plane of least squares through weighted points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaneFit {
    /// Mean of the points: a point of the plane, in metres.
    pub centroid: [f64; 3],
    /// Unit normal. Its sign is not determined by the fit; see [`towards`](crate::towards).
    pub normal: [f64; 3],
    /// Unit vectors in the plane: along the largest scatter, and perpendicular to it and the normal.
    pub axes: [[f64; 3]; 2],
    /// Variances of the points along the normal and along the two axes, in m². The root of the first is the rms
    /// distance from the plane.
    pub variances: [f64; 3],
}

impl PlaneFit {
    /// Root mean square distance of the points from the plane, in metres.
    pub fn rms(&self) -> f64 {
        self.variances[0].max(0.0).sqrt()
    }
}

/// The plane of least squares through all points of `stats`: it passes through their mean, and its normal is the
/// eigenvector of their covariance with the smallest eigenvalue.
///
/// # Errors
/// [`Degenerate`] for fewer than three points, points in one place or on one line, and sums that are not finite.
///
/// ```
/// use terrace_normals::fit_plane;
/// use terrace_stats::{Stats, UncertainVector};
///
/// let mut stats = Stats::new([0.0; 3]);
/// for p in [[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0], [1.0, 1.0, 1.0]] {
///     stats.push(&UncertainVector::exact(p));
/// }
/// let fit = fit_plane(&stats)?;
/// assert_eq!(fit.centroid, [0.5, 0.5, 1.0]);
/// assert_eq!(fit.normal.map(f64::abs), [0.0, 0.0, 1.0]);
/// assert_eq!(fit.rms(), 0.0);
/// # Ok::<(), terrace_normals::Degenerate>(())
/// ```
pub fn fit_plane(stats: &Stats) -> Result<PlaneFit, Degenerate> {
    let found = usize::try_from(stats.count()).unwrap_or(usize::MAX);
    if found < 3 {
        return Err(Degenerate::TooFew { found });
    }
    let (Some(centroid), Some(covariance)) = (stats.mean(), stats.covariance()) else {
        return Err(Degenerate::NotFinite);
    };
    let local = stats.moments().mean().unwrap_or_default();
    from_covariance(centroid, &covariance, local)
}

/// The plane of least squares through these centres, each with the same weight (the paper's fit).
///
/// # Errors
/// As [`fit_plane`].
pub fn fit_centres(centres: &[[f64; 3]]) -> Result<PlaneFit, Degenerate> {
    let Some(anchor) = centres.first() else { return Err(Degenerate::TooFew { found: 0 }) };
    let mut stats = Stats::new(*anchor);
    for centre in centres {
        stats.push(&terrace_stats::UncertainVector::exact(*centre));
    }
    fit_plane(&stats)
}

/// `local` is the mean relative to the anchor: the size of the numbers whose squares were subtracted.
fn from_covariance(
    centroid: [f64; 3],
    covariance: &SymmetricMatrix3,
    local: [f64; 3],
) -> Result<PlaneFit, Degenerate> {
    if !covariance.is_finite() || !centroid.iter().all(|x| x.is_finite()) {
        return Err(Degenerate::NotFinite);
    }
    let eigen = symmetric_eigen(covariance);
    let [_, across, along] = eigen.values;
    let size = local.iter().chain(&centroid).fold(0.0, |a: f64, x| a.max(x.abs()));
    if along <= (COINCIDENT * size).powi(2) {
        return Err(Degenerate::Coincident { variance: along });
    }
    if across <= COLLINEAR * along {
        return Err(Degenerate::Collinear { across, along });
    }
    Ok(PlaneFit {
        centroid,
        normal: eigen.vectors[0],
        axes: [eigen.vectors[2], eigen.vectors[1]],
        variances: eigen.values.map(|v| v.max(0.0)),
    })
}
