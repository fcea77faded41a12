//! The level of noise that residuals show, where no standard errors are given.

use glam::DVec3;
use terrace_stats::{Moments, Stats, SymmetricMatrix3};

use super::Errors;
use super::sightings::Sighting;

/// Places with fewer points say little of their scatter.
const FEWEST: u64 = 8;
/// Scatter below this share of the extent of a place, both squared, is rounding.
const ROUNDING: f64 = 1e-13;
/// Places for each range at which the level is told, at least, and the most such ranges.
const PER_KNOT: usize = 40;
const MOST_KNOTS: usize = 12;
/// Places seen at angles whose squared cosines have a smaller variance do not tell errors along rays from those across.
const ANGLES: f64 = 0.01;
/// Rounds in which places that scatter by more than this, in units of what the others tell, are left out.
const ROUNDS: usize = 4;
const OUTLYING: f64 = 3.0;

/// Standard errors found from the data: how far points lie from the plane of their own place, in the median over flat
/// places, by their distance from the sensor where that is known.
///
/// Flat places are columns of cells of one plane, off its borders. The scatter about their mean is taken, so that what
/// moves or bends the plane as a whole does not count as noise. Where it is known from where points were seen, errors along
/// the rays are told from those across them by the angles at which places were seen.
#[derive(Debug, Clone, PartialEq)]
pub struct NoiseLevel {
    /// In the order of distance. A single one when there are few places or distances are not known.
    pub knots: Vec<NoiseKnot>,
    /// Number of flat places.
    pub places: usize,
}

/// The level of noise at a distance, in metres. Between two it goes in a straight line, and beyond them on as it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NoiseKnot {
    /// From the sensor; `None` when it is not known where sensors stood.
    pub range: Option<f64>,
    /// Standard error along the ray.
    pub along: f64,
    /// Standard error in each direction across the ray.
    pub across: f64,
}

/// What a flat place shows.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Residual {
    range: Option<f64>,
    /// Mean squared cosine of the angle between rays and normal.
    cosine: Option<f64>,
    /// An estimate of the variance along the normal whose median is right.
    pub(crate) variance: f64,
}

/// What flat places show.
#[derive(Debug, Default)]
pub(crate) struct Residuals {
    of: Vec<Residual>,
}

impl Residuals {
    /// The scatter of the points of a place along a normal.
    pub(crate) fn push(&mut self, errors: &Errors, seen: &[Sighting], place: &Stats, normal: [f64; 3]) {
        self.of.extend(Residual::of(errors, seen, place, normal));
    }
}

impl FromIterator<Residual> for Residuals {
    fn from_iter<I: IntoIterator<Item = Residual>>(of: I) -> Self {
        Self { of: of.into_iter().collect() }
    }
}

impl Residual {
    /// Of few points there is none.
    pub(crate) fn of(errors: &Errors, seen: &[Sighting], place: &Stats, normal: [f64; 3]) -> Option<Self> {
        let variance = scatter_along(place.moments(), normal)?;
        let mut sums = [0.0; 3];
        for (share, ray) in errors.rays(place, seen) {
            let cosine = ray.normalize_or_zero().dot(DVec3::from(normal));
            sums = [sums[0] + share, sums[1] + share * ray.length(), sums[2] + share * cosine * cosine];
        }
        let mean = |sum: f64| (sums[0] > 0.0).then(|| sum / sums[0]);
        Some(Self { range: mean(sums[1]), cosine: mean(sums[2]), variance })
    }
}

/// An estimate of the variance of the points along a normal whose median is right; `None` for few points.
pub(crate) fn scatter_along(place: &Moments, normal: [f64; 3]) -> Option<f64> {
    if place.count() < FEWEST {
        return None;
    }
    let mean = DVec3::from(place.sum()) / place.weight();
    let of_mean = mean.dot(DVec3::from(normal));
    let scatter = place.second().quadratic_form(normal) / place.weight() - of_mean * of_mean;
    let extent = place.second().trace() / place.weight() - mean.length_squared();
    let along = if scatter > ROUNDING * extent { scatter } else { 0.0 };
    let freedom = place.count() as f64 - 1.0;
    // The median of χ² over its degrees of freedom (Wilson and Hilferty 1931).
    let median = (1.0 - 2.0 / (9.0 * freedom)).powi(3);
    Some(along * place.count() as f64 / freedom / median).filter(|variance| variance.is_finite())
}

impl NoiseLevel {
    /// `None` without places, or when their points lie exactly in a plane.
    pub(crate) fn of(residuals: &Residuals) -> Option<Self> {
        let mut seen = residuals.of.clone();
        let known = seen.iter().all(|place| place.range.is_some());
        let knots = if known { (seen.len() / PER_KNOT).clamp(1, MOST_KNOTS) } else { 1 };
        if knots > 1 {
            let range = |of: &Residual| of.range.unwrap_or(f64::NEG_INFINITY);
            seen.sort_unstable_by(|a, b| {
                range(a).total_cmp(&range(b)).then(a.variance.total_cmp(&b.variance))
            });
        }
        let part = |k: usize| seen.get(k * seen.len() / knots..(k + 1) * seen.len() / knots);
        let knots: Vec<NoiseKnot> = (0..knots).filter_map(part).filter_map(NoiseKnot::of).collect();
        knots
            .iter()
            .any(|knot| knot.along > 0.0 || knot.across > 0.0)
            .then_some(Self { knots, places: seen.len() })
    }

