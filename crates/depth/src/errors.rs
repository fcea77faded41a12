//! How large errors of depths are: stated by a model of the sensor, or found from how flat tiles scatter.

use glam::DVec3;
use terrace_noise::ScanNoise;
use terrace_stats::{Moments, SymmetricMatrix3};

use crate::camera::Camera;
use crate::flat::{Fitted, Noise};
use crate::tiles::TILE;

/// The share of tiles that scatter by their errors alone is taken to be at least twice this.
const QUANTILE: f64 = 0.3;
/// Errors are found for so many depths at most, from so many tiles at least.
const STEPS: usize = 12;
const FEWEST_TILES: usize = 24;
/// One in so many tiles is looked at: no divisor of the tiles in a row of common images.
const EVERY: usize = 3;
/// Errors are taken for larger than stated by this at most, as a variance.
const MOST_SCALE: f64 = 10.0;
/// Tiles with fewer of their pixels tell nothing of errors.
const FULL: f64 = 0.75;
/// Tiles that are seen at a smaller cosine neither.
const STEEPEST: f64 = 0.2;

/// The errors of an image.
#[derive(Debug, Clone)]
pub(crate) enum Errors {
    /// By a model, in the frame of the camera.
    Stated(ScanNoise),
    /// Depths, rising, and the variance of an error there along z, in m².
    Found(Vec<[f64; 2]>),
}

impl Errors {
    /// Covariance of the error of a point, in m²; `None` where the sensor can have measured none.
    pub(crate) fn at(&self, point: DVec3) -> Option<SymmetricMatrix3> {
        match self {
            Self::Stated(noise) => Some(SymmetricMatrix3(noise.covariance(point.to_array())?.entries())),
            Self::Found(steps) => {
                let variance = between(steps, point.z)?;
                // What is measured is the depth along the ray.
                let [x, y] = [point.x / point.z, point.y / point.z];
                Some(SymmetricMatrix3([x * x, x * y, x, y * y, y, 1.0]) * variance)
            }
        }
    }

    /// From how the tiles of an image scatter about planes of their own: at each depth by what the flatter ones of the tiles there do.
    pub(crate) fn found(tiles: &[Moments], camera: &Camera) -> Self {
        // A raw unit is the least that two depths differ by.
        let least = camera.unit * camera.unit / 12.0;
        let scatter = |_: &Moments, fitted: &Fitted| {
            let depth = fitted.plane.point.z;
            let slope = fitted.plane.normal.dot(fitted.plane.point) / depth;
            let seen = slope.abs() >= STEEPEST && depth > 0.0;
            seen.then(|| [depth, (fitted.thickness / (slope * slope)).max(least)])
        };
        let mut all: Vec<[f64; 2]> = some(tiles, scatter);
        all.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let size = all.len().div_ceil(STEPS).max(FEWEST_TILES);
        let step = |tiles: &mut [[f64; 2]]| {
            let depth = tiles.iter().map(|[depth, _]| depth).sum::<f64>() / tiles.len() as f64;
            let at = place(tiles.len());
            let (_, [_, variance], _) = tiles.select_nth_unstable_by(at, |a, b| a[1].total_cmp(&b[1]));
            [depth, *variance]
        };
        let steps: Vec<[f64; 2]> = all.chunks_mut(size).map(step).collect();
        Self::Found(if steps.is_empty() { vec![[1.0, least]] } else { steps })
    }
}

/// What the variances of stated errors are to be multiplied by: more than 1 where even the flatter tiles scatter by more.
pub(crate) fn scale_of(tiles: &[Moments]) -> f64 {
    let ratio = |sum: &Moments, fitted: &Fitted| {
        let stated = sum.mean_noise()?.quadratic_form(fitted.plane.normal.to_array());
        (stated > 0.0).then(|| fitted.thickness / stated)
    };
    let mut all: Vec<f64> = some(tiles, ratio);
    if all.len() < FEWEST_TILES {
        return 1.0;
    }
    let at = place(all.len());
    let (_, ratio, _) = all.select_nth_unstable_by(at, f64::total_cmp);
    ratio.clamp(1.0, MOST_SCALE)
}

/// Where [`QUANTILE`] is in a sorted list.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place in the list")]
fn place(len: usize) -> usize {
    (QUANTILE * len as f64) as usize
}

/// What is found of a share of the tiles, which tells of all: of those that are full enough, with the planes of these, whatever their
/// errors.
fn some<T>(tiles: &[Moments], of: impl Fn(&Moments, &Fitted) -> Option<T>) -> Vec<T> {
    let any = Noise { scale: 0.0, floor: f64::MIN_POSITIVE.sqrt() };
    let full = FULL * (TILE * TILE) as f64;
    let full: Vec<&Moments> = tiles.iter().step_by(EVERY).filter(|sum| sum.weight() >= full).collect();
    let mut found = Vec::with_capacity(full.len());
    let mut sums = full.iter();
    Fitted::of_all(full.iter().copied(), any, |fitted| {
        found.extend(sums.next().zip(fitted.as_ref()).and_then(|(sum, fitted)| of(sum, fitted)));
    });
    found
}

/// The variance at a depth: straight between the square roots of those around it, and by the square of the depth beyond them.
fn between(steps: &[[f64; 2]], depth: f64) -> Option<f64> {
    let (first, last) = (steps.first()?, steps.last()?);
    if depth <= first[0] {
        return Some(first[1]);
    }
    if depth >= last[0] {
        return Some(last[1] * (depth / last[0]).powi(4));
    }
    let above = steps.partition_point(|step| step[0] < depth);
    let [low, high] = steps.get(above.wrapping_sub(1)..=above)?.first_chunk().copied()?;
    let share = (depth - low[0]) / (high[0] - low[0]);
    Some((low[1].sqrt() + share * (high[1].sqrt() - low[1].sqrt())).powi(2))
}
