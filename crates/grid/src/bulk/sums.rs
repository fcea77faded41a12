//! Points into the sums of their cells.

use terrace_stats::{Moments, SymmetricMatrix3};

use super::PointErrors;
use crate::grid::Home;
use crate::part::Part;

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
