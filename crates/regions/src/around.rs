//! The planes around groups of cells, fitted when they are asked for.

use terrace_normals::PlaneFit;
use terrace_stats::Stats;

use crate::cell::Noise;
use crate::field::Field;
use crate::flat::Flat;
use crate::sum::Sum;

/// A neighbourhood with fewer points says too little.
const FEWEST: f64 = 8.0;
/// Points that scatter by less than this across their longer direction, in units of the variance of their errors, are a row.
const ROW: f64 = 2.0;
/// Rounding of a bound, as a share of it.
const ROUNDING: f64 = 1e-9;

/// The plane of a neighbourhood.
#[derive(Debug, Clone)]
pub(crate) struct Around {
    pub(crate) plane: Flat,
    fit: PlaneFit,
    points: f64,
    /// Mean variance of the errors along the normal and across the longer direction in the plane, as stated, in m².
    stated: f64,
    stated_across: f64,
}

/// The planes around groups, each fitted once.
pub(crate) struct Arounds<'f> {
    field: &'f Field,
    /// By level and group: 0 while it is not known, else one more than the place of what was found.
    known: Vec<Vec<u32>>,
    found: Vec<Option<Around>>,
}

impl<'f> Arounds<'f> {
    pub(crate) fn of(field: &'f Field) -> Self {
        let known = field.levels.iter().map(|level| vec![0; level.len()]).collect();
        Self { field, known, found: Vec::new() }
    }

    pub(crate) fn field(&self) -> &'f Field {
        self.field
    }

    /// The plane of the points of a group and of those it touches; `None` when they determine none.
    pub(crate) fn get(&mut self, level: usize, group: usize) -> Option<&Around> {
        let known = &mut self.known[level][group];
        if *known == 0 {
            self.found.push(Around::of(&self.field.stats_around(level, group)));
            // Groups are fewer than twice the cells, and those are numbered with 32 bits; one that is not kept is found again.
            *known = u32::try_from(self.found.len()).unwrap_or(0);
        }
        self.found.get((*known as usize).wrapping_sub(1))?.as_ref()
    }
}

impl Around {
    fn of(sum: &Stats) -> Option<Self> {
        let points = sum.count() as f64;
        if points < FEWEST {
            return None;
        }
        let fit = terrace_normals::fit_plane(sum).ok()?;
        let stated = sum.moments().noise().quadratic_form(fit.normal) / points;
        let stated_across = sum.moments().noise().quadratic_form(fit.axes[1]) / points;
        Some(Self { plane: Flat::of(&fit), fit, points, stated, stated_across })
    }

    fn variance(&self, noise: Noise) -> f64 {
        (noise.scale * self.stated).max(noise.floor)
    }

    /// Variance of the points along the normal. Three of their freedoms went into the plane.
    fn thickness(&self) -> f64 {
        self.fit.variances[0] * self.points / (self.points - 3.0)
    }

    /// Standard error of the orientation where it is least sure, in radians.
    pub(crate) fn tilt(&self, noise: Noise) -> f64 {
        (self.thickness().max(self.variance(noise)) / (self.points * self.fit.variances[1])).sqrt()
    }

    /// Whether the points are a row: what they scatter across it is little more than their errors, so that the plane through them
    /// turns about the row as those fall. A ring of a lidar is one, a step of a depth image another.
    pub(crate) fn is_row(&self, noise: Noise) -> bool {
        let [_, across, _] = self.fit.variances;
        across <= ROW * (noise.scale * self.stated_across).max(noise.floor)
    }

    /// Whether the points lie as flat as their errors say, give or take what so few of them tell, and not along a line.
    pub(crate) fn is_flat(&self, noise: Noise, chi_squared: f64, narrowest: f64) -> bool {
        let [_, across, along] = self.fit.variances;
        self.thickness() <= allowed(chi_squared, self.points) * self.variance(noise)
            && across >= narrowest * along
            && !self.is_row(noise)
    }
}

/// The mean square of so many points that passes for this reduced χ².
fn allowed(chi_squared: f64, points: f64) -> f64 {
    chi_squared * (1.0 + 3.0 * (2.0 / points).sqrt())
}

/// What is known of a neighbourhood from its sums alone, without a plane fitted.
///
/// With eigenvalues λ₀ ≤ λ₁ ≤ λ₂ of the scatter C, trace t, determinant d and m = λ₀λ₁ + λ₀λ₂ + λ₁λ₂ the sum of the principal
/// minors: λ₀ ≥ d/m, λ₁ ≤ t/2, and any unit vector n at the angle θ from the first eigenvector has nᵀCn ≥ λ₁ sin²θ.
impl Sum {
    /// A bound from below of the tilt of the plane through the points; `None` when it is not flat for sure, or they are too few.
    pub(crate) fn least_tilt(&self, noise: Noise, chi_squared: f64) -> Option<f64> {
        let points = self.points();
        if points < FEWEST {
            return None;
        }
        let c = self.covariance();
        let (trace, minors, determinant) = invariants(&c);
        let thickness = (determinant / minors).max(0.0) * points / (points - 3.0);
        let [xx, xy, xz, yy, yz, zz] = self.noise();
        // Gershgorin: the variance of errors along any direction is within these.
        let radii = [xy.abs() + xz.abs(), xy.abs() + yz.abs(), xz.abs() + yz.abs()];
        let diagonal = [xx, yy, zz];
        let least = (0..3).fold(f64::INFINITY, |least, i| least.min(diagonal[i] - radii[i]));
        let most = (0..3).fold(0.0, |most: f64, i| most.max(diagonal[i] + radii[i]));
        let [least, most] = [least, most].map(|v| (noise.scale * v).max(noise.floor));
        if thickness * (1.0 - ROUNDING) > allowed(chi_squared, points) * most {
            return None;
        }
        let tilt = (thickness.max(least) / (points * 0.5 * trace)).sqrt() * (1.0 - ROUNDING);
        // Not a number where all is zero, and then of no plane.
        (!tilt.is_nan()).then_some(tilt)
    }

    /// Whether the plane through the points is turned by less than an angle against another for sure, by the sine squared.
    pub(crate) fn is_along(&self, plane: &Flat, sine_squared: f64) -> bool {
        let c = self.covariance();
        let (trace, minors, _) = invariants(&c);
        let [x, y, z] = plane.normal.to_array();
        let off =
            c[0] * x * x + c[3] * y * y + c[5] * z * z + 2.0 * (c[1] * x * y + c[2] * x * z + c[4] * y * z);
        // λ₁ λ₂ = m − λ₀ (λ₁ + λ₂), λ₀ ≤ nᵀCn and λ₂ ≤ t.
        let across = (minors - off * trace) / trace;
        off <= sine_squared * across * (1.0 - ROUNDING)
    }
}

/// Trace, sum of the principal minors, determinant.
fn invariants([xx, xy, xz, yy, yz, zz]: &[f64; 6]) -> (f64, f64, f64) {
    let (a, b, c) = (yy * zz - yz * yz, xy * zz - yz * xz, xy * yz - yy * xz);
    (xx + yy + zz, a + (xx * zz - xz * xz) + (xx * yy - xy * xy), xx * a - xy * b + xz * c)
}
