//! The plane of least squares.

use terrace_stats::{Stats, SymmetricMatrix3};

use crate::{Degenerate, Eigen3, symmetric_eigen, symmetric_eigen_batch};

/// Variance across a line below this share of the variance along it is a line: points a hundredth of their extent away.
/// Rounding alone would be 1e-16; but a plane that rests on so narrow a strip may turn about it at the slightest error.
const COLLINEAR: f64 = 1e-4;

/// Beyond the rounding of bounds.
const CERTAINLY: f64 = 1.0 + 1e-6;

/// Standard deviations below this share of the coordinates' size are rounding of the coordinates.
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
    /// Variances of the points in rising order, in m²: along the normal, along the second axis, along the first. The
    /// root of the first is the rms distance from the plane.
    pub variances: [f64; 3],
}

impl PlaneFit {
    /// The plane of an eigen-decomposition of the points' covariance, if it determines one. Variances up to `rounding`
    /// mean nothing.
    pub(crate) fn of(eigen: &Eigen3, centroid: [f64; 3], rounding: f64) -> Result<Self, Degenerate> {
        if !centroid.iter().all(|x| x.is_finite()) {
            return Err(Degenerate::NotFinite);
        }
        determined(eigen.values, rounding)?;
        Ok(Self {
            centroid,
            normal: eigen.vectors[0],
            axes: [eigen.vectors[2], eigen.vectors[1]],
            variances: eigen.values.map(|v| v.max(0.0)),
        })
    }

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
    let [fit] = fit_planes(&[*stats]);
    fit
}

/// [`fit_plane`] of `N` sets of points side by side; 4 and 8 are good numbers. The result for each is the same to the last bit, whatever
/// the others are.
///
/// # Errors
/// For each as [`fit_plane`].
pub fn fit_planes<const N: usize>(stats: &[Stats; N]) -> [Result<PlaneFit, Degenerate>; N] {
    let scattered = stats.each_ref().map(Scattered::of);
    let eigen = symmetric_eigen_batch(
        &scattered.each_ref().map(|of| of.as_ref().map_or(SymmetricMatrix3::ZERO, |of| of.covariance)),
    );
    std::array::from_fn(|i| {
        scattered[i]
            .as_ref()
            .map_err(|why| *why)
            .and_then(|of| PlaneFit::of(&eigen[i], of.centroid, of.rounding))
    })
}

/// Where points are and how they scatter, and the variance that their sums have from rounding.
struct Scattered {
    centroid: [f64; 3],
    covariance: SymmetricMatrix3,
    rounding: f64,
}

impl Scattered {
    fn of(stats: &Stats) -> Result<Self, Degenerate> {
        let found = usize::try_from(stats.count()).unwrap_or(usize::MAX);
        if found < 3 {
            return Err(Degenerate::TooFew { found });
        }
        let (Some(centroid), Some(covariance)) = (stats.mean(), stats.covariance()) else {
            let unknown = stats.weight().is_nan();
            return Err(if unknown { Degenerate::NotFinite } else { Degenerate::TooFew { found: 0 } });
        };
        // The covariance is a difference of squares of this size, each a sum with a rounding per point.
        let squares: f64 = stats.moments().mean().unwrap_or_default().iter().map(|m| m * m).sum();
        let subtraction = f64::EPSILON * (stats.count() as f64 + 8.0) * squares;
        Ok(Self { centroid, covariance, rounding: rounding(centroid) + subtraction })
    }
}

/// The plane of least squares through these centres, each with the same weight (the paper's fit).
///
/// # Errors
/// As [`fit_plane`].
pub fn fit_centres(centres: &[[f64; 3]]) -> Result<PlaneFit, Degenerate> {
    let spread = Spread::of(centres.iter().copied())?;
    PlaneFit::of(&symmetric_eigen(&spread.covariance), spread.centroid, rounding(spread.centroid))
}

/// Where centres are and how they scatter.
pub(crate) struct Spread {
    pub(crate) count: usize,
    pub(crate) centroid: [f64; 3],
    pub(crate) covariance: SymmetricMatrix3,
}

impl Spread {
    /// In two passes, relative to the first centre, so that no squares are subtracted.
    pub(crate) fn of(centres: impl Iterator<Item = [f64; 3]> + Clone) -> Result<Self, Degenerate> {
        let Some(first) = centres.clone().next() else { return Err(Degenerate::TooFew { found: 0 }) };
        let (mut count, mut sum) = (0, [0.0; 3]);
        for centre in centres.clone() {
            count += 1;
            sum = [0, 1, 2].map(|i| sum[i] + (centre[i] - first[i]));
        }
        if count < 3 {
            return Err(Degenerate::TooFew { found: count });
        }
        let share = 1.0 / count as f64;
        let mean = sum.map(|s| s * share);
        let mut scatter = SymmetricMatrix3::ZERO;
        for centre in centres {
            scatter += SymmetricMatrix3::outer([0, 1, 2].map(|i| (centre[i] - first[i]) - mean[i]));
        }
        let centroid = [0, 1, 2].map(|i| first[i] + mean[i]);
        Ok(Self { count, centroid, covariance: scatter * share })
    }
}

/// The variance that coordinates of this size have from being rounded.
pub(crate) fn rounding(centroid: [f64; 3]) -> f64 {
    let size = centroid.iter().fold(0.0, |a: f64, x| a.max(x.abs()));
    (COINCIDENT * size) * (COINCIDENT * size)
}

/// Whether these variances, in rising order, are those of a plane.
pub(crate) fn determined([_, across, along]: [f64; 3], rounding: f64) -> Result<(), Degenerate> {
    if !(along.is_finite() && rounding.is_finite()) {
        return Err(Degenerate::NotFinite);
    }
    if along <= rounding {
        return Err(Degenerate::Coincident { variance: along });
    }
    if across <= COLLINEAR * along + rounding {
        return Err(Degenerate::Collinear { across, along });
    }
    Ok(())
}

/// Whether all variances are those of a plane whose middle one is no less, and whose largest one no more; false where only they
/// themselves tell, and for what is not finite.
pub(crate) fn are_determined(across: f64, along: f64, rounding: f64) -> bool {
    across > CERTAINLY * COLLINEAR * along + rounding
}
