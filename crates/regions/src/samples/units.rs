//! Places in whole units of 16 bits, and where they look drawn at random.

/// Added to a number of up to 22 bits it rounds it to an integer, which is in the lowest bits then.
const ROUNDING: f32 = 1.5 * (1_u32 << 23) as f32;

/// Places that are packed at once: they stay in the nearest cache.
const BATCH: usize = 256;

/// Places that are scrambled at once.
const LANES: usize = 16;
/// What the bits of coordinates are multiplied by, and turned left.
const SPREAD: [[u32; 3]; LANES] = [[0x9e37_79b9, 0x85eb_ca6b, 0xc2b2_ae35]; LANES];
const TURN: [[u32; 3]; LANES] = [[0, 11, 22]; LANES];

/// A place in whole units.
pub(crate) type Packed = [i16; 3];

/// What places are whole multiples of, in metres, and its inverse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Unit {
    unit: f32,
    per_unit: f32,
}

impl Unit {
    pub(super) const ONE: Self = Self { unit: 1.0, per_unit: 1.0 };

    // Powers of two are the same in single precision, for cells of any size that is of use.
    #[allow(clippy::cast_possible_truncation)]
    pub(super) fn new(unit: f64) -> Self {
        Self { unit: unit as f32, per_unit: (1.0 / unit) as f32 }
    }

    pub(super) fn metres(self) -> f32 {
        self.unit
    }

    pub(super) fn packed(self, place: [f32; 3]) -> Packed {
        place.map(|x| self.rounded(x))
    }

    // Into what it is dispatched to.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    pub(super) fn unpacked(self, packed: Packed) -> [f32; 3] {
        packed.map(|x| f32::from(x) * self.unit)
    }

    /// Unpacks many places, several at a time, into a list of as many.
    pub(super) fn unpack(self, packed: &[Packed], to: &mut [[f32; 3]]) {
        pulp::Arch::new().dispatch(|| {
            let all = packed.as_flattened().iter().zip(to.as_flattened_mut());
            all.for_each(|(packed, x)| *x = f32::from(*packed) * self.unit);
        });
    }

    /// A coordinate in units, the nearest of 16 bits.
    // Into what it is dispatched to.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    fn rounded(self, x: f32) -> i16 {
        // What is no number is as far as can be: `max` gives the other.
        let units = (x * self.per_unit).max(f32::from(i16::MIN)).min(f32::from(i16::MAX)) + ROUNDING;
        // The lowest bits are the integer.
        #[allow(clippy::cast_possible_truncation)]
        let packed = units.to_bits() as u16;
        packed.cast_signed()
    }

    /// [`endures`], of places that fill whole vectors: coordinate by coordinate as they lie, and together only then.
    // Into what it is dispatched to.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    fn endure_all(self, packed: &[Packed; LANES]) -> [u8; LANES] {
        let mut each = [[0; 3]; LANES];
        let places = each.as_flattened_mut().iter_mut().zip(packed.as_flattened());
        let spread = SPREAD.as_flattened().iter().zip(TURN.as_flattened());
        for ((to, packed), (spread, turn)) in places.zip(spread) {
            let product = (f32::from(*packed) * self.unit).to_bits().wrapping_mul(*spread);
            // Turned left by so many bits, none too.
            *to = product << turn | product >> 1 >> (31 - turn);
        }
        let mut halvings = [0; LANES];
        for (to, [x, y, z]) in halvings.iter_mut().zip(&each) {
            // No number has more than 32 bits.
            #[allow(clippy::cast_possible_truncation)]
            let zeros = mixed(x ^ y ^ z).leading_zeros() as u8;
            *to = zeros;
        }
        halvings
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

    /// How many halvings places [endure](endures), several at a time.
    pub(super) fn endure(self, packed: &[Packed], to: &mut [u8]) {
        pulp::Arch::new().dispatch(Endure { unit: self, packed, to });
    }
}

/// [`Unit::endure`], in whole vectors.
struct Endure<'a> {
    unit: Unit,
    packed: &'a [Packed],
    to: &'a mut [u8],
}

impl pulp::WithSimd for Endure<'_> {
    type Output = ();

    // Into what it is dispatched to.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let Self { unit, packed, to } = self;
        let (all, rest) = packed.as_chunks::<LANES>();
        let (to_all, to_rest) = to.as_chunks_mut::<LANES>();
        for (to, packed) in to_all.iter_mut().zip(all) {
            *to = unit.endure_all(packed);
        }
        for (to, packed) in to_rest.iter_mut().zip(rest) {
            *to = endures(unit.unpacked(*packed));
        }
    }
}

/// How often the threshold can be halved, from 2³² on, before the scrambled place is no longer below it.
// Into what it is dispatched to.
#[allow(clippy::inline_always)]
#[inline(always)]
pub(super) fn endures(place: [f32; 3]) -> u8 {
    // No number has more than 32 bits.
    #[allow(clippy::cast_possible_truncation)]
    let halvings = scrambled(place).leading_zeros() as u8;
    halvings
}

/// A number that looks drawn at random, and is the same for the same place.
// Into what it is dispatched to.
#[allow(clippy::inline_always)]
#[inline(always)]
pub(super) fn scrambled([x, y, z]: [f32; 3]) -> u32 {
    let ([[a, b, c], ..], [[i, j, k], ..]) = (SPREAD, TURN);
    mixed(
        x.to_bits().wrapping_mul(a).rotate_left(i)
            ^ y.to_bits().wrapping_mul(b).rotate_left(j)
            ^ z.to_bits().wrapping_mul(c).rotate_left(k),
    )
}

// Into what it is dispatched to.
#[allow(clippy::inline_always)]
#[inline(always)]
fn mixed(mix: u32) -> u32 {
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
            let (mut all, mut some) = (vec![[7; 3]], [0; 40]);
            unit.pack(&places, &mut all);
            unit.endure(&all[1..], &mut some[..places.len()]);
            for (at, place) in places.iter().enumerate() {
                let packed = unit.packed(*place);
                prop_assert_eq!(all[at + 1], packed);
                let near = unit.unpacked(packed);
                prop_assert_eq!(unit.packed(near), packed);
                prop_assert_eq!(some[at], endures(near));
                for (x, near) in place.iter().zip(near) {
                    // A unit that is no power of two is rounded itself.
                    prop_assert!((x - near).abs() <= 0.51 * unit.metres());
                }
            }
        }
    }
}
