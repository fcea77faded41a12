//! Some points of each cell.

mod sample;
mod stripe;
mod together;
mod units;

use rayon::prelude::*;

use crate::SampleError;
use stripe::{MOST, MOST_HALVINGS, ROOM, Stripe};
use units::{Packed, Unit, endures};

pub use sample::Sample;
pub use together::{PartOf, Together};

const STRIPES: usize = 8;
/// Points whose places are scrambled at once.
const BATCH: usize = 128;

/// A sample of the points of each cell, by which points are told apart without all of them being kept.
///
/// Which points are in the sample of a cell depends on where its points are, not on their order: it is those whose scrambled places
/// are below a threshold, which is halved until no more than sixteen are left. So samples of parts of the points, cell by cell,
/// [merge](Self::merge) into that of all. Cells of up to sixteen points have all of them.
///
/// Places are kept in whole units, three times 16 bits, and cells of few points take less memory than those of many.
///
/// ```
/// use terrace_regions::Samples;
///
/// // Of points in cells with an edge of 10 cm: to a thirtieth of a millimetre, and up to a metre away.
/// let mut samples = Samples::new((-15_f64).exp2());
/// for k in 0..100 {
///     samples.push(0, [0.0005 * k as f32, 0.0, 0.0]);
/// }
/// samples.push(3, [0.03125, 0.0, -0.0625]);
/// assert!((1..=16).contains(&samples.of(0).count()));
/// assert_eq!(samples.of(1).next(), None);
/// assert_eq!(samples.of(3).collect::<Vec<_>>(), [[0.03125, 0.0, -0.0625]]);
/// ```
#[derive(Debug, Clone)]
pub struct Samples {
    /// Cell `i` is in stripe `i % STRIPES`, so that threads have cells of their own.
    stripes: [Stripe; STRIPES],
    unit: Unit,
}

impl Samples {
    /// Samples of no points. Places are kept as the nearest whole multiple of `unit`, in metres and above zero, that is no farther than
    /// 2¹⁵ of them along each axis: whole multiples stay as they are, to the bit, where the unit is a power of two.
    pub fn new(unit: f64) -> Self {
        Self { stripes: Default::default(), unit: Unit::new(unit) }
    }

    /// Adds a point of a cell by its place from the anchor of the cell's sums, in metres.
    #[inline]
    pub fn push(&mut self, cell: u32, place: [f32; 3]) {
        let packed = self.unit.packed(place);
        let (stripe, at) = home(cell);
        self.stripes[stripe].push(at, packed, endures(self.unit.unpacked(packed)), self.unit);
    }

    /// Appends places as they are kept: in whole units, each of 16 bits.
    pub fn pack(&self, places: &[[f32; 3]], to: &mut Vec<[i16; 3]>) {
        self.unit.pack(places, to);
    }

    /// Adds many points on all threads of the rayon pool; `cells` tells the cell of the point at a place of the list, if it is of one, and
    /// places are [packed](Self::pack).
    pub fn push_all(&mut self, cells: impl Fn(usize) -> Option<u32> + Sync, places: &[[i16; 3]]) {
        let share = STRIPES.div_ceil(rayon::current_num_threads().clamp(1, STRIPES));
        if share == STRIPES {
            return self.push_alone(cells, places);
        }
        let unit = self.unit;
        let shares = self.stripes.par_chunks_mut(share).enumerate();
        shares.for_each(|(number, stripes)| push(stripes, number * share, unit, &cells, places));
    }

    /// As [`push_all`](Self::push_all), on the calling thread.
    pub fn push_alone(&mut self, cells: impl Fn(usize) -> Option<u32>, places: &[[i16; 3]]) {
        push(&mut self.stripes, 0, self.unit, cells, places);
    }

    /// The sample of a cell; empty for a cell without points.
    pub fn of(&self, cell: u32) -> impl Iterator<Item = [f32; 3]> + Clone {
        self.sample(cell).places()
    }

