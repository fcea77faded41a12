//! The planes around groups of cells, fitted when they are asked for.

use rayon::prelude::*;
use terrace_normals::EigenvalueBounds;
use terrace_stats::Stats;

use crate::cell::Noise;
use crate::field::Field;
use crate::flat::Flat;
use crate::sum::Sum;
use crate::turned::{Limit, Turned};

/// A neighbourhood with fewer points says too little.
pub(crate) const FEWEST: f64 = 8.0;
/// Points that scatter by less than this across their longer direction, in units of the variance of their errors, are a row.
pub(crate) const ROW: f64 = 2.0;
/// Rounding of a bound, as a share of it: bounds are kept in single precision.
pub(crate) const ROUNDING: f64 = 1e-6;

/// Cells that are handed to a thread at once.
const AT_ONCE: usize = 1024;

/// The plane of a neighbourhood.
#[derive(Debug, Clone)]
pub(crate) struct Around {
    pub(crate) plane: Flat,
    /// Variances of the points along the normal and along the two axes in the plane, in rising order, in m².
    variances: [f64; 3],
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
    /// How far the surface around each cell may be turned, where points have these errors.
    limits: (Option<Noise>, Vec<Limit>),
}

impl<'f> Arounds<'f> {
    pub(crate) fn of(field: &'f Field) -> Self {
        let known = field.levels.iter().map(|level| vec![0; level.len()]).collect();
        Self { field, known, found: Vec::new(), limits: (None, Vec::new()) }
    }

    pub(crate) fn field(&self) -> &'f Field {
        self.field
    }

    /// Takes the errors of points to be so, and surfaces to be along a plane that are turned by no more than an angle in radians and so many
    /// standard errors.
    pub(crate) fn limit(&mut self, noise: Noise, turned: f64, errors: f64) {
        if self.limits.0 != Some(noise) {
            let Some(bounded) = self.field.bounded.first() else { return };
            let in_units = self.field.in_units(noise);
            let cells = bounded.par_iter().zip(&self.field.turned).with_min_len(AT_ONCE);
            let limits = cells.map(|(bounded, around)| around.limit(bounded, in_units, turned, errors));
            self.limits = (Some(noise), limits.collect());
        }
    }

    /// Whether the surface around a cell is along a plane; `None` where only a fit tells.
    #[inline]
    pub(crate) fn is_along(&self, cell: usize, plane: &Flat) -> Option<bool> {
        self.limits.1[cell].is_along(&self.field.turned[cell], plane)
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
        Some(Self { plane: Flat::of(&fit), variances: fit.variances, points, stated, stated_across })
    }

    fn variance(&self, noise: Noise) -> f64 {
        (noise.scale * self.stated).max(noise.floor)
    }

    /// Variance of the points along the normal. Three of their freedoms went into the plane.
    fn thickness(&self) -> f64 {
        self.variances[0] * self.points / (self.points - 3.0)
    }

    /// Standard error of the orientation where it is least sure, in radians.
    pub(crate) fn tilt(&self, noise: Noise) -> f64 {
        (self.thickness().max(self.variance(noise)) / (self.points * self.variances[1])).sqrt()
    }

    /// Whether the points are a row: what they scatter across it is little more than their errors, so that the plane through them
    /// turns about the row as those fall. A ring of a lidar is one, a step of a depth image another.
    pub(crate) fn is_row(&self, noise: Noise) -> bool {
        let [_, across, _] = self.variances;
        across <= ROW * (noise.scale * self.stated_across).max(noise.floor)
    }

    /// Whether the points lie as flat as their errors say, give or take what so few of them tell, and not along a line.
    pub(crate) fn is_flat(&self, noise: Noise, chi_squared: f64, narrowest: f64) -> bool {
        let [_, across, along] = self.variances;
        self.thickness() <= allowed(chi_squared, self.points) * self.variance(noise)
            && across >= narrowest * along
            && !self.is_row(noise)
    }
}

/// The mean square of so many points that passes for this reduced χ².
fn allowed(chi_squared: f64, points: f64) -> f64 {
    chi_squared * (1.0 + 3.0 * (2.0 / points).sqrt())
}

/// What the sums of a neighbourhood tell of the plane through its points without a fit: nearly all are told by it. Variances are in units of
/// a squared edge of a cell, and all is in single precision, for it is kept of every neighbourhood.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bounded {
    points: f32,
    /// Bounds of the eigenvalues of the scatter, the two smaller ones from below and above, the largest from below.
    least: [f32; 2],
    middle: [f32; 2],
    most: f32,
    /// Bounds of the variance of errors along any direction, as stated.
    errors: [f32; 2],
}

/// What is in a [`Bounded`], to reckon with.
pub(crate) struct Bounds {
    pub(crate) points: f64,
    pub(crate) least: [f64; 2],
    pub(crate) middle: [f64; 2],
    pub(crate) most: f64,
    /// Of the variance of errors along any direction, at least the floor.
    pub(crate) errors: [f64; 2],
}

