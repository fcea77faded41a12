//! Places to begin regions at, the surest first.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use rayon::prelude::*;

use crate::Step;
use crate::field::{COARSE, Field};
use crate::grow::{Growth, SEED_CHI_SQUARED, SEED_TILT, SEED_WIDTH};

/// A group of cells to begin with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Seed {
    pub(crate) level: usize,
    pub(crate) group: u32,
}

/// A number that is not negative, in the order of its bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Tilt(u64);

/// Seeds in the order of how sure their orientation is. That takes a fit; so they are first sorted by a bound of it from below, and
/// fitted when their turn comes: most are of a region by then.
pub(crate) struct Seeds {
    /// The surest last.
    bounds: Vec<(Reverse<Tilt>, Reverse<Seed>)>,
    judged: BinaryHeap<Reverse<(Tilt, Seed)>>,
}

impl Tilt {
    fn of(tilt: f64) -> Self {
        Self(tilt.max(0.0).to_bits())
    }
}

impl Seeds {
    pub(crate) fn of(field: &Field, growth: Growth) -> Self {
        let is_used = |level: &usize| growth.without != Some(Step::Resolutions) || *level == COARSE;
        let noise = field.in_units(growth.noise);
        let mut bounds = Vec::new();
        for level in (0..field.levels.len()).filter(is_used) {
            let bound = |group: usize| {
                let tilt = field.bounded[level][group].least_tilt(noise, SEED_CHI_SQUARED, SEED_WIDTH)?;
                // Groups are no more than cells, which are numbered with 32 bits.
                let group = u32::try_from(group).ok()?;
                (tilt <= SEED_TILT).then_some((Reverse(Tilt::of(tilt)), Reverse(Seed { level, group })))
            };
            bounds.par_extend(
                (0..field.levels[level].len()).into_par_iter().with_min_len(1024).filter_map(bound),
            );
        }
        bounds.sort_unstable();
        Self { bounds, judged: BinaryHeap::new() }
    }

    /// The surest seed. `judge` tells its tilt, which is no smaller than its bound, or that it is none, for good.
    pub(crate) fn next(&mut self, mut judge: impl FnMut(&Seed) -> Option<f64>) -> Option<Seed> {
        loop {
            let bound = self.bounds.last().map(|(Reverse(tilt), _)| *tilt);
            let judged = self.judged.peek().map(|Reverse((tilt, _))| *tilt);
            match (bound, judged) {
                (None, None) => return None,
                // What is only bounded may be as sure, or surer.
                (Some(bound), judged) if judged.is_none_or(|judged| bound <= judged) => {
                    let Some((_, Reverse(seed))) = self.bounds.pop() else { continue };
                    self.judged.extend(judge(&seed).map(|tilt| Reverse((Tilt::of(tilt), seed))));
                }
                _ => {
                    let Some(Reverse((_, seed))) = self.judged.pop() else { continue };
                    // Since it was judged, a region may have taken it.
                    if judge(&seed).is_some() {
                        return Some(seed);
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn seeds_come_in_the_order_of_their_tilts(
            tilts in prop::collection::vec((0.0..1.0_f64, 0.0..1.0_f64, prop::bool::weighted(0.8)), 0..40),
        ) {
            let seed = |group| Seed { level: 0, group };
            let mut bounds: Vec<_> = (0..)
                .zip(&tilts)
                .map(|(group, (tilt, share, _))| (Reverse(Tilt::of(tilt * share)), Reverse(seed(group))))
                .collect();
            bounds.sort_unstable();
            let mut seeds = Seeds { bounds, judged: BinaryHeap::new() };
            let judge = |seed: &Seed| {
                let (tilt, _, is_one) = tilts[seed.group as usize];
                is_one.then_some(tilt)
            };
            let found: Vec<u32> = std::iter::from_fn(|| seeds.next(judge)).map(|seed| seed.group).collect();
            let mut expected: Vec<u32> = (0..).zip(&tilts).filter(|(_, t)| t.2).map(|(group, _)| group).collect();
            expected.sort_by(|a, b| tilts[*a as usize].0.total_cmp(&tilts[*b as usize].0));
            prop_assert_eq!(found, expected);
        }
    }
}
