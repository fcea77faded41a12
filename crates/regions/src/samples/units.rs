//! Places in whole units of 16 bits, where they look drawn at random, and what samples keep of them.

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

/// Bits that a sample keeps of a coordinate of 16, and the number of the others.
const KEPT: u32 = 9;
const DROPPED: u32 = 16 - KEPT;
/// Where those of each coordinate are in a [`Spot`], and by how much it is turned left until they are the highest.
const SHIFT: [u32; 3] = [2 * KEPT, KEPT, 0];
const SHIFTS: [[u32; 3]; LANES] = [SHIFT; LANES];
const LEFT: [u32; 3] = [32 - 3 * KEPT, 32 - 2 * KEPT, 32 - KEPT];
const LEFTS: [[u32; 3]; LANES] = [LEFT; LANES];
/// Where it is told how many halvings it endures.
const ENDURES: u32 = 3 * KEPT;
/// The most that is told.
pub(super) const MOST_ENDURED: u8 = 31;

/// A point as a sample keeps it: where it is, to nine bits a coordinate, and, in the highest bits, how many halvings it endures by its
/// place to 16.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub(crate) struct Spot(u32);

impl Spot {
    /// At the anchor.
    pub(super) const ZERO: Self = Self(0);

    // Into what it is dispatched to.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    pub(super) fn endures(self) -> u8 {
        (self.0 >> ENDURES) as u8
    }

    fn of(packed: Packed, endures: u8) -> Self {
        let [x, y, z] = packed.map(coarse);
        let [i, j, k] = SHIFT;
        Self(u32::from(endures.min(MOST_ENDURED)) << ENDURES | x << i | y << j | z << k)
    }
}

/// The kept bits of a coordinate, rounded to the nearest there is.
// Into what it is dispatched to.
#[allow(clippy::inline_always)]
#[inline(always)]
fn coarse(x: i16) -> u32 {
    let rounded = x.saturating_add(1 << (DROPPED - 1)) >> DROPPED;
    u32::from(rounded.cast_unsigned()) & ((1 << KEPT) - 1)
}

/// What places are whole multiples of, in metres, its inverse, and what those of samples are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Unit {
    metres: f32,
    per_metre: f32,
    coarse: f32,
}

impl Unit {
    pub(super) const ONE: Self = Self { metres: 1.0, per_metre: 1.0, coarse: (1 << DROPPED) as f32 };

    // Powers of two are the same in single precision, for cells of any size that is of use.
    #[allow(clippy::cast_possible_truncation)]
    pub(super) fn new(unit: f64) -> Self {
        let of_samples = unit * f64::from(1 << DROPPED);
        Self { metres: unit as f32, per_metre: (1.0 / unit) as f32, coarse: of_samples as f32 }
    }

    /// What the places of samples are whole multiples of, in metres.
    pub(super) fn of_samples(self) -> f32 {
        self.coarse
    }

    /// What a sample keeps of a place.
    pub(super) fn spot(self, place: [f32; 3]) -> Spot {
        let packed = self.packed(place);
        Spot::of(packed, endures(self.unpacked(packed)))
    }

    /// A point that a sample kept, from what [`place`](Self::place) and [`Spot::endures`] tell of it. Another place is rounded.
    pub(super) fn spot_again(self, place: [f32; 3], endures: u8) -> Spot {
        Spot::of(self.packed(place), endures)
    }