    /// Standard errors along a ray and across, at a distance from the sensor in metres; at the middle distance where it is not
    /// known.
    pub fn at(&self, range: Option<f64>) -> (f64, f64) {
        let known = |knot: &NoiseKnot| Some((knot.range?, knot.along, knot.across));
        let knots: Option<Vec<_>> = self.knots.iter().map(known).collect();
        let (Some(range), Some(knots)) = (range, knots) else {
            return self.knots.get(self.knots.len() / 2).map_or((0.0, 0.0), |knot| (knot.along, knot.across));
        };
        let after = knots.partition_point(|(at, ..)| *at < range);
        match (after.checked_sub(1).and_then(|before| knots.get(before)), knots.get(after)) {
            (Some(low), Some(high)) => {
                let share = (range - low.0) / (high.0 - low.0);
                (low.1 + share * (high.1 - low.1), low.2 + share * (high.2 - low.2))
            }
            (Some(end), None) | (None, Some(end)) => (end.1, end.2),
            (None, None) => (0.0, 0.0),
        }
    }

    /// The covariance of a point of a place, seen so.
    pub(crate) fn covariance(&self, errors: &Errors, place: &Stats, seen: &[Sighting]) -> SymmetricMatrix3 {
        let (mut sum, mut all) = (SymmetricMatrix3::ZERO, 0.0);
        for (share, ray) in errors.rays(place, seen) {
            let (along, across) = self.at(Some(ray.length()));
            let (along, across) = (along * along, across * across);
            let beyond = SymmetricMatrix3::outer(ray.normalize_or_zero().to_array()) * (along - across);
            sum += (SymmetricMatrix3::diagonal([across; 3]) + beyond) * share;
            all += share;
        }
        if all > 0.0 {
            return sum * (1.0 / all);
        }
        let (along, across) = self.at(None);
        SymmetricMatrix3::diagonal([f64::midpoint(along * along, across * across); 3])
    }
}

impl NoiseKnot {
    fn of(places: &[Residual]) -> Option<Self> {
        let mut variances: Vec<f64> = places.iter().map(|place| place.variance).collect();
        let middle = variances.len() / 2;
        if variances.is_empty() {
            return None;
        }
        let median = *variances.select_nth_unstable_by(middle, f64::total_cmp).1;
        let [along, across] = along_and_across(places, median).unwrap_or([median; 2]).map(f64::sqrt);
        Some(Self { range: places.get(places.len() / 2)?.range, along, across })
    }
}

/// The variances that give `along cos² + across sin²` at the angles at which places were seen, by least squares of relative
/// errors; `None` where angles do not tell them apart.
fn along_and_across(places: &[Residual], median: f64) -> Option<[f64; 2]> {
    let seen: Option<Vec<(f64, f64)>> = places.iter().map(|p| Some((p.cosine?, p.variance))).collect();
    let seen = seen?;
    let mean = seen.iter().map(|(c, _)| c).sum::<f64>() / seen.len() as f64;
    let spread = seen.iter().map(|(c, _)| (c - mean).powi(2)).sum::<f64>() / seen.len() as f64;
    if spread < ANGLES {
        return None;
    }
    let mut found = [median; 2];
    for _ in 0..ROUNDS {
        let [mut aa, mut ab, mut bb, mut ay, mut by] = [0.0; 5];
        for (cosine, variance) in &seen {
            let told = found[0] * cosine + found[1] * (1.0 - cosine);
            if told <= 0.0 || *variance > OUTLYING * told {
                continue;
            }
            // The scatter of a place is off in proportion to itself.
            let (a, b, y) = (cosine / told, (1.0 - cosine) / told, variance / told);
            [aa, ab, bb, ay, by] = [aa + a * a, ab + a * b, bb + b * b, ay + a * y, by + b * y];
        }
        let determinant = aa * bb - ab * ab;
        let both = [(bb * ay - ab * by) / determinant, (aa * by - ab * ay) / determinant];
        // A variance below zero means that there is none: all of it is of the other kind.
        found = match both {
            [a, b] if a >= 0.0 && b >= 0.0 => both,
            [_, b] if b < 0.0 => [ay / aa, 0.0],
            _ => [0.0, by / bb],
        };
    }
    found.iter().all(|variance| variance.is_finite()).then_some(found)
}

impl Errors<'_> {
    /// From the sensors to the mean of a place, each with the number of its points that were seen from there.
    fn rays(&self, place: &Stats, seen: &[Sighting]) -> impl Iterator<Item = (f64, DVec3)> {
        let mean = place.mean().map(DVec3::from);
        seen.iter().filter_map(move |sighting| {
            let sensor = self.views.get(sighting.view as usize)?.sensor?;
            Some((f64::from(sighting.points), mean? - DVec3::from(sensor)))
        })
    }

    /// From where a cell was seen; nothing where that does not matter.
    pub(crate) fn seen(&self, cell: usize) -> &[Sighting] {
        self.sightings.as_ref().map_or(&[], |sightings| sightings.of_cell(cell))
    }
}
