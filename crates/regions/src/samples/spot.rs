//! What samples keep of points.

use super::units::{LANES, Packed, Unit, endured, endures};

/// Bits that are kept of a coordinate of 16, and the number of the others.
const KEPT: u32 = 9;
const DROPPED: u32 = 16 - KEPT;
/// Where those of each coordinate are, and by how much a spot is turned left until they are the highest.
const SHIFT: [[u32; 3]; LANES] = [[2 * KEPT, KEPT, 0]; LANES];
const LEFT: [[u32; 3]; LANES] = [[32 - 3 * KEPT, 32 - 2 * KEPT, 32 - KEPT]; LANES];
/// Where it is told how many halvings are endured, and the most that is told.
const ENDURES: u32 = 3 * KEPT;
const MOST_ENDURED: u32 = 31;

/// A point as a sample keeps it: where it is, to nine bits a coordinate, and, in the highest bits, how many halvings it endures by its
/// place to 16.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Spot(u32);

impl Spot {
    /// At the anchor.
    pub(super) const ZERO: Self = Self(0);

    // For each point of a scan.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    pub(super) fn endures(self) -> u8 {
        (self.0 >> ENDURES) as u8
    }

    // Into what it is dispatched to.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    fn of(packed: Packed, endures: u32) -> Self {
        let ([x, y, z], [[i, j, k], ..]) = (packed.map(kept), SHIFT);
        Self(endures.min(MOST_ENDURED) << ENDURES | x << i | y << j | z << k)
    }
}

/// The kept bits of a coordinate, rounded to the nearest there is.
// Into what it is dispatched to.
#[allow(clippy::inline_always)]
#[inline(always)]
fn kept(x: i16) -> u32 {
    let rounded = x.saturating_add(1 << (DROPPED - 1)) >> DROPPED;
    u32::from(rounded.cast_unsigned()) & ((1 << KEPT) - 1)
}

/// The integer in the highest bits.
// Into what it is dispatched to; it has nine bits.
#[allow(clippy::inline_always, clippy::cast_precision_loss)]
#[inline(always)]
fn whole(bits: u32) -> f32 {
    (bits.cast_signed() >> (32 - KEPT)) as f32
}

impl Unit {
    /// What the places of samples are whole multiples of, in metres.
    // Into what it is dispatched to.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    pub(super) fn of_samples(self) -> f32 {
        (1 << DROPPED) as f32 * self.metres()
    }

    /// What a sample keeps of a place.
    pub(super) fn spot(self, place: [f32; 3]) -> Spot {
        let packed = self.packed(place);
        Spot::of(packed, endures(self.unpacked(packed)))
    }

    /// A point that a sample kept, from what [`place`](Self::place) and [`Spot::endures`] tell of it. Another place is rounded.
    pub(super) fn spot_again(self, place: [f32; 3], endures: u8) -> Spot {
        Spot::of(self.packed(place), endures.into())
    }

    /// Where a point of a sample is, in metres.
    #[inline]
    pub(super) fn place(self, Spot(bits): Spot) -> [f32; 3] {
        LEFT[0].map(|left| self.of_samples() * whole(bits << left))
    }

    /// What samples keep of places, several at a time, into a list of as many.
    pub(super) fn spots(self, packed: &[Packed], to: &mut [Spot]) {
        pulp::Arch::new().dispatch(Spots { unit: self, packed, to });
    }

    /// Where many points of samples are, several at a time, into a list of as many.
    pub(super) fn places(self, spots: &[Spot], to: &mut [[f32; 3]]) {
        pulp::Arch::new().dispatch(Places { unit: self, spots, to });
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
            let (spread, mut places) = (unit.spread(packed), [[0; 3]; LANES]);
            let each = places.as_flattened_mut().iter_mut().zip(packed.as_flattened());
            for ((place, packed), shift) in each.zip(SHIFT.as_flattened()) {
                *place = kept(*packed) << shift;
            }
            for ((Spot(to), spread), [x, y, z]) in to.iter_mut().zip(&spread).zip(&places) {
                *to = endured(*spread).min(MOST_ENDURED) << ENDURES | x | y | z;
            }
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
            for ((x, bits), left) in coordinates.zip(LEFT.as_flattened()) {
                *x = unit.of_samples() * whole(bits << left);
            }
        }
        for (to, spot) in to_rest.iter_mut().zip(rest) {
            *to = unit.place(*spot);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_spot_at_the_end_stays_there() {
        let unit = Unit::new(0.5);
        let place = |x: f32| unit.place(unit.spot([x, 0.0, -x]));
        // 255 and −256 times 2⁷ units.
        assert_eq!(place(1e30).map(f32::to_bits), [16320.0, 0.0, -16384.0_f32].map(f32::to_bits));
        assert_eq!(unit.spot([f32::NAN; 3]), unit.spot([-1e30; 3]));
        assert_eq!(Spot::of([0; 3], 32), Spot::of([0; 3], 31));
        assert_eq!((Spot::of([-1; 3], 32).endures(), Spot::ZERO.endures()), (31, 0));
    }

    proptest! {
        #[test]
        fn many_are_kept_as_one_is_and_rounded_to_the_nearest(
            places in prop::collection::vec(prop::array::uniform3(-3.0..3.0_f32), 0..=40),
            unit in (-13.0..0.0_f64).prop_map(f64::exp2),
        ) {
            let unit = Unit::new(unit);
            let (mut packed, mut spots, mut rounded) = (Vec::new(), [Spot::ZERO; 40], [[0.0; 3]; 40]);
            unit.pack(&places, &mut packed);
            unit.spots(&packed, &mut spots[..places.len()]);
            unit.places(&spots, &mut rounded);
            for (at, place) in places.iter().enumerate() {
                let (near, spot) = (unit.unpacked(packed[at]), unit.spot(*place));
                prop_assert_eq!((spots[at], u32::from(spot.endures())), (spot, endures(near).min(MOST_ENDURED)));
                prop_assert_eq!(rounded[at].map(f32::to_bits), unit.place(spot).map(f32::to_bits));
                prop_assert_eq!(unit.spot_again(rounded[at], spot.endures()), spot);
                for (x, near) in near.iter().zip(rounded[at]) {
                    // Half of what is kept, or a whole at the end of what there is.
                    let most = if *x > 32700.0 * unit.metres() { 1.01 } else { 0.51 };
                    prop_assert!((x - near).abs() <= most * unit.of_samples());
                }
            }
        }
    }
}
