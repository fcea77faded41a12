//! What is known of points as numbers on end: where each is from the centre of its voxel, then its error.

use terrace_stats::{Moments, SymmetricMatrix3};

use super::PointErrors;
use super::runs::Run;
use crate::grid::Home;
use crate::part::Part;
use crate::slots::Slots;

/// What is done with points of which so many numbers are known.
pub(super) trait WithRecords {
    /// `record` tells what is known of a point by where it is and its place among the errors.
    fn with_records<const W: usize>(self, record: impl Fn([f64; 3], usize) -> [f64; W]);
}

/// Does it with as many numbers as errors take.
#[inline]
pub(super) fn dispatch(errors: &PointErrors<'_>, what: impl WithRecords) {
    match errors {
        PointErrors::None | PointErrors::Same(_) => what.with_records(|value, _| value),
        PointErrors::Each(sigmas) => what.with_records(|[x, y, z], at| [x, y, z, sigmas[at] * sigmas[at]]),
        PointErrors::Axes(sigmas) => what.with_records(|[x, y, z], at| {
            let [a, b, c] = sigmas[at].map(|sigma| sigma * sigma);
            [x, y, z, a, b, c]
        }),
        PointErrors::Covariances(all) => what.with_records(|[x, y, z], at| {
            let [a, b, c, d, e, f] = all[at];
            [x, y, z, a, b, c, d, e, f]
        }),
    }
}

/// Adds runs of points of which this is known, each to the sums of its cell: as one point after the other, with the same bits.
#[inline]
pub(super) fn add_runs(slots: &mut Slots, runs: &[Run], errors: &PointErrors<'_>, records: &[f64]) {
    match errors {
        PointErrors::None => {
            add_with(slots, runs, records, |to, value: &[f64; 3]| to.push_independent(*value, [0.0; 3]));
        }
        PointErrors::Same(sigma) => {
            let variances = [sigma * sigma; 3];
            add_with(slots, runs, records, |to, value: &[f64; 3]| to.push_independent(*value, variances));
        }
        PointErrors::Each(_) => add_with(slots, runs, records, |to, [x, y, z, variance]: &[f64; 4]| {
            to.push_independent([*x, *y, *z], [*variance; 3]);
        }),
        PointErrors::Axes(_) => add_with(slots, runs, records, |to, [x, y, z, a, b, c]: &[f64; 6]| {
            to.push_independent([*x, *y, *z], [*a, *b, *c]);
        }),
        PointErrors::Covariances(_) => {
            add_with(slots, runs, records, |to, [x, y, z, noise @ ..]: &[f64; 9]| {
                to.push_covariant([*x, *y, *z], &SymmetricMatrix3(*noise));
            });
        }
    }
}

#[inline]
fn add_with<const W: usize>(
    slots: &mut Slots,
    runs: &[Run],
    records: &[f64],
    push: impl Fn(&mut Moments, &[f64; W]),
) {
    // The same instructions, for more numbers at a time where the processor can: not one bit differs.
    pulp::Arch::new().dispatch(AddRuns { slots, runs, records: records.as_chunks().0, push });
}

struct AddRuns<'a, const W: usize, P> {
    slots: &'a mut Slots,
    runs: &'a [Run],
    records: &'a [[f64; W]],
    push: P,
}

impl<const W: usize, P: Fn(&mut Moments, &[f64; W])> pulp::WithSimd for AddRuns<'_, W, P> {
    type Output = ();

    // Into what it is dispatched to.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let Self { slots, runs, mut records, push } = self;
        for run in runs {
            let (of_run, rest) = records.split_at(run.len());
            records = rest;
            let moments = &mut slots[run.slot].moments;
            // A copy that stays in registers.
            let mut sums = *moments;
            for record in of_run {
                push(&mut sums, record);
            }
            *moments = sums;
        }
    }
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
