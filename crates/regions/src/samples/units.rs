//! Places in whole units of 16 bits, and where they look drawn at random.

/// Added to a number of up to 22 bits it rounds it to an integer, which is in the lowest bits then.
const ROUNDING: f32 = 1.5 * (1_u32 << 23) as f32;

/// Places that are packed at once: they stay in the nearest cache.
const BATCH: usize = 256;

/// Places that are scrambled at once.
pub(super) const LANES: usize = 16;
/// What the bits of coordinates are multiplied by, and turned left.
const SPREAD: [[u32; 3]; LANES] = [[0x9e37_79b9, 0x85eb_ca6b, 0xc2b2_ae35]; LANES];
const TURN: [[u32; 3]; LANES] = [[0, 11, 22]; LANES];

/// A place in whole units.
pub(crate) type Packed = [i16; 3];

/// What places are whole multiples of, in metres, and its inverse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Unit {
    metres: f32,
    per_metre: f32,
}

impl Unit {
    pub(super) const ONE: Self = Self { metres: 1.0, per_metre: 1.0 };

    // Powers of two are the same in single precision, for cells of any size that is of use.
    #[allow(clippy::cast_possible_truncation)]
    pub(super) fn new(unit: f64) -> Self {
        Self { metres: unit as f32, per_metre: (1.0 / unit) as f32 }
    }

    pub(super) fn metres(self) -> f32 {
        self.metres
    }

    pub(super) fn packed(self, place: [f32; 3]) -> Packed {
        place.map(|x| self.rounded(x))
    }

    // Into what it is dispatched to.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    pub(super) fn unpacked(self, packed: Packed) -> [f32; 3] {
        packed.map(|x| f32::from(x) * self.metres)
    }

    /// A coordinate in units, the nearest of 16 bits.
    // Into what it is dispatched to.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    fn rounded(self, x: f32) -> i16 {
        // What is no number is as far as can be: `max` gives the other.
        let units = (x * self.per_metre).max(f32::from(i16::MIN)).min(f32::from(i16::MAX)) + ROUNDING;
        // The lowest bits are the integer.
        #[allow(clippy::cast_possible_truncation)]
        let packed = units.to_bits() as u16;
        packed.cast_signed()
    }

    /// The coordinates of places that fill whole vectors as they lie, spread over all bits: what [`endured`] asks for.
    // Into what it is dispatched to.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    pub(super) fn spread(self, packed: &[Packed; LANES]) -> [[u32; 3]; LANES] {
        let mut each = [[0; 3]; LANES];
        let places = each.as_flattened_mut().iter_mut().zip(packed.as_flattened());
        let spread = SPREAD.as_flattened().iter().zip(TURN.as_flattened());
        for ((to, packed), (spread, turn)) in places.zip(spread) {
            let product = (f32::from(*packed) * self.metres).to_bits().wrapping_mul(*spread);
            // Turned left by so many bits, none too.
            *to = product << turn | product >> 1 >> (31 - turn);
        }
        each
    }

    /// Packs places, several at a time, and appends them.
    pub(super) fn pack(self, places: &[[f32; 3]], to: &mut Vec<Packed>) {
        let mut batch = [[0; 3]; BATCH];
        for places in places.chunks(BATCH) {
            pulp::Arch::new().dispatch(|| {
                let all = batch.as_flattened_mut().iter_mut().zip(places.as_flattened());
                all.for_each(|(packed, x)| *packed = self.rounded(*x));
            });
            to.extend_from_slice(&batch[..places.len()]);
        }
    }
}

/// How often the threshold can be halved, from 2³² on, before the scrambled place is no longer below it.
pub(super) fn endures([x, y, z]: [f32; 3]) -> u32 {
    let ([[a, b, c], ..], [[i, j, k], ..]) = (SPREAD, TURN);
    endured([
        x.to_bits().wrapping_mul(a).rotate_left(i),
        y.to_bits().wrapping_mul(b).rotate_left(j),
        z.to_bits().wrapping_mul(c).rotate_left(k),
    ])
}

/// The same, of coordinates that are spread.
// Into what it is dispatched to.
#[allow(clippy::inline_always)]
#[inline(always)]
pub(super) fn endured(spread: [u32; 3]) -> u32 {
    scrambled(spread).leading_zeros()
}

/// A number that looks drawn at random, and is the same for the same place.
// Into what it is dispatched to.
#[allow(clippy::inline_always)]
#[inline(always)]
fn scrambled([x, y, z]: [u32; 3]) -> u32 {
    let mix = x ^ y ^ z;
    let mix = (mix ^ mix >> 15).wrapping_mul(0x2c1b_3c6d);
    mix ^ mix >> 16
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn what_does_not_fit_is_at_the_end() {
        let unit = Unit::new(0.5);
        let ends = [f32::INFINITY, -1e30, 16384.0].map(|x| unit.packed([x, 0.0, 0.25])[0]);
        assert_eq!(ends, [i16::MAX, i16::MIN, i16::MAX]);
        assert_eq!(unit.packed([f32::NAN; 3]), [i16::MIN; 3]);
        // None is where it would be 0 with a sign.
        assert_eq!(unit.unpacked(unit.packed([-0.0; 3])).map(f32::to_bits), [0; 3]);
    }

    proptest! {
        #[test]
        fn many_are_packed_as_one_is(
            places in prop::collection::vec(prop::array::uniform3(-3.0..3.0_f32), 0..=40),
            unit in (-13.0..0.0_f64).prop_map(f64::exp2),
        ) {
            let unit = Unit::new(unit);
            let mut all = vec![[7; 3]];
            unit.pack(&places, &mut all);
            for (place, packed) in places.iter().zip(&all[1..]) {
                prop_assert_eq!(unit.packed(*place), *packed);
                let near = unit.unpacked(*packed);
                prop_assert_eq!(unit.packed(near), *packed);
                let spread = unit.spread(&[*packed; LANES]);
                let endured = endures(near);
                prop_assert_eq!(spread.map(super::endured), [endured; LANES]);
                // Below 2³² halved so often, and not below its half.
                let scrambled = u64::from(scrambled(spread[0]));
                prop_assert!(scrambled < 1 << 32 >> endured);
                prop_assert!(2 * scrambled >= 1 << 32 >> endured || scrambled == 0);
                for (x, near) in place.iter().zip(near) {
                    // A unit that is no power of two is rounded itself.
                    prop_assert!((x - near).abs() <= 0.51 * unit.metres);
                }
            }
        }
    }
}