    /// The sample of the cell of this number, as [`find`](crate::find) asks for it.
    #[inline]
    pub fn sample(&self, cell: u32) -> Sample<'_> {
        let (stripe, at) = home(cell);
        self.stripes[stripe].of(at, self.unit)
    }

    /// The samples of cells that are made of several, whose places are from one anchor. Larger cells are numbered from 0, with few left out.
    #[must_use]
    pub fn together(&self, parts: Vec<PartOf>) -> Together<'_> {
        Together::of(self, parts)
    }

    /// How often the sample of a cell was halved: it has those of its points whose scrambled places are below 2³²⁻ʰ.
    pub fn halvings(&self, cell: u32) -> u8 {
        let (stripe, at) = home(cell);
        self.stripes[stripe].halvings(at).unwrap_or(0)
    }

    /// Puts a sample that was taken elsewhere, in the same unit, in the place of that of a cell: what [`of`](Self::of) and
    /// [`halvings`](Self::halvings) told of it.
    ///
    /// # Errors
    /// [`SampleError`] when it is no sample of any points; the samples are then unchanged.
    pub fn restore(&mut self, cell: u32, places: &[[f32; 3]], halvings: u8) -> Result<(), SampleError> {
        if halvings > MOST_HALVINGS {
            return Err(SampleError::Halvings { halvings });
        }
        if places.len() > MOST {
            return Err(SampleError::TooMany { places: places.len() });
        }
        let mut all = [[0; 3]; MOST];
        for (packed, place) in all.iter_mut().zip(places) {
            let place = *place;
            *packed = self.unit.packed(place);
            let kept = self.unit.unpacked(*packed);
            // 0 with a sign is kept without.
            let same = kept.iter().zip(place).all(|(kept, given)| kept.to_bits() == (given + 0.0).to_bits());
            if place.iter().all(|x| x.is_finite()) && !same {
                return Err(SampleError::Unit { place, unit: self.unit.metres() });
            }
            if !same || endures(kept) < halvings {
                return Err(SampleError::Place { place, halvings });
            }
        }
        let (stripe, at) = home(cell);
        self.stripes[stripe].put(at, &all[..places.len()], halvings);
        Ok(())
    }

    /// Adds the sample of a cell of other points to that of a cell; places are from the same anchor, and in the same unit.
    pub fn merge(&mut self, cell: u32, other: &Self, of: u32) {
        let (stripe, at) = home(cell);
        other.merge_into(&mut self.stripes[stripe], at, of);
    }

    /// Adds the sample of a cell to another.
    fn merge_into(&self, stripe: &mut Stripe, at: usize, cell: u32) {
        let (from, there) = home(cell);
        let Some(halvings) = self.stripes[from].halvings(there) else { return };
        let (packed, count) = self.sample(cell).packed();
        let mut endure = [0; ROOM];
        self.unit.endure(&packed, &mut endure);
        for (place, endures) in packed.iter().zip(endure).take(count) {
            stripe.push(at, *place, endures, self.unit);
        }
        // What was left out of it is left out of the whole.
        stripe.halve(at, halvings, self.unit);
    }
}

/// The stripe of a cell, and its place in it.
#[inline]
fn home(cell: u32) -> (usize, usize) {
    (cell as usize % STRIPES, cell as usize / STRIPES)
}

