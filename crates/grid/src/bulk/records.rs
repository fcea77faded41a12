//! The points of a run as numbers on end: each from the centre of its voxel, then what is known of its error.

use std::ops::Range;

use terrace_stats::{Moments, SymmetricMatrix3};

use super::PointErrors;

/// How many numbers a point is written with.
#[inline]
pub(super) fn width(errors: &PointErrors<'_>) -> usize {
    match errors {
        PointErrors::None | PointErrors::Same(_) => 3,
        PointErrors::Each(_) => 4,
        PointErrors::Axes(_) => 6,
        PointErrors::Covariances(_) => 9,
    }
}

/// Writes points. `range` are their places among those of the errors.
#[inline]
pub(super) fn write(
    points: &[[f64; 3]],
    centre: [f64; 3],
    errors: &PointErrors<'_>,
    range: Range<usize>,
    to: &mut [f64],
) {
    let records = to.chunks_exact_mut(width(errors)).zip(points).zip(range);
    for ((record, point), at) in records {
        let (value, noise) = record.split_at_mut(3);
        for i in 0..3 {
            value[i] = point[i] - centre[i];
        }
        match errors {
            PointErrors::None | PointErrors::Same(_) => {}
            PointErrors::Each(sigmas) => noise[0] = sigmas[at] * sigmas[at],
            PointErrors::Axes(sigmas) => noise.copy_from_slice(&sigmas[at].map(|sigma| sigma * sigma)),
            PointErrors::Covariances(all) => noise.copy_from_slice(&all[at]),
        }
    }
}

/// Adds so many points that were written, one after the other as they would be alone, and returns what is left to read.
#[inline]
pub(super) fn add<'n>(
    moments: &mut Moments,
    points: usize,
    errors: &PointErrors<'_>,
    from: &'n [f64],
) -> &'n [f64] {
    let (written, rest) = from.split_at(points * width(errors));
    match errors {
        PointErrors::None => {
            moments.extend_independent(written.as_chunks().0.iter().map(|value| (*value, [0.0; 3])));
        }
        PointErrors::Same(sigma) => {
            let variances = [sigma * sigma; 3];
            moments.extend_independent(written.as_chunks().0.iter().map(|value| (*value, variances)));
        }
        PointErrors::Each(_) => {
            let points = written.as_chunks().0.iter();
            moments.extend_independent(points.map(|[x, y, z, variance]| ([*x, *y, *z], [*variance; 3])));
        }
        PointErrors::Axes(_) => {
            let points = written.as_chunks().0.iter();
            moments.extend_independent(points.map(|[x, y, z, a, b, c]| ([*x, *y, *z], [*a, *b, *c])));
        }
        PointErrors::Covariances(_) => {
            // A copy that stays in registers.
            let mut sums = *moments;
            for [x, y, z, noise @ ..] in written.as_chunks::<9>().0 {
                sums.push_covariant([*x, *y, *z], &SymmetricMatrix3(*noise));
            }
            *moments = sums;
        }
    }
    rest
}

/// Adds points as they are, with the same bits.
#[inline]
pub(super) fn add_points(
    moments: &mut Moments,
    points: &[[f64; 3]],
    anchor: [f64; 3],
    errors: &PointErrors<'_>,
) {
    let local = |point: &[f64; 3]| [0, 1, 2].map(|i| point[i] - anchor[i]);
    let squared = |sigma: f64| sigma * sigma;
    match errors {
        PointErrors::None => moments.extend_independent(points.iter().map(|point| (local(point), [0.0; 3]))),
        PointErrors::Same(sigma) => {
            let variances = [squared(*sigma); 3];
            moments.extend_independent(points.iter().map(|point| (local(point), variances)));
        }
        PointErrors::Each(sigmas) => {
            let vectors = points.iter().zip(*sigmas);
            moments.extend_independent(vectors.map(|(point, sigma)| (local(point), [squared(*sigma); 3])));
        }
        PointErrors::Axes(sigmas) => {
            let vectors = points.iter().zip(*sigmas);
            moments.extend_independent(vectors.map(|(point, sigma)| (local(point), sigma.map(squared))));
        }
        PointErrors::Covariances(all) => {
            let mut sums = *moments;
            for (point, covariance) in points.iter().zip(*all) {
                sums.push_covariant(local(point), &SymmetricMatrix3(*covariance));
            }
            *moments = sums;
        }
    }
}
