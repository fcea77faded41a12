//! Some points of each cell.

mod sample;
mod spot;
mod stripe;
mod together;
mod units;

use rayon::prelude::*;

use crate::SampleError;
use stripe::{MOST, MOST_HALVINGS, Stripe};
use units::{Packed, Unit};

pub use sample::{Sample, SampledPoint};
pub(crate) use spot::Spot;
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
/// Scrambled is the place in whole units, three times 16 bits. Kept are the first nine of each, which is enough to tell shares of points and
/// where surfaces end, so that a point of a sample takes four bytes; and cells of few points take less memory than those of many.
///
/// ```
/// use terrace_regions::Samples;
///
/// // Of points in cells with an edge of 1 m: to 2 mm from the nearest that is kept, and up to a metre away.
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
    /// Samples of no points. Places are told apart by the nearest whole multiple of `unit`, in metres and above zero, that is no farther than
    /// 2¹⁵ of them along each axis, and kept as that of 2⁷ units, no farther than 2⁸ of those.
    pub fn new(unit: f64) -> Self {
        Self { stripes: Default::default(), unit: Unit::new(unit) }
    }

    /// Adds a point of a cell by its place from the anchor of the cell's sums, in metres.
    #[inline]
    pub fn push(&mut self, cell: u32, place: [f32; 3]) {
        let (stripe, at) = home(cell);
        self.stripes[stripe].push(at, self.unit.spot(place));
    }

    /// Appends places as they are told apart: in whole units, each of 16 bits.
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

    /// Puts a sample that was taken elsewhere, in the same unit, in the place of that of a cell: what [`Sample::points`] and
    /// [`halvings`](Self::halvings) told of it.
    ///
    /// # Errors
    /// [`SampleError`] when it is no sample of any points; the samples are then unchanged.
    pub fn restore(&mut self, cell: u32, points: &[SampledPoint], halvings: u8) -> Result<(), SampleError> {
        if halvings > MOST_HALVINGS {
            return Err(SampleError::Halvings { halvings });
        }
        if points.len() > MOST {
            return Err(SampleError::TooMany { places: points.len() });
        }
        let mut all = [Spot::ZERO; MOST];
        for (spot, SampledPoint { place, endures }) in all.iter_mut().zip(points) {
            let (place, endures) = (*place, *endures);
            *spot = self.unit.spot_again(place, endures);
            // 0 with a sign is kept without.
            let same = |(kept, given): (f32, f32)| kept.to_bits() == (given + 0.0).to_bits();
            let kept = self.unit.place(*spot);
            if place.iter().all(|x| x.is_finite()) && !kept.into_iter().zip(place).all(same) {
                return Err(SampleError::Unit { place, unit: self.unit.of_samples() });
            }
            if !place.iter().all(|x| x.is_finite()) || spot.endures() != endures || endures < halvings {
                return Err(SampleError::Place { place, endures, halvings });
            }
        }
        let (stripe, at) = home(cell);
        self.stripes[stripe].put(at, &all[..points.len()], halvings);
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
        let (spots, count) = self.sample(cell).spots();
        spots.iter().take(count).for_each(|spot| stripe.push(at, *spot));
        // What was left out of it is left out of the whole.
        stripe.halve(at, halvings);
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
    let (mut spots, mut taken) = ([Spot::ZERO; BATCH], [(Spot::ZERO, 0); BATCH]);
    for (number, places) in places.chunks(BATCH).enumerate() {
        let spots = &mut spots[..places.len()];
        unit.spots(places, spots);
        // Whether a point stays cannot be predicted, and most cells are full: those which may are picked without a branch first, by what
        // is little and near.
        let mut count = 0;
        for (at, spot) in (number * BATCH..).zip(&*spots) {
            let Some(cell) = cells(at) else { continue };
            let (stripe, home) = home(cell);
            taken[count] = (*spot, cell);
            let stripe = stripes.get(stripe.wrapping_sub(first));
            count += usize::from(stripe.is_some_and(|stripe| stripe.takes(home, *spot)));
        }
        for (spot, cell) in &taken[..count] {
            let (stripe, home) = home(*cell);
            stripes[stripe - first].push(home, *spot);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::units::endures;
    use super::*;
    use proptest::prelude::*;

    const UNIT: f64 = 1.0 / (1 << 15) as f64;

    fn kept(samples: &Samples, cell: u32) -> Vec<[f32; 3]> {
        let kept: Vec<[f32; 3]> = samples.of(cell).collect();
        // Beside one of another unit, and one without points.
        let mut other = Samples::new(0.5 / 128.0);
        other.push(0, [1.5, -2.0, 0.5]);
        let all = [other.sample(0), samples.sample(cell), Sample::EMPTY];
        let (mut places, mut starts) = (vec![[9.0; 3]; 2], vec![7]);
        Sample::unpack(&all, &mut vec![Spot::ZERO], &mut places, &mut starts);
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

    /// The place that a sample keeps of one: the nearest of those there are.
    fn rounded(place: [f32; 3]) -> [f32; 3] {
        let coarse = 128.0 * UNIT;
        #[allow(clippy::cast_possible_truncation, reason = "whole multiples of a power of two")]
        place.map(|x| (((f64::from(x) / coarse + 0.5).floor()).min(255.0) * coarse) as f32)
    }

    /// The sample of a list that is kept whole, with its threshold.
    fn plain(places: &[[f32; 3]]) -> (Vec<[f32; 3]>, u8) {
        let unit = Unit::new(UNIT);
        let (mut sample, mut halvings): (Vec<[f32; 3]>, u8) = (Vec::new(), 0);
        for place in places.iter().map(|place| unit.unpacked(unit.packed(*place))) {
            sample.push(place);
            sample.retain(|place| endures(*place) >= u32::from(halvings));
            while sample.len() > MOST && halvings < MOST_HALVINGS {
                halvings += 1;
                sample.retain(|place| endures(*place) >= u32::from(halvings));
            }
            sample.truncate(MOST);
        }
        (sample.into_iter().map(rounded).collect(), halvings)
    }

    fn points(samples: &Samples, cell: u32) -> Vec<SampledPoint> {
        samples.sample(cell).points().collect()
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
        let at = |place: [f32; 3], endures: u8| SampledPoint { place, endures };
        assert_eq!(samples.restore(0, &[], 32), Err(SampleError::Halvings { halvings: 32 }));
        assert_eq!(samples.restore(0, &[at([0.0; 3], 0); 17], 0), Err(SampleError::TooMany { places: 17 }));
        for strange in [f32::NAN, f32::INFINITY] {
            let refused = samples.restore(0, &[at([strange; 3], 0)], 0);
            assert!(matches!(refused, Err(SampleError::Place { endures: 0, halvings: 0, .. })));
        }
        for place in [[0.3, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 64.0 / 32768.0, 0.0]] {
            let error = SampleError::Unit { place, unit: 1.0 / 256.0 };
            assert_eq!(samples.restore(0, &[at([0.0; 3], 0), at(place, 0)], 0), Err(error));
        }
        // Left out by the halvings, and more than there are.
        let place = [0.3125, 0.125, 0.25];
        for (endures, halvings) in [(30, 31), (32, 0), (255, 31)] {
            let error = SampleError::Place { place, endures, halvings };
            assert_eq!(samples.restore(0, &[at(place, endures)], halvings), Err(error));
        }
        assert_eq!(sorted(&samples, 0), before);
        assert_eq!(samples.restore(0, &[at(place, 31)], 31), Ok(()));
        assert_eq!(points(&samples, 0), [at(place, 31)]);
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
            prop_assert_eq!(again.restore(0, &points(&first, 0), first.halvings(0)), Ok(()));
            for place in more {
                first.push(0, place);
                again.push(0, place);
                prop_assert_eq!(points(&first, 0), points(&again, 0));
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
