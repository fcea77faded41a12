//! The voxels of many points.

use super::{PointErrors, Taken};
use crate::key::{Lattice, key_of};
use crate::{GridError, MAX_INDEX, VoxelKey};

/// Points whose voxels are found at once: their lists stay in the nearest cache.
pub(super) const BATCH: usize = 128;

/// The index of a coordinate that is out of range or not finite.
const OUTSIDE: i32 = i32::MAX;
/// The key of a point that is in no voxel.
pub(super) const NOWHERE: VoxelKey = [OUTSIDE; 3];

/// Numbers up to 2⁵¹ become integers when this is added, rounded to the nearest, with the integer in the lowest bits.
const ROUNDING: f64 = 1.5 * (1_u64 << 52) as f64;

/// The voxels of up to [`BATCH`] points, and where the points are from their centres.
#[derive(Debug)]
pub(super) struct Located {
    /// What is out of range has such a coordinate: see [`is_outside`].
    pub(super) keys: [VoxelKey; BATCH],
    /// In whole units.
    pub(super) places: [Place; BATCH],
    /// The places before they are rounded.
    pub(super) local: [[f64; 3]; BATCH],
}

impl Located {
    pub(super) fn new() -> Self {
        Self { keys: [NOWHERE; BATCH], places: [[0; 3]; BATCH], local: [[0.0; 3]; BATCH] }
    }

    /// Looks at some points; tells whether all are in range.
    ///
    /// The voxel is that of the quotient as computed, rounded down: `x * (1 / size)` would be another number on the faces
    /// of voxels. There is no call and no branch in the loop, so that several coordinates are done at a time, with any
    /// instruction set; the result is exact, so the same with each.
    pub(super) fn locate(&mut self, points: &[[f64; 3]], lattice: Lattice) -> bool {
        // The same instructions, for more numbers at a time where the processor can: not one bit differs.
        pulp::Arch::new().dispatch(|| {
            if lattice.halves {
                self.located::<true>(points, lattice.size)
            } else {
                self.located::<false>(points, lattice.size)
            }
        })
    }

    // Into what it is dispatched to.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    fn located<const HALVES: bool>(&mut self, points: &[[f64; 3]], size: f64) -> bool {
        let (_, per_unit) = unit_of(size);
        let keys = self.keys.as_flattened_mut().iter_mut();
        let places = self.places.as_flattened_mut().iter_mut();
        let local = self.local.as_flattened_mut().iter_mut();
        let mut inside = true;
        for (((x, key), place), local) in points.as_flattened().iter().zip(keys).zip(places).zip(local) {
            let quotient = x / size;
            let floor = floor(quotient);
            let is_inside = floor.abs() <= f64::from(MAX_INDEX);
            inside &= is_inside;
            // The lowest bits are the integer.
            #[allow(clippy::cast_possible_truncation)]
            let index = (floor + ROUNDING).to_bits() as u32;
            *key = if is_inside { index.cast_signed() } else { OUTSIDE };
            let anchor =
                if HALVES { (self::floor(0.5 * floor) + 0.5) * (2.0 * size) } else { (floor + 0.5) * size };
            // Whole numbers, so that sums of places are exact, whatever their order.
            #[allow(clippy::cast_possible_truncation)]
            let rounded = (((x - anchor) * per_unit).min(MOST_UNITS) + ROUNDING).to_bits() as u16;
            *local = x - anchor;
            *place = rounded.cast_signed();
        }
        inside
    }

    /// Takes out the points that cannot be inserted.
    pub(super) fn refuse(
        &mut self,
        points: &[[f64; 3]],
        errors: &PointErrors<'_>,
        lattice: Lattice,
        taken: &mut Taken,
    ) {
        for (at, point) in points.iter().enumerate() {
            // Of nearly all there is none, also where some are absent.
            let refusal = if is_outside(self.keys[at]) {
                match key_of(*point, lattice.size) {
                    Err(absent @ GridError::PointNotFinite { .. }) => Some(absent),
                    key => errors.refusal(at).or(key.err()),
                }
            } else {
                errors.refusal(at)
            };
            if let Some(refusal) = refusal {
                self.keys[at] = NOWHERE;
                self.places[at] = [0; 3];
                taken.refuse(refusal);
            }
        }
    }
}

/// Whether the key is that of a point out of range.
#[inline]
pub(super) fn is_outside(key: VoxelKey) -> bool {
    key.contains(&OUTSIDE)
}

/// Where a point is from the anchor of its voxel, in whole units.
pub(super) type Place = [i16; 3];

/// Places are no further than a cell from their anchor, which is less than this.
const MOST_UNITS: f64 = i16::MAX as f64;

/// What places are rounded to, in metres, and its inverse: a power of two, of which a cell has no more than 2¹⁵.
pub(crate) fn unit_of(size: f64) -> (f64, f64) {
    // The exponent bits alone are the power of two below.
    let below = f64::from_bits(size.to_bits() & (0x7ff << 52));
    let unit = below * (-14_f64).exp2();
    (unit, 1.0 / unit)
}

/// The integer nearest to a number, for numbers up to 2⁵¹.
#[allow(clippy::inline_always)]
#[inline(always)]
fn whole(x: f64) -> f64 {
    (x + ROUNDING) - ROUNDING
}

/// The largest integer up to a number, for numbers up to 2⁵¹.
#[allow(clippy::inline_always)]
#[inline(always)]
fn floor(x: f64) -> f64 {
    let nearest = whole(x);
    nearest - if nearest > x { 1.0 } else { 0.0 }
}
