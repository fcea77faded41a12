//! Some points of each cell.

use rayon::prelude::*;

use crate::SampleError;

/// So many points of a cell are kept at most.
const MOST: usize = 16;
/// After so many halvings the threshold is at its least.
const MOST_HALVINGS: u8 = 31;
const STRIPES: usize = 8;
/// Cells of a stripe that are in a row.
const PAGE: usize = 64;
/// Points whose places are scrambled at once.
const BATCH: usize = 128;

/// A sample of the points of each cell, by which points are told apart without all of them being kept.
///
/// Which points are in the sample of a cell depends on where its points are, not on their order: it is those whose scrambled places
/// are below a threshold, which is halved until no more than sixteen are left. So samples of parts of the points, cell by cell,
/// [merge](Self::merge) into that of all. Cells of up to sixteen points have all of them.
///
/// ```
/// use terrace_regions::Samples;
///
/// let mut samples = Samples::default();
/// for k in 0..100 {
///     samples.push(0, [0.01 * k as f32, 0.0, 0.0]);
/// }
/// samples.push(3, [0.5; 3]);
/// assert!((1..=16).contains(&samples.of(0).len()));
/// assert_eq!(samples.of(1), [[0.0_f32; 3]; 0]);
/// assert_eq!(samples.of(3), [[0.5; 3]]);
/// ```
#[derive(Debug, Clone, Default)]
pub struct Samples {
    /// Cell `i` is in stripe `i % STRIPES`, so that threads have cells of their own.
    stripes: [Stripe; STRIPES],
}

/// Page by page, so that none is moved when more cells come.
#[derive(Debug, Clone, Default)]
struct Stripe(Vec<Box<[Kept; PAGE]>>);

/// The sample of a cell. What is looked at for each point comes first, beside the first places.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
struct Kept {
    /// Scrambled places up to here are in the sample.
    threshold: u32,
    count: u8,
    /// Halvings of the threshold.
    halvings: u8,
    /// One more than are kept: a place is written first, and counted when it stays.
    places: [[f32; 3]; MOST + 1],
}

impl Samples {
    /// Adds a point of a cell by its place from the anchor of the cell's sums, in metres.
    #[inline]
    pub fn push(&mut self, cell: u32, place: [f32; 3]) {
        let (stripe, at) = home(cell);
        self.stripes[stripe].push(at, place, scrambled(place));
    }

    /// Adds many points on all threads of the rayon pool; `cells` tells the cell of the point at a place of the list, if it is of one.
    pub fn push_all(&mut self, cells: impl Fn(usize) -> Option<u32> + Sync, places: &[[f32; 3]]) {
        let share = STRIPES.div_ceil(rayon::current_num_threads().clamp(1, STRIPES));
        if share == STRIPES {
            return self.push_alone(cells, places);
        }
        let push = |(number, stripes): (usize, &mut [Stripe])| {
            for_each(&cells, places, |cell, place, scrambled| {
                let (stripe, at) = home(cell);
                if let Some(stripe) = stripes.get_mut(stripe.wrapping_sub(number * share)) {
                    stripe.push(at, place, scrambled);
                }
            });
        };
        self.stripes.par_chunks_mut(share).enumerate().for_each(push);
    }

    /// As [`push_all`](Self::push_all), on the calling thread.
    pub fn push_alone(&mut self, cells: impl Fn(usize) -> Option<u32>, places: &[[f32; 3]]) {
        for_each(cells, places, |cell, place, scrambled| {
            let (stripe, at) = home(cell);
            self.stripes[stripe].push(at, place, scrambled);
        });
    }

    /// The sample of a cell; empty for a cell without points.
    pub fn of(&self, cell: u32) -> &[[f32; 3]] {
        let (stripe, at) = home(cell);
        self.stripes[stripe].of(at)
    }

    /// The sample of the points of several cells together, whose places are from one anchor.
    pub fn of_several(&self, cells: &[u32]) -> Vec<[f32; 3]> {
        let mut together = Kept::NONE;
        for cell in cells {
            let (stripe, at) = home(*cell);
            let Some(own) = self.stripes[stripe].get(at) else { continue };
            together.merge(self.of(*cell), own.halvings);
        }
        together.places.get(..usize::from(together.count)).unwrap_or(&[]).to_vec()
    }

    /// How often the sample of a cell was halved: it has those of its points whose scrambled places are below 2³²⁻ʰ.
    pub fn halvings(&self, cell: u32) -> u8 {
        let (stripe, at) = home(cell);
        self.stripes[stripe].get(at).map_or(0, |kept| kept.halvings)
    }

