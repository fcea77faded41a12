//! The level of noise that residuals show, where no standard errors are given.

use terrace_stats::Stats;

use super::Errors;
use super::sightings::Sighting;

/// Places with fewer points say little of their scatter.
const FEWEST: u64 = 8;
/// Places for each range at which the level is told, at least, and the most such ranges.
const PER_KNOT: usize = 40;
const MOST_KNOTS: usize = 12;

/// Standard errors found from the data: how far points lie from the plane of their own place, in the median over flat
/// places, by their distance from the sensor where that is known.
///
/// Flat places are columns of cells of one plane, off its borders. The scatter about their mean is taken, so that what
/// moves or bends the plane as a whole does not count as noise.
#[derive(Debug, Clone, PartialEq)]
pub struct NoiseLevel {
    /// (Distance from the sensor, standard error), both in metres, in the order of distance; between them it goes in a
    /// straight line, and beyond them on as it is. A single one, with the median distance, when there are few places. The
    /// distance is `None` when it is not known where sensors stood.
    pub knots: Vec<(Option<f64>, f64)>,
    /// Number of flat places.
    pub places: usize,
}

/// What flat places show.
#[derive(Default)]
pub(crate) struct Residuals {
    /// Range, and an estimate of the variance whose median is right.
    of: Vec<(Option<f64>, f64)>,
}

impl Residuals {
    /// The scatter of the points of a place along a normal.
    pub(crate) fn push(&mut self, range: Option<f64>, place: &Stats, normal: [f64; 3]) {
        self.of.extend(scatter_along(place, normal).map(|variance| (range, variance)));
    }
}

/// An estimate of the variance of the points along a normal whose median is right; `None` for few points.
pub(crate) fn scatter_along(place: &Stats, normal: [f64; 3]) -> Option<f64> {
    let scatter = place.covariance().filter(|_| place.count() >= FEWEST)?.quadratic_form(normal).max(0.0);
    let freedom = place.count() as f64 - 1.0;
    // The median of χ² over its degrees of freedom (Wilson and Hilferty 1931).
    let median = (1.0 - 2.0 / (9.0 * freedom)).powi(3);
    Some(scatter * place.count() as f64 / freedom / median).filter(|variance| variance.is_finite())
}

impl NoiseLevel {
    /// `None` without places, or when their points lie exactly in a plane.
    pub(crate) fn of(residuals: &Residuals) -> Option<Self> {
        let mut seen = residuals.of.clone();
        seen.sort_by(|a, b| range_of(a).total_cmp(&range_of(b)).then(a.1.total_cmp(&b.1)));
        let knots = (seen.len() / PER_KNOT).clamp(1, MOST_KNOTS);
        let knots: Vec<(Option<f64>, f64)> = (0..knots)
            .filter_map(|k| seen.get(k * seen.len() / knots..(k + 1) * seen.len() / knots))
            .filter_map(|part| {
                let mut variances: Vec<f64> = part.iter().map(|(_, variance)| *variance).collect();
                variances.sort_by(f64::total_cmp);
                Some((part.get(part.len() / 2)?.0, variances.get(part.len() / 2)?.sqrt()))
            })
            .collect();
        knots.iter().any(|(_, sigma)| *sigma > 0.0).then_some(Self { knots, places: seen.len() })
    }

    /// The standard error at a distance from the sensor, both in metres.
    pub fn sigma(&self, range: Option<f64>) -> f64 {
        let Some(range) = range else { return self.middle() };
        let mut before: Option<(f64, f64)> = None;
        for (at, sigma) in &self.knots {
            let Some(at) = *at else { return self.middle() };
            if range <= at {
                return match before {
                    Some((low, from)) if at > low => from + (sigma - from) * (range - low) / (at - low),
                    _ => *sigma,
                };
            }
            before = Some((at, *sigma));
        }
        before.map_or(0.0, |(_, sigma)| sigma)
    }

    /// Where nothing is known of the distance.
    fn middle(&self) -> f64 {
        let mut sigmas: Vec<f64> = self.knots.iter().map(|(_, sigma)| *sigma).collect();
        sigmas.sort_by(f64::total_cmp);
        sigmas.get(sigmas.len() / 2).copied().unwrap_or(0.0)
    }
}

impl Errors<'_> {
    /// The mean distance of the sensors from the points of a cell.
    pub(crate) fn range(&self, stats: &Stats, cell: usize) -> Option<f64> {
        self.range_of(stats, self.sightings.as_ref()?.of_cell(cell))
    }

    pub(crate) fn range_of(&self, stats: &Stats, seen: &[Sighting]) -> Option<f64> {
        let mean = stats.mean()?;
        let (mut sum, mut points) = (0.0, 0.0);
        for sighting in seen {
            let Some(sensor) = self.views.get(sighting.view as usize).and_then(|view| view.sensor) else {
                continue;
            };
            let squared: f64 = (0..3).map(|i| (mean[i] - sensor[i]).powi(2)).sum();
            sum += f64::from(sighting.points) * squared.sqrt();
            points += f64::from(sighting.points);
        }
        (points > 0.0).then(|| sum / points)
    }
}

/// Places seen from nowhere come first.
fn range_of(seen: &(Option<f64>, f64)) -> f64 {
    seen.0.unwrap_or(f64::NEG_INFINITY)
}
