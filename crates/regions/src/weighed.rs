//! Samples of cells with several regions near them, weighed against these.

use crate::near::Several;
use crate::of_cells::{Part, Parts};

/// Shares below this are none.
const LEAST_SHARE: f64 = 1e-3;

/// What the samples of cells tell of the regions near them, but for the shares of these: it stays as long as the regions do.
#[derive(Debug, Clone, Default)]
pub(crate) struct Weighed {
    /// Cell after cell: the number of its places; for each region near it how many are within the reach of that alone; then for each place
    /// that is within the reach of several the score of each region, infinite beyond its reach.
    numbers: Vec<f32>,
}

/// Where that of a cell is kept: it is of a few hundred cells, so that its numbers are counted with 32 bits.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Kept {
    begin: u32,
    end: u32,
}

impl Kept {
    #[allow(clippy::cast_possible_truncation)]
    fn of(begin: usize, end: usize) -> Self {
        Self { begin: begin as u32, end: end as u32 }
    }
}

impl Weighed {
    /// Weighs the places of a cell, and tells where what is known of them is kept.
    pub(crate) fn weigh(&mut self, several: &Several, places: &[[f32; 3]], reach: f32) -> Kept {
        let (group, numbers) = (several.group(), &mut self.numbers);
        let begin = numbers.len();
        // At most sixteen.
        #[allow(clippy::cast_precision_loss)]
        numbers.push(places.len() as f32);
        let alone = numbers.len();
        let scores = alone + several.near.len();
        numbers.resize(scores, 0.0);
        for place in places {
            let of_place = numbers.len();
            let (mut within, mut last) = (0, 0);
            for (at, near) in several.near.iter().enumerate() {
                let score = near.errors(*place, reach).map(|errors| errors * errors);
                (within, last) = if score.is_some() { (within + 1, at) } else { (within, last) };
                numbers.push(score.unwrap_or(f32::INFINITY));
            }
            if within < 2 {
                // Of most places it is one, and then there is nothing to weigh.
                numbers.truncate(of_place);
                numbers[alone + last] += if within == 1 { 1.0 } else { 0.0 };
                continue;
            }
            let of_regions = numbers[of_place..].iter_mut().zip(&several.near);
            for (score, near) in of_regions.filter(|(score, _)| **score < f32::INFINITY) {
                *score += group.outside(near, *place);
            }
        }
        Kept::of(begin, numbers.len())
    }

    /// The parts of a cell of so many points, and whether any could be of two regions. `kept` is where [`weigh`](Self::weigh) has told, and
    /// the lists are memory to work with.
    pub(crate) fn mixed(
        &self,
        kept: Kept,
        several: &Several,
        points: f64,
        (parts, likely): (&mut Vec<Part>, &mut Vec<f32>),
    ) -> (Parts, bool) {
        let near = &several.near;
        let kept = &self.numbers[kept.begin as usize..kept.end as usize];
        let Some((places, numbers)) = kept.split_first() else { return (Parts::None, false) };
        let (alone, scores) = numbers.split_at(near.len());
        let each = points / f64::from(*places);
        parts.clear();
        parts.extend(near.iter().zip(alone).map(|(near, alone)| {
            let points = each * f64::from(*alone);
            Part { region: near.region, expected: points, labelled: points }
        }));
        for scores in scores.chunks_exact(near.len()) {
            likely.clear();
            let (mut least, mut best) = (f32::INFINITY, 0);
            for ((at, near), score) in near.iter().enumerate().zip(scores) {
                let score = score + near.prior;
                (least, best) = if score < least { (score, at) } else { (least, best) };
                likely.push(score);
            }
            parts[best].labelled += each;
            // In place of the scores.
            let mut all = 0.0;
            for score in likely.iter_mut() {
                *score = likelihood(*score - least);
                all += f64::from(*score);
            }
            for (part, likely) in parts.iter_mut().zip(&*likely) {
                let share = f64::from(*likely) / all;
                part.expected += if share > LEAST_SHARE { each * share } else { 0.0 };
            }
        }
        parts.retain(|part| part.expected > 0.0);
        (Parts::of(parts), !scores.is_empty())
    }
}

