//! How the surface around a cell may be turned against a plane, mostly told without a fit.

use std::f64::consts::FRAC_PI_2;

use glam::DVec3;
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
    /// Of points with these scatters and these bounds of their eigenvalues, side by side.
    ///
    /// With the eigenvalue λ, rows of C − λ are across the eigenvector. With its Rayleigh quotient ρ, any unit vector v that is off by the
    /// angle θ has ‖Cv − ρv‖ ≥ (λ₁ − ρ) sin θ.
    // Into what it is dispatched to; rounding is allowed for where numbers are made use of.
    #[allow(clippy::inline_always, clippy::cast_possible_truncation, clippy::many_single_char_names)]
    #[inline(always)]
    pub(crate) fn of_all<const N: usize>(
        scatters: &[SymmetricMatrix3; N],
        bounds: &[EigenvalueBounds; N],
    ) -> [Self; N] {
        let mut c = [[0.0; N]; 6];
        let (mut least, mut middle) = ([0.0; N], [0.0; N]);
        for lane in 0..N {
            for (c, entry) in c.iter_mut().zip(scatters[lane].0) {
                c[lane] = entry;
            }
            (least[lane], middle[lane]) = (bounds[lane].least[1], bounds[lane].middle[0]);
        }
        let [xx, xy, xz, yy, yz, zz] = c;
        let (mut x, mut y, mut z, mut off) = ([0.0; N], [0.0; N], [0.0; N], [f64::INFINITY; N]);
        // Written out, so that all of it is done for several at a time.
        for lane in 0..N {
            let (xx, xy, xz, yy, yz, zz) = (xx[lane], xy[lane], xz[lane], yy[lane], yz[lane], zz[lane]);
            let (a, b, c) = (xx - least[lane], yy - least[lane], zz - least[lane]);
            // Products of two rows each: the longest tells most.
            let (ux, uy, uz) = (xy * yz - xz * b, xz * xy - a * yz, a * b - xy * xy);
            let (vx, vy, vz) = (b * c - yz * yz, yz * xz - xy * c, xy * yz - b * xz);
            let (wx, wy, wz) = (yz * xz - c * xy, c * a - xz * xz, xz * xy - yz * a);
            let [u, v, w] =
                [ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz, wx * wx + wy * wy + wz * wz];
            let (px, py, pz, p) = if v > u { (vx, vy, vz, v) } else { (ux, uy, uz, u) };
            let (px, py, pz, p) = if w > p { (wx, wy, wz, w) } else { (px, py, pz, p) };
            let per_length = 1.0 / p.sqrt();
            let (nx, ny, nz) = (px * per_length, py * per_length, pz * per_length);
            let (tx, ty, tz) =
                (xx * nx + xy * ny + xz * nz, xy * nx + yy * ny + yz * nz, xz * nx + yz * ny + zz * nz);
            let (quotient, trace) = (nx * tx + ny * ty + nz * tz, xx + yy + zz);
            let gap = middle[lane] - quotient;
            let (rx, ry, rz) = (tx - nx * quotient, ty - ny * quotient, tz - nz * quotient);
            let residual = (rx * rx + ry * ry + rz * rz).sqrt() + ROUNDING_OF_TRACE * trace;
            // None where they are too close, nor where the length is nothing, or no number.
            let is_known = gap > GAP * trace && per_length < f64::INFINITY;
            x[lane] = if is_known { nx } else { 0.0 };
            y[lane] = if is_known { ny } else { 0.0 };
            z[lane] = if is_known { nz } else { 0.0 };
            off[lane] = if is_known { residual / gap + ROUNDING } else { f64::INFINITY };
        }
        std::array::from_fn(|lane| Self {
            normal: [x[lane] as f32, y[lane] as f32, z[lane] as f32],
            off: off[lane] as f32,
        })
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
        let off = most_angle(off * (1.0 + ROUNDING));
        let along = if least_limit > FRAC_PI_2 {
            -1.0
        } else if known && least_limit > off {
            most_cosine(least_limit - off) + ROUNDING
        } else {
            NEVER
        };
        let across = middle[0] * (1.0 - ROUNDING);
        let is_no_row = across > ROW * highest * (1.0 + ROUNDING) && across > NARROW;
        let away = if known && is_no_row && most_limit + off < FRAC_PI_2 {
            least_cosine(most_limit + off) - ROUNDING
        } else {
            -1.0
        };
        // They are apart by more than is rounded here.
        #[allow(clippy::cast_possible_truncation)]
        Limit { along: along as f32, away: away as f32 }
    }
}

/// The angle with a sine up to [`FARTHEST_OFF`] from above, closely: the series of the arcsine, with more than all of the rest in its
/// second term.
fn most_angle(sine: f64) -> f64 {
    sine * (1.0 + 0.17 * sine * sine)
}

/// The cosine of an angle from 0 to π/2 from above and below, closely where it is small: its series changes sign from term to term, and
/// terms become smaller.
fn most_cosine(angle: f64) -> f64 {
    let x = angle * angle;
    1.0 - x / 2.0 * (1.0 - x / 12.0)
}

fn least_cosine(angle: f64) -> f64 {
    let x = angle * angle;
    1.0 - x / 2.0 * (1.0 - x / 12.0 * (1.0 - x / 30.0))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_and_cosines_are_bounded_closely() {
        for k in 0..=1000 {
            let share = f64::from(k) / 1000.0;
            let sine = share * FARTHEST_OFF;
            let over = most_angle(sine) - sine.asin();
            assert!((0.0..=4e-6).contains(&over), "{over} at {sine}");
            let angle = share * FRAC_PI_2;
            let [over, under] = [most_cosine(angle) - angle.cos(), angle.cos() - least_cosine(angle)];
            assert!((-1e-15..=0.021).contains(&over) && (-1e-15..=1e-3).contains(&under), "{over} {under}");
            // As far as surfaces usually may be turned.
            assert!(angle > 0.5 || over < 3e-5 && under < 1e-6);
        }
    }
}
