//! The points of a run as numbers on end: each from the centre of its voxel, then what is known of its error.

use std::ops::Range;

use terrace_stats::{Moments, SymmetricMatrix3};

use super::PointErrors;
use crate::grid::Home;
use crate::part::Part;

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

/// Adds points, each to the sums of its cell and in their order, with the same bits.
#[inline]
pub(super) fn add_each(parts: &mut [Part], homes: &[Home], local: &[[f64; 3]], errors: &PointErrors<'_>) {
    match errors {
        PointErrors::None => independent(parts, homes, local, |_| [0.0; 3]),
        PointErrors::Same(sigma) => independent(parts, homes, local, |_| [sigma * sigma; 3]),
        PointErrors::Each(sigmas) => independent(parts, homes, local, |at| [sigmas[at] * sigmas[at]; 3]),
        PointErrors::Axes(sigmas) => {
            independent(parts, homes, local, |at| sigmas[at].map(|sigma| sigma * sigma));
        }
        PointErrors::Covariances(all) => {
            for ((home, local), covariance) in homes.iter().zip(local).zip(*all) {
                moments_of(parts, *home).push_covariant(*local, &SymmetricMatrix3(*covariance));
            }
        }
    }
}

#[inline]
fn independent(
    parts: &mut [Part],
    homes: &[Home],
    local: &[[f64; 3]],
    variances: impl Fn(usize) -> [f64; 3],
) {
    // The same instructions, for more numbers at a time where the processor can: not one bit differs.
    pulp::Arch::new().dispatch(Independent { parts, homes, local, variances });
}

struct Independent<'a, V> {
    parts: &'a mut [Part],
    homes: &'a [Home],
    local: &'a [[f64; 3]],
    variances: V,
}

impl<V: Fn(usize) -> [f64; 3]> pulp::WithSimd for Independent<'_, V> {
    type Output = ();

    // Into what it is dispatched to: a closure of this length is not.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        for (at, (home, local)) in self.homes.iter().zip(self.local).enumerate() {
            moments_of(self.parts, *home).push_independent(*local, (self.variances)(at));
        }
    }
}

#[allow(clippy::inline_always)]
#[inline(always)]
fn moments_of(parts: &mut [Part], home: Home) -> &mut Moments {
    &mut parts[home.part as usize].slots[home.slot].moments
}