    /// Puts a sample that was taken elsewhere in the place of that of a cell: what [`of`](Self::of) and
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
        let threshold = u32::MAX >> halvings;
        let sampled =
            |place: &[f32; 3]| place.iter().all(|x| x.is_finite()) && scrambled(*place) <= threshold;
        if let Some(place) = places.iter().find(|place| !sampled(place)) {
            return Err(SampleError::Place { place: *place, halvings });
        }
        let (stripe, at) = home(cell);
        let kept = self.stripes[stripe].get_or_new(at);
        // At most sixteen.
        #[allow(clippy::cast_possible_truncation)]
        let count = places.len() as u8;
        *kept = Kept { threshold, count, halvings, ..Kept::NONE };
        kept.places[..places.len()].copy_from_slice(places);
        Ok(())
    }

    /// Adds the sample of a cell of other points to that of a cell; places are from the same anchor.
    pub fn merge(&mut self, cell: u32, other: &Self, of: u32) {
        let (from, there) = home(of);
        let Some(theirs) = other.stripes[from].get(there) else { return };
        let (stripe, at) = home(cell);
        self.stripes[stripe].get_or_new(at).merge(other.of(of), theirs.halvings);
    }
}

/// The stripe of a cell, and its place in it.
#[inline]
fn home(cell: u32) -> (usize, usize) {
    (cell as usize % STRIPES, cell as usize / STRIPES)
}

/// Hands out the cell, the place and the scrambled place of each point that is of a cell.
#[inline]
fn for_each(
    cells: impl Fn(usize) -> Option<u32>,
    places: &[[f32; 3]],
    mut take: impl FnMut(u32, [f32; 3], u32),
) {
    let mut all = [0; BATCH];
    for (batch, places) in places.chunks(BATCH).enumerate() {
        scramble(places, &mut all);
        for (at, (place, scrambled)) in (batch * BATCH..).zip(places.iter().zip(&all)) {
            if let Some(cell) = cells(at) {
                take(cell, *place, *scrambled);
            }
        }
    }
}

impl Stripe {
    #[inline]
    fn get(&self, at: usize) -> Option<&Kept> {
        self.0.get(at / PAGE).map(|page| &page[at % PAGE])
    }

    #[inline]
    fn get_or_new(&mut self, at: usize) -> &mut Kept {
        if at / PAGE >= self.0.len() {
            self.reach(at / PAGE);
        }
        &mut self.0[at / PAGE][at % PAGE]
    }

    #[cold]
    fn reach(&mut self, page: usize) {
        self.0.resize_with(page + 1, || Box::new([Kept::NONE; PAGE]));
    }

    #[inline]
    fn push(&mut self, at: usize, place: [f32; 3], scrambled: u32) {
        if let Some(page) = self.0.get_mut(at / PAGE) {
            page[at % PAGE].push(place, scrambled);
        } else {
            let [x, y, z] = place;
            self.push_beyond(at, x, y, z, scrambled);
        }
    }

    /// Apart, and coordinates in registers, so that nothing is written for it where pages are there.
    #[cold]
    #[inline(never)]
    fn push_beyond(&mut self, at: usize, x: f32, y: f32, z: f32, scrambled: u32) {
        self.get_or_new(at).push([x, y, z], scrambled);
    }

    fn of(&self, at: usize) -> &[[f32; 3]] {
        self.get(at).and_then(|kept| kept.places.get(..usize::from(kept.count))).unwrap_or(&[])
    }
}

impl Kept {
    const NONE: Self = Self { threshold: u32::MAX, count: 0, halvings: 0, places: [[0.0; 3]; MOST + 1] };

    #[inline]
    fn push(&mut self, place: [f32; 3], scrambled: u32) {
        // Whether a place stays cannot be predicted while a cell fills: there is no branch.
        let count = self.count;
        if let Some(free) = self.places.get_mut(usize::from(count)) {
            *free = place;
        }
        self.count = count + u8::from(scrambled <= self.threshold);
        if usize::from(self.count) > MOST {
            self.make_room();
        }
    }

    /// Adds a sample of other points that was halved so often.
    fn merge(&mut self, places: &[[f32; 3]], halvings: u8) {
        for place in places {
            self.push(*place, scrambled(*place));
        }
        // What the others left out is left out of the whole.
        while self.halvings < halvings {
            self.halve();
        }
    }

    /// Halves the threshold until there is room for what was just counted; one place again and again is not kept without end.
    #[inline(never)]
    fn make_room(&mut self) {
        while usize::from(self.count) > MOST && self.halvings < MOST_HALVINGS {
            self.halve();
        }
        if usize::from(self.count) > MOST {
            self.count -= 1;
        }
    }

