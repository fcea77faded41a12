//! The points nearest to a few places, of many.

use rayon::prelude::*;

/// Bits that tell which voxels are near a place: many more than there are such voxels.
const MARKS: usize = 1 << 17;
/// Points whose marks are looked for at once.
const BATCH: usize = 128;
/// Points that are handed to a thread at once.
const AT_ONCE: usize = 1 << 14;

/// A squared distance, and the point.
pub(crate) type Near = (f64, [f64; 3]);

/// The points within `reach` of each place, the nearest first, at most so many.
///
/// Voxels as wide as the reach that are near a place are marked, and points in marked ones are brought together. Marks are numbers of 17
/// bits: where voxels share one, points are looked at for nothing.
pub(crate) fn nearest(points: &[[f64; 3]], places: &[[f64; 3]], reach: f64, most: usize) -> Vec<Vec<Near>> {
    let lattice = Lattice { per_reach: 1.0 / reach };
    let around: Vec<Vec<usize>> = places.iter().map(|place| lattice.around(place)).collect();
    let marks = Marks::of(around.iter().flatten());
    let buckets = Buckets::fill(&marks, points, lattice);
    let of_place = |(place, around): (&[f64; 3], &Vec<usize>)| {
        let distance = |p: &[f64; 3]| {
            let [x, y, z] = [0, 1, 2].map(|i| (p[i] - place[i]).powi(2));
            x + y + z
        };
        let mut near: Vec<Near> = around
            .iter()
            .flat_map(|mark| buckets.of(*mark))
            .map(|at| (distance(&points[*at]), points[*at]))
            .filter(|(squared, _)| *squared <= reach * reach)
            .collect();
        if near.len() > most {
            near.select_nth_unstable_by(most, |a, b| a.0.total_cmp(&b.0));
            near.truncate(most);
        }
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        near
    };
    places.par_iter().zip(&around).map(of_place).collect()
}

/// Voxels as wide as the reach.
#[derive(Clone, Copy)]
struct Lattice {
    per_reach: f64,
}

impl Lattice {
    /// The marks of the voxels around a place, each once.
    fn around(self, place: &[f64; 3]) -> Vec<usize> {
        let [x, y, z] = place.map(|x| floor(x * self.per_reach));
        let mut marks = Vec::with_capacity(27);
        for i in 0..27 {
            let key =
                [x.saturating_add(i / 9 - 1), y.saturating_add(i / 3 % 3 - 1), z.saturating_add(i % 3 - 1)];
            // Voxels that are 2³² apart share one.
            #[allow(clippy::cast_possible_truncation)]
            let mark = mark_of(mixed(key.map(|k| k.cast_unsigned() as u32)));
            if !marks.contains(&mark) {
                marks.push(mark);
            }
        }
        marks
    }
}

/// Some of the marks, and how many come before each.
struct Marks {
    words: Vec<u64>,
    before: Vec<u32>,
}

impl Marks {
    fn of<'m>(marks: impl Iterator<Item = &'m usize>) -> Self {
        let mut words = vec![0_u64; MARKS / 64];
        for mark in marks {
            words[mark / 64] |= 1 << (mark % 64);
        }
        let mut before = Vec::with_capacity(words.len() + 1);
        let mut sum = 0;
        for word in &words {
            before.push(sum);
            sum += word.count_ones();
        }
        before.push(sum);
        Self { words, before }
    }

    fn len(&self) -> usize {
        self.before.last().map_or(0, |all| *all as usize)
    }

    /// How many come before a mark, and whether it is one of these.
    // Into what it is dispatched to.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    fn look_up(&self, mark: usize) -> (usize, bool) {
        let (word, bit) = (self.words[mark / 64], 1 << (mark % 64));
        ((self.before[mark / 64] + (word & (bit - 1)).count_ones()) as usize, word & bit != 0)
    }
}

/// Points by their marks.
struct Buckets<'m> {
    marks: &'m Marks,
    /// Where those of each mark end.
    ends: Vec<usize>,
    points: Vec<usize>,
}

impl<'m> Buckets<'m> {
    fn fill(marks: &'m Marks, points: &[[f64; 3]], lattice: Lattice) -> Self {
        let parts: Vec<Vec<(usize, usize)>> = points
            .par_chunks(AT_ONCE)
            .enumerate()
            .map(|(part, points)| marked(marks, points, part * AT_ONCE, lattice))
            .collect();
        // Where those of each begin, and, when all are there, end.
        let mut ends = vec![0; marks.len()];
        for (number, _) in parts.iter().flatten() {
            ends[*number] += 1;
        }
        let mut sum = 0;
        for end in &mut ends {
            sum += std::mem::replace(end, sum);
        }
        let mut in_order = vec![0; sum];
        for (number, at) in parts.iter().flatten() {
            in_order[ends[*number]] = *at;
            ends[*number] += 1;
        }
        Self { marks, ends, points: in_order }
    }

    fn of(&self, mark: usize) -> &[usize] {
        let (number, is_one) = self.marks.look_up(mark);
        if !is_one {
            return &[];
        }
        let begin = number.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.points[begin..self.ends[number]]
    }
}

