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
    /// By level, the surest last.
    bounds: Vec<Vec<Bound>>,
    judged: BinaryHeap<Reverse<(Tilt, Seed)>>,
}

/// A bound of the tilt of a group, and the number of that, in one number: to be sorted fast.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Bound(u64);

impl Bound {
    /// In single precision, which leaves it a bound.
    fn of(tilt: f64, group: u32) -> Self {
        #[allow(clippy::cast_possible_truncation)]
        let near = tilt.max(0.0) as f32;
        let below = if f64::from(near) > tilt { near.next_down() } else { near };
        Self(u64::from(below.to_bits()) << 32 | u64::from(group))
    }

    /// In the order of tilts.
    fn above_group(self) -> u32 {
        // The upper half has 32 bits, and so has the lower.
        #[allow(clippy::cast_possible_truncation)]
        let above = (self.0 >> 32) as u32;
        above
    }

    fn tilt(self) -> Tilt {
        Tilt::of(f32::from_bits(self.above_group()).into())
    }

    fn group(self) -> u32 {
        #[allow(clippy::cast_possible_truncation)]
        let group = self.0 as u32;
        group
    }
}

/// The surest last, of equals the first; they come in the order of their groups.
fn sort(bounds: &mut [Bound]) {
    radsort::sort_by_key(bounds, |bound| bound.above_group());
    bounds.reverse();
}

impl Tilt {
    fn of(tilt: f64) -> Self {
        Self(tilt.max(0.0).to_bits())
    }
}

impl Seeds {
    pub(crate) fn of(field: &Field, growth: Growth) -> Self {
        let is_used = |level: usize| growth.without != Some(Step::Resolutions) || level == COARSE;
        let noise = field.in_units(growth.noise);
        let of_level = |level: usize| {
            let bound = |group: usize| {
                let tilt = field.bounded[level][group].least_tilt(noise, SEED_CHI_SQUARED, SEED_WIDTH)?;
                // Groups are no more than cells, which are numbered with 32 bits.
                (tilt <= SEED_TILT).then_some(Bound::of(tilt, u32::try_from(group).ok()?))
            };
            let groups = if is_used(level) { field.levels[level].len() } else { 0 };
            let mut bounds: Vec<Bound> =
                (0..groups).into_par_iter().with_min_len(1024).filter_map(bound).collect();
            sort(&mut bounds);
            bounds
        };
        let bounds = (0..field.levels.len()).into_par_iter().map(of_level).collect();
        Self { bounds, judged: BinaryHeap::new() }
    }

    /// The surest seed. `judge` tells its tilt, which is no smaller than its bound, or that it is none, for good.
    pub(crate) fn next(&mut self, mut judge: impl FnMut(&Seed) -> Option<f64>) -> Option<Seed> {
        loop {
            let surest =
                self.bounds.iter().enumerate().filter_map(|(level, all)| Some((*all.last()?, level)));
            let bound = surest.min();
            let judged = self.judged.peek().map(|Reverse((tilt, _))| *tilt);
            match (bound, judged) {
                (None, None) => return None,
                // What is only bounded may be as sure, or surer.
                (Some((bound, level)), judged) if judged.is_none_or(|judged| bound.tilt() <= judged) => {
                    self.bounds[level].pop();
                    let seed = Seed { level, group: bound.group() };
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
            tilts in prop::collection::vec((0.0..1.0_f64, 0.0..=1.0_f64, prop::bool::weighted(0.8)), 0..40),
        ) {
            // Every third at another level.
            let mut bounds = vec![Vec::new(); 3];
            for (group, (tilt, share, _)) in (0..).zip(&tilts) {
                bounds[group as usize % 3].push(Bound::of(tilt * share, group));
            }
            for bounds in &mut bounds {
                sort(bounds);
            }
            let mut seeds = Seeds { bounds, judged: BinaryHeap::new() };
            let judge = |seed: &Seed| {
                let (tilt, _, is_one) = tilts[seed.group as usize];
                is_one.then_some(tilt)
            };
            let found: Vec<Seed> = std::iter::from_fn(|| seeds.next(judge)).collect();
            prop_assert!(found.iter().all(|seed| seed.level == seed.group as usize % 3));
            let found: Vec<u32> = found.iter().map(|seed| seed.group).collect();
            let mut expected: Vec<u32> = (0..).zip(&tilts).filter(|(_, t)| t.2).map(|(group, _)| group).collect();
            expected.sort_by(|a, b| tilts[*a as usize].0.total_cmp(&tilts[*b as usize].0));
            prop_assert_eq!(found, expected);
        }

        #[test]
        fn a_bound_is_none_too_large_and_keeps_its_group(tilt in 0.0..2.0_f64, group in any::<u32>()) {
            let bound = Bound::of(tilt, group);
            prop_assert!(bound.tilt() <= Tilt::of(tilt));
            prop_assert!(bound.tilt() >= Tilt::of(tilt * (1.0 - 3e-7) - 1e-44));
            prop_assert_eq!(bound.group(), group);
        }
    }
}
