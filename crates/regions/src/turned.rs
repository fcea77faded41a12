//! How the surface around a cell may be turned against a plane, mostly told without a fit.

use std::f64::consts::FRAC_PI_2;

use glam::{DMat3, DVec3};
use terrace_normals::EigenvalueBounds;
use terrace_stats::SymmetricMatrix3;

use crate::around::{Bounded, Bounds, FEWEST, ROUNDING, ROW};
use crate::cell::Noise;
use crate::flat::Flat;

/// Rounding of an eigenvalue, as a share of the trace.
const ROUNDING_OF_TRACE: f64 = 1e-9;
/// The direction of the least scatter is told where the middle one is larger by this share of all.
const GAP: f64 = 1e-3;
/// And as far as it is known to this sine.
const FARTHEST_OFF: f64 = 0.1;
/// What scatters across its longer direction by less than this, in units of a squared edge, is left to the fit, which knows when points
/// determine no plane.
const NARROW: f64 = 1e-2;

/// The normal of the points around a cell, close to that of the plane that would be fitted to them: in single precision, for it is kept of
/// all.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Turned {
    normal: [f32; 3],
    /// The sine of the angle to that of the fit is no larger.
    off: f32,
}

impl Turned {
    /// Of points with this scatter and these bounds of its eigenvalues.
    // Rounding is allowed for where numbers are made use of.
    #[allow(clippy::cast_possible_truncation)]
    pub(crate) fn of(scatter: &SymmetricMatrix3, bounds: &EigenvalueBounds) -> Self {
        let known = least_direction(scatter, bounds.least[1], bounds.middle[0]);
        let (normal, off) = known.unwrap_or((DVec3::ZERO, f64::INFINITY));
        Self { normal: normal.to_array().map(|x| x as f32), off: off as f32 }
    }

    /// For the errors of points taken so, in units of a squared edge: surfaces may be turned by an angle in radians, and by so many
    /// standard errors.
    pub(crate) fn limit(&self, bounded: &Bounded, noise: Noise, turned: f64, errors: f64) -> Limit {
        let Bounds { points, least, middle, errors: [lowest, highest], .. } = bounded.bounds(noise);
        // Of too few points there is no plane, and the plane of a row says nothing: both are along any.
        if points < FEWEST || middle[1] * (1.0 + ROUNDING) <= ROW * lowest * (1.0 - ROUNDING) {
            return Limit { along: -1.0, away: -1.0 };
        }
        let tilt = |thickness: f64, variance: f64, across: f64| {
            ((thickness * points / (points - 3.0)).max(variance) / (points * across)).sqrt()
        };
        let least_limit = turned + errors * tilt(least[0], lowest, middle[1]) * (1.0 - ROUNDING);
        let most_limit = turned + errors * tilt(least[1], highest, middle[0]) * (1.0 + ROUNDING);
        let off = f64::from(self.off);
        let known = off <= FARTHEST_OFF;
        let off = (off * (1.0 + ROUNDING)).asin();
        let along = if least_limit > FRAC_PI_2 {
            -1.0
        } else if known && least_limit > off {
            (least_limit - off).cos() + ROUNDING
        } else {
            NEVER
        };
        let across = middle[0] * (1.0 - ROUNDING);
        let is_no_row = across > ROW * highest * (1.0 + ROUNDING) && across > NARROW;
        let away = if known && is_no_row && most_limit + off < FRAC_PI_2 {
            (most_limit + off).cos() - ROUNDING
        } else {
            -1.0
        };
        // They are apart by more than is rounded here.
        #[allow(clippy::cast_possible_truncation)]
        Limit { along: along as f32, away: away as f32 }
    }
}

/// More than any cosine.
const NEVER: f64 = 2.0;

/// How far the surface around a cell may be turned against a plane: with a larger cosine of the angle between both it is along the plane
/// for sure, and with a smaller one it is not.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Limit {
    along: f32,
    away: f32,
}

impl Limit {
    /// Whether the surface is along a plane; `None` where only a fit tells.
    #[inline]
    pub(crate) fn is_along(self, around: &Turned, plane: &Flat) -> Option<bool> {
        let cosine = DVec3::from(around.normal.map(f64::from)).dot(plane.normal).abs();
        if cosine >= f64::from(self.along) {
            return Some(true);
        }
        (cosine < f64::from(self.away)).then_some(false)
    }
}

/// The eigenvector of the least eigenvalue of a scatter, nearly, and the sine of the angle to it from above. The eigenvalue is given from
/// above, the middle one from below. `None` where they are too close.
///
/// With the eigenvalue λ, rows of C − λ are across the eigenvector. With its Rayleigh quotient ρ, any unit vector v that is off by the
/// angle θ has ‖Cv − ρv‖ ≥ (λ₁ − ρ) sin θ.
fn least_direction(c: &SymmetricMatrix3, least: f64, middle: f64) -> Option<(DVec3, f64)> {
    let [xx, xy, xz, yy, yz, zz] = c.0;
    let scatter = DMat3::from_cols_array(&[xx, xy, xz, xy, yy, yz, xz, yz, zz]);
    let trace = xx + yy + zz;
    let [a, b, c] = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| scatter * axis - axis * least);
    let mut across = a.cross(b);
    for other in [b.cross(c), c.cross(a)] {
        across = if other.length_squared() > across.length_squared() { other } else { across };
    }
    let normal = across.try_normalize()?;
    let turned = scatter * normal;
    let quotient = normal.dot(turned);
    let gap = middle - quotient;
    let residual = (turned - normal * quotient).length() + ROUNDING_OF_TRACE * trace;
    (gap > GAP * trace).then(|| (normal, residual / gap + ROUNDING))
}