impl Bounded {
    /// Of points with these sums, this scatter and these bounds of its eigenvalues, for cells with an edge in metres.
    // Rounding is allowed for where numbers are made use of.
    #[allow(clippy::cast_possible_truncation)]
    pub(crate) fn of(sum: &Sum, bounds: &EigenvalueBounds, edge: f64) -> Self {
        let share = 1.0 / (edge * edge);
        let single = |x: f64| (x * share) as f32;
        Self {
            points: sum.points() as f32,
            least: bounds.least.map(single),
            middle: bounds.middle.map(single),
            most: single(bounds.most),
            errors: sum.noise().range().map(single),
        }
    }

    /// For errors of points in units of a squared edge.
    pub(crate) fn bounds(&self, noise: Noise) -> Bounds {
        Bounds {
            points: f64::from(self.points),
            least: self.least.map(f64::from),
            middle: self.middle.map(f64::from),
            most: f64::from(self.most),
            errors: self.errors.map(|v| (noise.scale * f64::from(v)).max(noise.floor)),
        }
    }

    /// A bound from below of the tilt of the plane through the points; `None` when it is no seed for sure, or they are too few: not
    /// flat, narrower than a share of their length, or a row. Errors are in units of a squared edge.
    pub(crate) fn least_tilt(&self, noise: Noise, chi_squared: f64, narrowest: f64) -> Option<f64> {
        let Bounds { points, least: [least, _], middle: [_, middle], most, errors } = self.bounds(noise);
        if points < FEWEST {
            return None;
        }
        let thickness = least * points / (points - 3.0);
        let [lowest, highest] = errors;
        let across = middle * (1.0 + ROUNDING);
        if thickness * (1.0 - ROUNDING) > allowed(chi_squared, points) * highest
            || across < narrowest * most * (1.0 - ROUNDING)
            || across <= ROW * lowest * (1.0 - ROUNDING)
        {
            return None;
        }
        let tilt = (thickness.max(lowest) / (points * middle)).sqrt() * (1.0 - ROUNDING);
        // Not a number where all is zero, and then of no plane.
        (!tilt.is_nan()).then_some(tilt)
    }
}

/// Both that are told of the neighbourhoods of cells: bounds, and how surfaces may be turned. As many at a time as fill a vector.
pub(crate) fn told<const N: usize>(sums: &[Sum; N], edge: f64) -> ([Bounded; N], [Turned; N]) {
    pulp::Arch::new().dispatch(Told { sums, edge })
}

/// [`told`] with the widest instructions there are.
struct Told<'s, const N: usize> {
    sums: &'s [Sum; N],
    edge: f64,
}

impl<const N: usize> pulp::WithSimd for Told<'_, N> {
    type Output = ([Bounded; N], [Turned; N]);

    // Into what it is dispatched to.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> Self::Output {
        let Self { sums, edge } = self;
        let scatters = std::array::from_fn(|lane| sums[lane].covariance());
        let bounds = EigenvalueBounds::of_all(&scatters);
        let bounded = std::array::from_fn(|lane| Bounded::of(&sums[lane], &bounds[lane], edge));
        (bounded, Turned::of_all(&scatters, &bounds))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cell::Sums;
    use glam::DVec3;
    use proptest::prelude::*;
    use terrace_stats::UncertainVector;

    const NOISE: Noise = Noise { scale: 1.0, floor: 1e-6 };
    const EDGE: f64 = 0.5;

    proptest! {
        /// From a line to a ball, of any thickness, turned in any way.
        #[test]
        fn bounds_are_those_of_the_fit(
            places in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 3..40),
            sizes in prop::array::uniform3(-6.0..0.0_f64),
            turn in prop::array::uniform3(-1.0..1.0_f64),
            normal in prop::array::uniform3(-1.0..1.0_f64),
            flat in any::<bool>(),
        ) {
            let axis = DVec3::from(turn).try_normalize().unwrap_or(DVec3::X);
            let rotation = glam::DQuat::from_axis_angle(axis, 3.0 * turn[0]);
            let sizes = if flat { DVec3::new(1.0, 0.7, 10_f64.powf(sizes[2])) } else { sizes.map(|s| 10_f64.powf(s)).into() };
            let mut stats = Stats::new([0.0; 3]);
            for place in &places {
                let place = rotation * (DVec3::from(*place) * sizes);
                stats.push(&UncertainVector::isotropic(place.to_array(), 1e-3));
            }
            let sum = Sums::of(&stats).unwrap().about(DVec3::ZERO);
            let around = Around::of(&stats);
            let normal = DVec3::from(normal).try_normalize().unwrap_or(DVec3::Z);
            let plane = Flat { normal, point: DVec3::ZERO };
            if let Some(around) = &around {
                let ([bounded], [turned]) = told(&[sum], EDGE);
                let in_units = NOISE.in_units(EDGE);
                let limit = turned.limit(&bounded, in_units, 0.3, 3.0);
                let is_along = around.is_row(NOISE) || plane.angle(&around.plane) <= 0.3 + 3.0 * around.tilt(NOISE);
                prop_assert!(limit.is_along(&turned, &plane).is_none_or(|told| told == is_along), "{limit:?}");
                match bounded.least_tilt(in_units, 2.0, 0.1) {
                    Some(tilt) => prop_assert!(tilt <= around.tilt(NOISE)),
                    None => prop_assert!(!around.is_flat(NOISE, 2.0, 0.1)),
                }
            }
        }
    }
}