/// Adds the points of cells in these stripes, of which the first has this number.
fn push(
    stripes: &mut [Stripe],
    first: usize,
    unit: Unit,
    cells: impl Fn(usize) -> Option<u32>,
    places: &[Packed],
) {
    let (mut endure, mut taken) = ([0; BATCH], [(0, 0); BATCH]);
    for (number, places) in places.chunks(BATCH).enumerate() {
        unit.endure(places, &mut endure[..places.len()]);
        // Whether a place stays cannot be predicted, and most cells are full: those which may are picked without a branch first, by what
        // is little and near.
        let mut count = 0;
        for (at, endures) in (0_u32..).zip(&endure[..places.len()]) {
            let Some(cell) = cells(number * BATCH + at as usize) else { continue };
            let (stripe, home) = home(cell);
            let stripe = stripe.wrapping_sub(first);
            taken[count] = (at, cell);
            count += usize::from(stripes.get(stripe).is_some_and(|stripe| stripe.takes(home, *endures)));
        }
        for (at, cell) in &taken[..count] {
            let (at, (stripe, home)) = (*at as usize, home(*cell));
            stripes[stripe - first].push(home, places[at], endure[at], unit);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::units::scrambled;
    use super::*;
    use proptest::prelude::*;

    const UNIT: f64 = 1.0 / (1 << 15) as f64;

    fn kept(samples: &Samples, cell: u32) -> Vec<[f32; 3]> {
        let kept: Vec<[f32; 3]> = samples.of(cell).collect();
        // Beside one of another unit, and one without points.
        let mut other = Samples::new(0.5);
        other.push(0, [1.5, -2.0, 0.5]);
        let all = [other.sample(0), samples.sample(cell), Sample::EMPTY];
        let (mut places, mut starts) = (vec![[9.0; 3]; 2], vec![7]);
        Sample::unpack(&all, &mut vec![[9; 3]], &mut places, &mut starts);
        let own = if kept.is_empty() { &[[0.0; 3]][..] } else { &kept };
        assert_eq!(places, [&[[1.5, -2.0, 0.5]], own, &[[0.0; 3]]].concat());
        assert_eq!(starts, [0, 1, 1 + own.len(), 2 + own.len()]);
        kept
    }

    fn sorted(samples: &Samples, cell: u32) -> Vec<[u32; 3]> {
        let mut places: Vec<[u32; 3]> = samples.of(cell).map(|p| p.map(f32::to_bits)).collect();
        places.sort_unstable();
        places
    }

    fn all(places: &[[f32; 3]]) -> Samples {
        let mut samples = Samples::new(UNIT);
        for place in places {
            samples.push(0, *place);
        }
        samples
    }

    /// The sample of a list that is kept whole, with its threshold.
    fn plain(places: &[[f32; 3]]) -> (Vec<[f32; 3]>, u8) {
        let unit = Unit::new(UNIT);
        let (mut sample, mut halvings): (Vec<[f32; 3]>, u8) = (Vec::new(), 0);
        for place in places.iter().map(|place| unit.unpacked(unit.packed(*place))) {
            sample.push(place);
            sample.retain(|place| scrambled(*place) <= u32::MAX >> halvings);
            while sample.len() > MOST && halvings < MOST_HALVINGS {
                halvings += 1;
                sample.retain(|place| scrambled(*place) <= u32::MAX >> halvings);
            }
            sample.truncate(MOST);
        }
        (sample, halvings)
    }

    /// Places of which many are the same.
    fn places(most: usize) -> impl Strategy<Value = Vec<[f32; 3]>> {
        let coordinate = prop_oneof![-1.0..1.0_f32, (-2..3_i8).prop_map(|k| 0.25 * f32::from(k))];
        prop::collection::vec(prop::array::uniform3(coordinate), 0..most)
    }

    #[test]
    fn one_place_again_and_again_is_not_kept_without_end() {
        assert!(all(&[[0.25; 3]; 1000]).of(0).count() <= MOST);
    }

    #[test]
    fn samples_are_drawn_evenly() {
        let place = |k: usize| [0.618_034, 0.754_878, 0.569_84].map(|by| (k as f32 * by).fract() - 0.5);
        let mut halves = [0; 2];
        for cell in 0..500 {
            let places: Vec<[f32; 3]> = (0..100).map(|k| place(100 * cell + k)).collect();
            let samples = all(&places);
            assert!(samples.of(0).count() <= MOST);
            halves[0] += samples.of(0).count();
            halves[1] += samples.of(0).filter(|p| p[0] < 0.0).count();
        }
        // About half the room is taken, and half of the points have a coordinate below 0.
        assert!((4500..7500).contains(&halves[0]), "{halves:?}");
        let share = halves[1] as f64 / halves[0] as f64;
        assert!((share - 0.5).abs() < 4.0 * 0.5 / (halves[0] as f64).sqrt(), "{halves:?}");
    }

    #[test]
    fn what_is_no_sample_is_refused() {
        let mut samples = all(&[[0.25, 0.5, 0.125]; 3]);
        let before = sorted(&samples, 0);
        assert_eq!(samples.restore(0, &[], 32), Err(SampleError::Halvings { halvings: 32 }));
        assert_eq!(samples.restore(0, &[[0.0; 3]; 17], 0), Err(SampleError::TooMany { places: 17 }));
        assert!(matches!(samples.restore(0, &[[f32::NAN; 3]], 0), Err(SampleError::Place { .. })));
        assert!(matches!(samples.restore(0, &[[f32::INFINITY; 3]], 0), Err(SampleError::Place { .. })));
        for place in [[0.3, 0.0, 0.0], [0.0, 0.0, 1.0]] {
            let error = SampleError::Unit { place, unit: samples.unit.metres() };
            assert_eq!(samples.restore(0, &[[0.0; 3], place], 0), Err(error));
        }
        // Of one in two thousand million, hardly any place is one.
        let place = [0.3125, 0.125, 0.25];
        assert_eq!(samples.restore(0, &[place], 31), Err(SampleError::Place { place, halvings: 31 }));
        assert_eq!(sorted(&samples, 0), before);
        assert_eq!(samples.restore(5, &[], 31), Ok(()));
        assert_eq!((samples.of(5).count(), samples.halvings(5), samples.halvings(9)), (0, 31, 0));
    }

    proptest! {
        #[test]
        fn samples_are_those_of_lists(places in places(200), again in places(20)) {
            let mut samples = Samples::new(UNIT);
            // Of a cell on the next page of the same stripe, of its neighbour, and of one with other points.
            let cells = [7, 8, 7 + 64 * 8];
            for place in &places {
                for cell in cells {
                    samples.push(cell, *place);
                }
            }
            for place in &again {
                samples.push(7, *place);
            }
            let longer = [&places[..], &again[..]].concat();
            for (cell, places) in cells.iter().zip([&longer, &places, &places]) {
                prop_assert_eq!((kept(&samples, *cell), samples.halvings(*cell)), plain(places));
            }
        }

        #[test]
        fn a_sample_that_is_restored_goes_on_as_it_was(places in places(100), before in places(100), more in places(100)) {
            let mut first = all(&places);
            let mut again = all(&before);
            prop_assert_eq!(again.restore(0, &kept(&first, 0), first.halvings(0)), Ok(()));
            for place in more {
                first.push(0, place);
                again.push(0, place);
                prop_assert_eq!(kept(&first, 0), kept(&again, 0));
            }
            prop_assert_eq!(first.halvings(0), again.halvings(0));
        }

        #[test]
        fn neither_order_nor_parts_matter(
            places in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f32), 0..200),
            cut in 0..200_usize,
        ) {
            let whole = all(&places);
            if places.len() <= MOST {
                prop_assert_eq!(whole.of(0).count(), places.len());
            }
            let backwards: Vec<[f32; 3]> = places.iter().rev().copied().collect();
            prop_assert_eq!(sorted(&all(&backwards), 0), sorted(&whole, 0));
            let (one, other) = places.split_at(cut.min(places.len()));
            let mut merged = all(one);
            merged.merge(0, &all(other), 0);
            prop_assert_eq!(sorted(&merged, 0), sorted(&whole, 0));
            prop_assert_eq!(merged.halvings(0), whole.halvings(0));
            for threads in 1..4 {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let mut together = Samples::new(UNIT);
                let cell = |at: usize| u32::try_from(at % 11).ok();
                let mut packed = Vec::new();
                together.pack(&places, &mut packed);
                pool.install(|| together.push_all(cell, &packed));
                let mut alone = Samples::new(UNIT);
                alone.push_alone(cell, &packed);
                let mut single = Samples::new(UNIT);
                places.iter().zip(0..).for_each(|(place, k)| single.push(k % 11, *place));
                for cell in 0..11 {
                    prop_assert_eq!(kept(&together, cell), kept(&single, cell));
                    prop_assert_eq!(kept(&alone, cell), kept(&single, cell));
                }
            }
        }
    }
}