    fn halve(&mut self) {
        self.halvings += 1;
        self.threshold = u32::MAX >> self.halvings;
        let mut all = [0; MOST + 1];
        scramble(&self.places, &mut all);
        let mut count = 0;
        for (at, scrambled) in all.into_iter().enumerate().take(self.count.into()) {
            self.places[usize::from(count)] = self.places[at];
            count += u8::from(scrambled <= self.threshold);
        }
        self.count = count;
    }
}

/// The scrambled places of a batch, several at a time.
fn scramble(places: &[[f32; 3]], to: &mut [u32]) {
    pulp::Arch::new().dispatch(|| to.iter_mut().zip(places).for_each(|(to, place)| *to = scrambled(*place)));
}

/// A number that looks drawn at random, and is the same for the same place.
// Into what it is dispatched to.
#[allow(clippy::inline_always)]
#[inline(always)]
fn scrambled([x, y, z]: [f32; 3]) -> u32 {
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

    fn sorted(samples: &Samples, cell: u32) -> Vec<[u32; 3]> {
        let mut places: Vec<[u32; 3]> = samples.of(cell).iter().map(|p| p.map(f32::to_bits)).collect();
        places.sort_unstable();
        places
    }

    fn all(places: &[[f32; 3]]) -> Samples {
        let mut samples = Samples::default();
        for place in places {
            samples.push(0, *place);
        }
        samples
    }

    #[test]
    fn one_place_again_and_again_is_not_kept_without_end() {
        assert!(all(&[[0.25; 3]; 1000]).of(0).len() <= MOST);
    }

    #[test]
    fn samples_are_drawn_evenly() {
        let place = |k: usize| [0.618_034, 0.754_878, 0.569_84].map(|by| (k as f32 * by).fract() - 0.5);
        let mut halves = [0; 2];
        for cell in 0..500 {
            let places: Vec<[f32; 3]> = (0..100).map(|k| place(100 * cell + k)).collect();
            let samples = all(&places);
            assert!(samples.of(0).len() <= MOST);
            halves[0] += samples.of(0).len();
            halves[1] += samples.of(0).iter().filter(|p| p[0] < 0.0).count();
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
        // Of one in two thousand million, hardly any place is one.
        let place = [0.3, 0.1, 0.2];
        assert_eq!(samples.restore(0, &[place], 31), Err(SampleError::Place { place, halvings: 31 }));
        assert_eq!(sorted(&samples, 0), before);
        assert_eq!(samples.restore(5, &[], 31), Ok(()));
        assert_eq!((samples.of(5).len(), samples.halvings(5), samples.halvings(9)), (0, 31, 0));
    }

    proptest! {
        #[test]
        fn a_sample_that_is_restored_goes_on_as_it_was(
            places in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f32), 0..100),
            more in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f32), 0..100),
        ) {
            let mut first = all(&places);
            let mut again = Samples::default();
            prop_assert_eq!(again.restore(0, first.of(0), first.halvings(0)), Ok(()));
            for place in more {
                first.push(0, place);
                again.push(0, place);
                prop_assert_eq!(first.of(0), again.of(0));
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
                prop_assert_eq!(whole.of(0).len(), places.len());
            }
            let backwards: Vec<[f32; 3]> = places.iter().rev().copied().collect();
            prop_assert_eq!(sorted(&all(&backwards), 0), sorted(&whole, 0));
            let (one, other) = places.split_at(cut.min(places.len()));
            let mut merged = all(one);
            merged.merge(0, &all(other), 0);
            prop_assert_eq!(sorted(&merged, 0), sorted(&whole, 0));
            let mut apart = Samples::default();
            places.iter().enumerate().for_each(|(at, place)| apart.push(if at < cut { 3 } else { 8 }, *place));
            let mut several: Vec<[u32; 3]> = apart.of_several(&[8, 5, 3]).iter().map(|p| p.map(f32::to_bits)).collect();
            several.sort_unstable();
            prop_assert_eq!(several, sorted(&whole, 0));
            for threads in 1..4 {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let mut together = Samples::default();
                let cell = |at: usize| u32::try_from(at % 11).ok();
                pool.install(|| together.push_all(cell, &places));
                let mut alone = Samples::default();
                alone.push_alone(cell, &places);
                let mut single = Samples::default();
                places.iter().zip(0..).for_each(|(place, k)| single.push(k % 11, *place));
                for cell in 0..11 {
                    prop_assert_eq!(together.of(cell), single.of(cell));
                    prop_assert_eq!(alone.of(cell), single.of(cell));
                }
            }
        }
    }
}
