//! Places in whole units of 16 bits, and where they look drawn at random.

/// Added to a number of up to 22 bits it rounds it to an integer, which is in the lowest bits then.
const ROUNDING: f32 = 1.5 * (1_u32 << 23) as f32;

/// A place in whole units.
pub(crate) type Packed = [i16; 3];

/// What places are whole multiples of, in metres, and its inverse.
#[derive(Debug, Clone, Copy)]
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
        place.map(|x| self.rounded(x).0)
    }

    // Into what it is dispatched to.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    pub(super) fn unpacked(self, packed: Packed) -> [f32; 3] {
        packed.map(|x| f32::from(x) * self.unit)
    }

    /// A coordinate in units, the nearest of 16 bits, and in metres again.
    // Into what it is dispatched to.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    fn rounded(self, x: f32) -> (i16, f32) {
        // What is no number is as far as can be: `max` gives the other.
        let units = (x * self.per_unit).max(f32::from(i16::MIN)).min(f32::from(i16::MAX)) + ROUNDING;
        // The lowest bits are the integer.
        #[allow(clippy::cast_possible_truncation)]
        let packed = (units.to_bits() as u16).cast_signed();
        (packed, (units - ROUNDING) * self.unit)
    }

    /// Packs places and scrambles them, several at a time.
    pub(super) fn pack<const N: usize>(self, places: &[[f32; 3]], to: &mut Batch<N>) {
        pulp::Arch::new().dispatch(|| {
            let all = to.packed.as_flattened_mut().iter_mut().zip(to.places.as_flattened_mut());
            for (x, (packed, rounded)) in places.as_flattened().iter().zip(all) {
                (*packed, *rounded) = self.rounded(*x);
            }
            to.scrambled.iter_mut().zip(&to.places).for_each(|(to, place)| *to = scrambled(*place));
        });
    }

    /// Scrambles places, several at a time.
    pub(super) fn scramble<const N: usize>(self, packed: &[Packed; N]) -> [u32; N] {
        pulp::Arch::new().dispatch(|| packed.map(|packed| scrambled(self.unpacked(packed))))
    }
}

/// Places on their way into the samples.
pub(super) struct Batch<const N: usize> {
    pub(super) packed: [Packed; N],
    places: [[f32; 3]; N],
    pub(super) scrambled: [u32; N],
}

impl<const N: usize> Batch<N> {
    pub(super) const EMPTY: Self = Self { packed: [[0; 3]; N], places: [[0.0; 3]; N], scrambled: [0; N] };
}

/// A number that looks drawn at random, and is the same for the same place.
// Into what it is dispatched to.
#[allow(clippy::inline_always)]
#[inline(always)]
pub(super) fn scrambled([x, y, z]: [f32; 3]) -> u32 {
    let mix = x.to_bits().wrapping_mul(0x9e37_79b9)
        ^ y.to_bits().wrapping_mul(0x85eb_ca6b).rotate_left(11)
        ^ z.to_bits().wrapping_mul(0xc2b2_ae35).rotate_left(22);
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
            let mut batch = Batch::<40>::EMPTY;
            unit.pack(&places, &mut batch);
            let again = unit.scramble(&batch.packed);
            for (at, place) in places.iter().enumerate() {
                let packed = unit.packed(*place);
                prop_assert_eq!(batch.packed[at], packed);
                let near = unit.unpacked(packed);
                prop_assert_eq!(unit.packed(near), packed);
                prop_assert_eq!(batch.scrambled[at], scrambled(near));
                prop_assert_eq!(again[at], scrambled(near));
                for (x, near) in place.iter().zip(near) {
                    prop_assert!((x - near).abs() <= 0.5001 * unit.metres());
                }
            }
        }
    }
}