/// How probable something is beside the most probable, from −2 ln of it.
fn likelihood(score: f32) -> f32 {
    // What is beyond the reach, or the most probable itself.
    if score == f32::INFINITY {
        0.0
    } else if score <= 0.0 {
        1.0
    } else {
        // Places are in single precision, and so is what they are held against.
        #[allow(clippy::cast_possible_truncation)]
        let likely = f64::from(-0.5 * score).exp() as f32;
        likely
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::near::{Near, Within};
    use proptest::prelude::*;

    const REACH: f32 = 3.0;

    fn several(planes: &[([f32; 3], f32, f32)]) -> Several {
        let near = (0..).zip(planes).map(|(region, (normal, offset, prior))| Near {
            region,
            normal: *normal,
            offset: *offset,
            prior: *prior,
            ends: (0, 0),
        });
        Several { near: near.collect(), ends: Box::new([]) }
    }

    /// By definition: of each place the probability of each region.
    fn by_place(several: &Several, places: &[[f32; 3]], points: f64) -> (Vec<[f64; 2]>, bool) {
        let (group, each) = (several.group(), points / places.len() as f64);
        let (mut parts, mut is_open) = (vec![[0.0; 2]; several.near.len()], false);
        for place in places {
            let score =
                |near: &Near| group.score(near, *place, REACH).map_or(0.0, |s| f64::from(-0.5 * s).exp());
            let likely: Vec<f64> = several.near.iter().map(score).collect();
            let all: f64 = likely.iter().sum();
            for (part, likely) in parts.iter_mut().zip(&likely) {
                let share = if all > 0.0 { likely / all } else { 0.0 };
                part[0] += if share > LEAST_SHARE { each * share } else { 0.0 };
            }
            if let Some(best) = group.best(*place, REACH) {
                parts[best][1] += each;
            }
            is_open |= matches!(group.within(*place, REACH), Within::Several);
        }
        (parts, is_open)
    }

    #[test]
    fn places_beyond_all_reach_are_of_no_region() {
        let (mut weighed, (mut parts, mut likely)) = (Weighed::default(), <(Vec<Part>, Vec<f32>)>::default());
        let several = several(&[([1.0, 0.0, 0.0], 0.0, 0.0), ([0.0, 1.0, 0.0], 0.0, 0.0)]);
        for (places, open) in [(&[[9.0; 3], [f32::NAN; 3]][..], false), (&[[9.0; 3], [1.0; 3]], true)] {
            let kept = weighed.weigh(&several, places, REACH);
            let (parts, is_open) = weighed.mixed(kept, &several, 10.0, (&mut parts, &mut likely));
            assert_eq!((parts.as_slice().len(), is_open), (if open { 2 } else { 0 }, open));
        }
    }

    proptest! {
        #[test]
        fn parts_are_those_of_place_by_place_with_any_shares_around(
            planes in prop::collection::vec((prop::array::uniform3(-2.0..2.0_f32), -2.0..2.0_f32, 0.0..9.0_f32), 2..5),
            places in prop::collection::vec(prop::array::uniform3(-2.0..2.0_f32), 1..17),
            priors in prop::array::uniform4(0.0..9.0_f32),
            points in 1.0..100.0_f64,
        ) {
            let mut several = several(&planes);
            let (mut weighed, mut parts, mut likely) = (Weighed::default(), Vec::new(), Vec::new());
            // Of another cell before.
            weighed.weigh(&several, &places[..1], REACH);
            let kept = weighed.weigh(&several, &places, REACH);
            for again in [false, true] {
                if again {
                    several.near.iter_mut().zip(priors).for_each(|(near, prior)| near.prior = prior);
                }
                let (expected, expected_open) = by_place(&several, &places, points);
                let (found, is_open) = weighed.mixed(kept, &several, points, (&mut parts, &mut likely));
                prop_assert_eq!(is_open, expected_open);
                for (region, [share, labelled]) in (0..).zip(&expected) {
                    let part = found.as_slice().iter().find(|part| part.region == region);
                    let found = part.map_or([0.0; 2], |part| [part.expected, part.labelled]);
                    // A share next to the least may be either; scores are in single precision.
                    prop_assert!((found[0] - share).abs() <= 1e-4 * points + LEAST_SHARE * 1.01 * points, "{found:?} {share}");
                    prop_assert!((found[1] - labelled).abs() <= 1e-9 * points, "{found:?} {labelled}");
                }
            }
        }
    }
}
