//! Planes of sums, and how well they fit.

use glam::DVec3;
use terrace_normals::{PlaneFit, fit_plane};
use terrace_stats::{Moments, Stats, SymmetricMatrix3};

/// A neighbourhood with fewer points says too little.
const FEWEST: f64 = 8.0;
/// Rounding of a bound, as a share of it.
const ROUNDING: f64 = 1e-9;

/// A plane by a point and its unit normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Flat {
    pub(crate) normal: DVec3,
    pub(crate) point: DVec3,
}

impl Flat {
    #[inline]
    pub(crate) fn distance(&self, place: DVec3) -> f64 {
        self.normal.dot(place - self.point)
    }

    /// The angle between two planes, whichever way their normals point, in radians.
    pub(crate) fn angle(&self, other: &Self) -> f64 {
        self.normal.cross(other.normal).length().atan2(self.normal.dot(other.normal).abs())
    }
}

/// What the errors of points are taken to be.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Noise {
    /// Times what is stated, in m²/m².
    pub(crate) scale: f64,
    /// And as a standard deviation at least this share of the depth.
    pub(crate) floor: f64,
}

impl Noise {
    /// Variance of the error of a point along a direction, in m², by the mean covariance of errors and the depth.
    #[inline]
    pub(crate) fn variance(&self, noise: &SymmetricMatrix3, depth: f64, direction: DVec3) -> f64 {
        (self.scale * noise.quadratic_form(direction.to_array())).max((self.floor * depth).powi(2))
    }
}

/// The plane of least squares of some points.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Fitted {
    pub(crate) plane: Flat,
    pub(crate) fit: PlaneFit,
    pub(crate) points: f64,
    /// Mean variance of the error of a point along the normal, in m².
    pub(crate) variance: f64,
    /// Mean variance of the points along the normal, in m². Three of their freedoms went into the plane.
    pub(crate) thickness: f64,
    /// Standard error of the orientation where it is least sure, in radians.
    pub(crate) tilt: f64,
    /// The same of the error of a point across the longer direction in the plane.
    across: f64,
}

impl Fitted {
    /// `None` when the points are too few or determine no plane.
    pub(crate) fn of(sum: &Moments, noise: Noise) -> Option<Self> {
        let points = sum.weight();
        if points < FEWEST {
            return None;
        }
        let fit = fit_plane(&stats(sum)).ok()?;
        let plane = Flat { normal: fit.normal.into(), point: fit.centroid.into() };
        let (errors, depth) = (sum.mean_noise()?, plane.point.z);
        let variance = noise.variance(&errors, depth, plane.normal);
        let across = noise.variance(&errors, depth, fit.axes[1].into());
        let thickness = fit.variances[0] * points / (points - 3.0);
        let tilt = (thickness.max(variance) / (points * fit.variances[1])).sqrt();
        (variance > 0.0 && tilt.is_finite()).then_some(Self {
            plane,
            fit,
            points,
            variance,
            thickness,
            tilt,
            across,
        })
    }

    /// Mean squared distance of the points in units of the variance of their errors.
    pub(crate) fn reduced_chi_squared(&self) -> f64 {
        self.thickness / self.variance
    }

    /// Whether the points are a row: what they scatter across it is little more than their errors, so that the plane through them
    /// turns about the row as those fall.
    pub(crate) fn is_row(&self) -> bool {
        self.fit.variances[1] <= ROW * self.across
    }

    /// Whether the points lie as flat as their errors say, give or take what so few of them tell, and not along a line.
    pub(crate) fn is_flat(&self, chi_squared: f64, narrowest: f64) -> bool {
        let [_, across, along] = self.fit.variances;
        self.thickness <= allowed(chi_squared, self.points) * self.variance
            && across >= narrowest * along
            && !self.is_row()
    }
}

/// Points that scatter by less than this across their longer direction, in units of the variance of their errors, are a row.
const ROW: f64 = 2.0;

/// The mean square of so many points that passes for this reduced χ².
fn allowed(chi_squared: f64, points: f64) -> f64 {
    chi_squared * (1.0 + 3.0 * (2.0 / points).sqrt())
}

/// Sums about the camera itself: a scene is so small that squares lose nothing.
pub(crate) fn stats(sum: &Moments) -> Stats {
    Stats::from_moments([0.0; 3], *sum)
}

// What is known of points from their sums alone, without a plane fitted, and without roots: tiles are asked for it again and again.
//
// With eigenvalues λ₀ ≤ λ₁ ≤ λ₂ of the scatter C, trace t, determinant d and m = λ₀λ₁ + λ₀λ₂ + λ₁λ₂ the sum of the principal
// minors: λ₀ ≥ d/m, λ₁ ≤ t/2, and any unit vector n at the angle θ from the first eigenvector has nᵀCn ≥ λ₁ sin²θ.

/// A bound from below of the tilt of the plane through the points; `None` when it is not flat for sure, or they are too few.
pub(crate) fn least_tilt(sum: &Moments, noise: Noise, chi_squared: f64) -> Option<f64> {
    let points = sum.weight();
    if points < FEWEST {
        return None;
    }
    let [trace, minors, determinant] = sum.covariance()?.invariants();
    let thickness = (determinant / minors).max(0.0) * points / (points - 3.0);
    let [least, most] = sum.mean_noise()?.range();
    let [_, _, depth] = sum.mean()?;
    let floor = (noise.floor * depth).powi(2);
    let [least, most] = [least, most].map(|v| (noise.scale * v).max(floor));
    if thickness * (1.0 - ROUNDING) > allowed(chi_squared, points) * most {
        return None;
    }
    let tilt = (thickness.max(least) / (points * 0.5 * trace)).sqrt() * (1.0 - ROUNDING);
    // Not a number where all is zero, and then of no plane.
    (!tilt.is_nan()).then_some(tilt)
}

/// Whether the plane through the points is turned by less than an angle against another for sure, by the sine squared.
pub(crate) fn is_along(sum: &Moments, plane: &Flat, sine_squared: f64) -> bool {
    sum.covariance().is_some_and(|scatter| {
        let [trace, minors, _] = scatter.invariants();
        let off = scatter.quadratic_form(plane.normal.to_array());
        // λ₁ λ₂ = m − λ₀ (λ₁ + λ₂), λ₀ ≤ nᵀCn and λ₂ ≤ t.
        let across = (minors - off * trace) / trace;
        off <= sine_squared * across * (1.0 - ROUNDING)
    })
}