    /// Where a point of a sample is, in metres.
    #[inline]
    pub(super) fn place(self, Spot(bits): Spot) -> [f32; 3] {
        LEFT.map(|left| self.coarse * whole(bits << left))
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

    /// Where many points of samples are, several at a time, into a list of as many.
    pub(super) fn places(self, spots: &[Spot], to: &mut [[f32; 3]]) {
        pulp::Arch::new().dispatch(Places { unit: self, spots, to });
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

    /// [`Spot::of`], of places that fill whole vectors: coordinate by coordinate as they lie, and together only then.
    // Into what it is dispatched to.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    fn spots_of_all(self, packed: &[Packed; LANES]) -> [Spot; LANES] {
        let (mut each, mut kept) = ([[0; 3]; LANES], [[0; 3]; LANES]);
        let places = each.as_flattened_mut().iter_mut().zip(packed.as_flattened());
        let spread = SPREAD.as_flattened().iter().zip(TURN.as_flattened());
        for ((to, packed), (spread, turn)) in places.zip(spread) {
            let product = (f32::from(*packed) * self.metres).to_bits().wrapping_mul(*spread);
            // Turned left by so many bits, none too.
            *to = product << turn | product >> 1 >> (31 - turn);
        }
        let places = kept.as_flattened_mut().iter_mut().zip(packed.as_flattened());
        for ((to, packed), shift) in places.zip(SHIFTS.as_flattened()) {
            *to = coarse(*packed) << shift;
        }
        let mut spots = [Spot::ZERO; LANES];
        for ((Spot(to), [x, y, z]), [i, j, k]) in spots.iter_mut().zip(&each).zip(&kept) {
            let endures = mixed(x ^ y ^ z).leading_zeros().min(MOST_ENDURED.into());
            *to = endures << ENDURES | i | j | k;
        }
        spots
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

    /// What samples keep of places, several at a time, into a list of as many.
    pub(super) fn spots(self, packed: &[Packed], to: &mut [Spot]) {
        pulp::Arch::new().dispatch(Spots { unit: self, packed, to });
    }
}

/// [`Unit::spots`], in whole vectors.
struct Spots<'a> {
    unit: Unit,
    packed: &'a [Packed],
    to: &'a mut [Spot],
}

impl pulp::WithSimd for Spots<'_> {
    type Output = ();

    // Into what it is dispatched to.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let Self { unit, packed, to } = self;
        let (all, rest) = packed.as_chunks::<LANES>();
        let (to_all, to_rest) = to.as_chunks_mut::<LANES>();
        for (to, packed) in to_all.iter_mut().zip(all) {
            *to = unit.spots_of_all(packed);
        }
        for (to, packed) in to_rest.iter_mut().zip(rest) {
            *to = Spot::of(*packed, endures(unit.unpacked(*packed)));
        }
    }
}

/// [`Unit::places`], in whole vectors.
struct Places<'a> {
    unit: Unit,
    spots: &'a [Spot],
    to: &'a mut [[f32; 3]],
}

impl pulp::WithSimd for Places<'_> {
    type Output = ();

    // Into what it is dispatched to.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let Self { unit, spots, to } = self;
        let (all, rest) = spots.as_chunks::<LANES>();
        let (to_all, to_rest) = to.as_chunks_mut::<LANES>();
        for (to, spots) in to_all.iter_mut().zip(all) {
            let each = spots.map(|Spot(bits)| [bits; 3]);
            let coordinates = to.as_flattened_mut().iter_mut().zip(each.as_flattened());
            for ((x, bits), left) in coordinates.zip(LEFTS.as_flattened()) {
                *x = unit.coarse * whole(bits << left);
            }
        }
        for (to, spot) in to_rest.iter_mut().zip(rest) {
            *to = unit.place(*spot);
        }
    }
}

/// The integer in the highest bits.
// Into what it is dispatched to; it has nine bits.
#[allow(clippy::inline_always, clippy::cast_precision_loss)]
#[inline(always)]
fn whole(bits: u32) -> f32 {
    (bits.cast_signed() >> (32 - KEPT)) as f32
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
            let (mut all, mut some, mut rounded) = (vec![[7; 3]], [Spot::ZERO; 40], [[0.0; 3]; 40]);
            unit.pack(&places, &mut all);
            unit.spots(&all[1..], &mut some[..places.len()]);
            unit.places(&some, &mut rounded);
            for (at, place) in places.iter().enumerate() {
                let packed = unit.packed(*place);
                prop_assert_eq!(all[at + 1], packed);
                let near = unit.unpacked(packed);
                prop_assert_eq!(unit.packed(near), packed);
                let spot = unit.spot(*place);
                prop_assert_eq!((some[at], spot.endures()), (spot, endures(near).min(MOST_ENDURED)));
                prop_assert_eq!(rounded[at].map(f32::to_bits), unit.place(spot).map(f32::to_bits));
                prop_assert_eq!(unit.spot_again(rounded[at], spot.endures()), spot);
                for (x, near) in near.iter().zip(rounded[at]) {
                    // Half of what samples keep, or a whole at the end of what there is.
                    let most = if *x > 32700.0 * unit.metres { 1.01 } else { 0.51 };
                    prop_assert!((x - near).abs() <= most * unit.of_samples());
                }
                for (x, near) in place.iter().zip(near) {
                    // A unit that is no power of two is rounded itself.
                    prop_assert!((x - near).abs() <= 0.51 * unit.metres);
                }
            }
        }
    }
}