/// The number of the mark of each point that has one, and which point it is.
fn marked(marks: &Marks, points: &[[f64; 3]], first: usize, lattice: Lattice) -> Vec<(usize, usize)> {
    pulp::Arch::new().dispatch(Marked { marks, points, first, lattice })
}

/// [`marked`], with the instructions that the processor has.
struct Marked<'a> {
    marks: &'a Marks,
    points: &'a [[f64; 3]],
    first: usize,
    lattice: Lattice,
}

impl pulp::WithSimd for Marked<'_> {
    type Output = Vec<(usize, usize)>;

    // Into what it is dispatched to.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> Self::Output {
        let Self { marks, points, first, lattice } = self;
        let mut found = Vec::new();
        let (mut mixes, mut some) = ([0; BATCH], [(0, 0); BATCH]);
        for (batch, points) in points.chunks(BATCH).enumerate() {
            for (mix, point) in mixes.iter_mut().zip(points) {
                *mix = mixed(point.map(|x| lowest_bits(x * lattice.per_reach)));
            }
            // Written first, and counted if it is one: which are cannot be predicted.
            let mut count = 0;
            for (mix, at) in mixes[..points.len()].iter().zip(first + batch * BATCH..) {
                let (number, is_one) = marks.look_up(mark_of(*mix));
                some[count % BATCH] = (number, at);
                count += usize::from(is_one);
            }
            found.extend_from_slice(&some[..count]);
        }
        found
    }
}

// Into what it is dispatched to.
#[allow(clippy::inline_always)]
#[inline(always)]
fn mixed([x, y, z]: [u32; 3]) -> u32 {
    let mix = x.wrapping_mul(0x9e37_79b9) ^ y.wrapping_mul(0x85eb_ca6b) ^ z.wrapping_mul(0xc2b2_ae35);
    (mix ^ mix >> 15).wrapping_mul(0x2c1b_3c6d)
}

/// The upper bits, as many as there are marks.
#[inline]
fn mark_of(mixed: u32) -> usize {
    (mixed >> (32 - MARKS.trailing_zeros())) as usize
}

/// The lowest bits of the largest integer up to a number, for numbers up to 2⁵¹: what is further out is found by no place.
#[allow(clippy::inline_always)]
#[inline(always)]
fn lowest_bits(x: f64) -> u32 {
    /// Added to such numbers it rounds them, and leaves the integer in the lowest bits.
    const ROUNDING: f64 = 1.5 * (1_u64 << 52) as f64;
    let nearest = (x + ROUNDING) - ROUNDING;
    let floor = nearest - if nearest > x { 1.0 } else { 0.0 };
    #[allow(clippy::cast_possible_truncation)]
    let bits = (floor + ROUNDING).to_bits() as u32;
    bits
}

/// The largest integer up to a number. Saturates for far outliers, which then share a voxel at the edge of the world: harmless here.
fn floor(x: f64) -> i64 {
    #[allow(clippy::cast_possible_truncation)]
    let towards_zero = x as i64;
    towards_zero.saturating_sub(i64::from((towards_zero as f64) > x))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Squared distances, for which of two at the same distance comes first is no one's concern.
    fn distances(points: &[[f64; 3]], place: &[f64; 3], reach: f64, most: usize) -> Vec<f64> {
        let mut all: Vec<f64> = points
            .iter()
            .map(|p| (0..3).map(|i| (p[i] - place[i]).powi(2)).sum())
            .filter(|squared| *squared <= reach * reach)
            .collect();
        all.sort_by(f64::total_cmp);
        all.truncate(most);
        all
    }

    proptest! {
        #[test]
        fn they_are_those_of_a_search_through_all(
            points in prop::collection::vec(prop::array::uniform3(-2.0..2.0_f64), 1..400),
            far in prop::array::uniform3(-1e18..1e18_f64),
            reach in -6.0..3.0_f64,
            most in 1..40_usize,
        ) {
            let reach = reach.exp2();
            let places: Vec<[f64; 3]> = points.iter().copied().step_by(3).chain([far]).collect();
            let found = nearest(&points, &places, reach, most);
            prop_assert_eq!(found.len(), places.len());
            for (place, near) in places.iter().zip(&found) {
                let squared: Vec<f64> = near.iter().map(|(squared, _)| *squared).collect();
                prop_assert_eq!(squared, distances(&points, place, reach, most));
                for (squared, point) in near {
                    let off: f64 = (0..3).map(|i| (point[i] - place[i]).powi(2)).sum();
                    prop_assert_eq!(off.to_bits(), squared.to_bits());
                }
            }
        }
    }

    #[test]
    fn many_points_are_found_in_all_parts() {
        let points: Vec<[f64; 3]> =
            (0..40_000).map(|k| [f64::from(k % 200), f64::from(k / 200), 0.0]).collect();
        let found = nearest(&points, &[[100.0, 100.0, 0.0], [3.0, 199.0, 0.0], [-9.0; 3]], 2.0, 100);
        assert_eq!(found.iter().map(Vec::len).collect::<Vec<_>>(), [13, 9, 0]);
    }
}
