//! What became of each plane: found, split, merged, missed or made up.

use std::collections::{BTreeMap, BTreeSet};

use terrace_types::PlaneId;

use crate::contingency::Pair;
use crate::{Contingency, EvalError};

/// How many planes were found right, split, merged, missed and made up, after Hoover and others (1996). See
/// [`Contingency::segcomp`].
///
/// Every plane is counted once: `correct + over + under_true + missed` are the true planes, and
/// `correct + over_found + under + noise` the found ones.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SegComp {
    /// Pairs of a true and a found plane of which each holds the share of the other's points.
    pub correct: usize,
    /// True planes that were split: two or more found planes lie in one by the share of their points each, and
    /// together hold the share of its points.
    pub over: usize,
    /// Found planes that are the parts of these.
    pub over_found: usize,
    /// Found planes that merge: two or more true planes lie in one by the share of their points each, and together
    /// hold the share of its points.
    pub under: usize,
    /// True planes that are the parts of these.
    pub under_true: usize,
    /// True planes that are none of these.
    pub missed: usize,
    /// Found planes that are none of these.
    pub noise: usize,
}

impl Contingency {
    /// Sorts the planes into those found right, split, merged, missed and made up; the customary `share` is 0.8.
    ///
    /// ```
    /// use terrace_eval::Contingency;
    ///
    /// // The first plane was found, the second in two halves, the third not.
    /// let both = Contingency::of_numbers(&[1, 1, 2, 2, 2, 2, 3, 3], &[5, 5, 6, 6, 7, 7, 0, 0])?;
    /// let sorted = both.segcomp(0.8)?;
    /// assert_eq!((sorted.correct, sorted.over, sorted.over_found, sorted.missed), (1, 1, 2, 1));
    /// # Ok::<(), terrace_eval::EvalError>(())
    /// ```
    ///
    /// # Errors
    /// [`EvalError::Share`] unless `share` is above ½, so that a plane is part of no more than one other, and at most 1.
    pub fn segcomp(&self, share: f64) -> Result<SegComp, EvalError> {
        if share > 0.5 && share <= 1.0 { Ok(self.sorted_at(share)) } else { Err(EvalError::Share { share }) }
    }

    /// [`Contingency::segcomp`] at a share that is known to be in range.
    pub(crate) fn sorted_at(&self, share: f64) -> SegComp {
        let of_found = |pair: &Pair| pair.shared as f64 / pair.of_found as f64 >= share;
        let of_truth = |pair: &Pair| pair.shared as f64 / pair.of_truth as f64 >= share;
        let (mut true_correct, mut found_correct) = (BTreeSet::new(), BTreeSet::new());
        for pair in self.pairs().filter(|pair| of_found(pair) && of_truth(pair)) {
            true_correct.insert(pair.truth);
            found_correct.insert(pair.found);
        }
        let rest = |pair: &Pair| !true_correct.contains(&pair.truth) && !found_correct.contains(&pair.found);

        let split = wholes(self.pairs().filter(|p| rest(p) && of_found(p)), share, |p| (p.truth, p.of_truth));
        let merged =
            wholes(self.pairs().filter(|p| rest(p) && of_truth(p)), share, |p| (p.found, p.of_found));
        let parts = |wholes: &[Whole]| wholes.iter().map(|whole| whole.parts).sum();
        let (over_found, under_true) = (parts(&split), parts(&merged));
        SegComp {
            correct: true_correct.len(),
            over: split.len(),
            over_found,
            under: merged.len(),
            under_true,
            missed: self.true_planes().saturating_sub(true_correct.len() + split.len() + under_true),
            noise: self.found_planes().saturating_sub(found_correct.len() + merged.len() + over_found),
        }
    }
}

/// A plane of one labeling with parts in the other.
#[derive(Default)]
struct Whole {
    points: u64,
    covered: u64,
    parts: usize,
}

/// The planes that `whole` names, with the number of their points, of which two or more parts hold the share.
fn wholes(
    parts: impl Iterator<Item = Pair>,
    share: f64,
    whole: impl Fn(&Pair) -> (PlaneId, u64),
) -> Vec<Whole> {
    let mut wholes: BTreeMap<PlaneId, Whole> = BTreeMap::new();
    for part in parts {
        let (plane, points) = whole(&part);
        let entry = wholes.entry(plane).or_default();
        entry.points = points;
        entry.covered += part.shared;
        entry.parts += 1;
    }
    let is_whole = |w: &Whole| w.parts >= 2 && w.covered as f64 >= share * w.points as f64;
    wholes.into_values().filter(is_whole).collect()
}
