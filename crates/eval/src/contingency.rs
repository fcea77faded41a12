//! How many points each pair of planes shares.

use std::collections::BTreeMap;

use terrace_types::PlaneId;

use crate::{EvalError, Matches};

/// The number of points of each true plane, of each found plane, and of each pair of the two that share any.
///
/// Memory follows the pairs that occur, not the numbers of the planes.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Contingency {
    truth: BTreeMap<PlaneId, u64>,
    found: BTreeMap<PlaneId, u64>,
    both: BTreeMap<(PlaneId, PlaneId), u64>,
}

impl Contingency {
    /// Counts two labelings of the same points, in the same order.
    ///
    /// # Errors
    /// [`EvalError::Length`] when they are not of the same length.
    pub fn new(truth: &[Option<PlaneId>], found: &[Option<PlaneId>]) -> Result<Self, EvalError> {
        if truth.len() != found.len() {
            return Err(EvalError::Length { truth: truth.len(), found: found.len() });
        }
        Ok(Self::of_counts(truth.iter().zip(found).map(|(truth, found)| (*truth, *found, 1))))
    }

    /// Counts groups of points with the same true and the same found label: these and the number of points. A pair may
    /// come more than once.
    ///
    /// ```
    /// use terrace_eval::Contingency;
    /// use terrace_types::PlaneId;
    ///
    /// let floor = PlaneId::new(1);
    /// let counted = Contingency::of_counts([(floor, floor, 90), (floor, None, 10)]);
    /// assert_eq!(counted.weighted_cover(), Some(0.9));
    /// ```
    pub fn of_counts(groups: impl IntoIterator<Item = (Option<PlaneId>, Option<PlaneId>, u64)>) -> Self {
        let mut counted = Self::default();
        // Neighbouring points mostly have the same labels: one look-up for each run of them.
        let mut run = (None, None, 0);
        for (truth, found, points) in groups {
            if (truth, found) != (run.0, run.1) {
                counted.add(run);
                run = (truth, found, 0);
            }
            run.2 += points;
        }
        counted.add(run);
        counted
    }

    fn add(&mut self, (truth, found, points): (Option<PlaneId>, Option<PlaneId>, u64)) {
        if points == 0 {
            return;
        }
        if let Some(truth) = truth {
            *self.truth.entry(truth).or_default() += points;
        }
        if let Some(found) = found {
            *self.found.entry(found).or_default() += points;
        }
        if let (Some(truth), Some(found)) = (truth, found) {
            *self.both.entry((truth, found)).or_default() += points;
        }
    }

    /// Number of true planes with a point.
    pub fn true_planes(&self) -> usize {
        self.truth.len()
    }

    /// Number of found planes with a point.
    pub fn found_planes(&self) -> usize {
        self.found.len()
    }

    /// Intersection over union of the points of a true and a found plane, 0 when they share none; `None` when either has
    /// no point.
    pub fn iou(&self, truth: PlaneId, found: PlaneId) -> Option<f64> {
        let (of_truth, of_found) = (self.truth.get(&truth)?, self.found.get(&found)?);
        let both = self.both.get(&(truth, found)).copied().unwrap_or(0);
        Some(both as f64 / (of_truth + of_found - both) as f64)
    }

    /// The best IoU of each true plane, weighted by its points; 1 when every true plane was found to the point. `None`
    /// without true planes.
    pub fn weighted_cover(&self) -> Option<f64> {
        let points: u64 = self.truth.values().sum();
        let mut best: BTreeMap<PlaneId, f64> = BTreeMap::new();
        for ((truth, _), iou) in self.overlaps() {
            let best = best.entry(truth).or_default();
            *best = best.max(iou);
        }
        let covered: f64 = best
            .into_iter()
            .map(|(truth, iou)| iou * self.truth.get(&truth).copied().unwrap_or(0) as f64)
            .sum();
        (points > 0).then(|| covered / points as f64)
    }

    /// The pairs of planes with an IoU above `at_iou`.
    ///
    /// # Errors
    /// [`EvalError::Threshold`] unless `at_iou` is at least ½, so that a plane matches no more than one other, and
    /// below 1.
    pub fn matches(&self, at_iou: f64) -> Result<Matches, EvalError> {
        if !(0.5..1.0).contains(&at_iou) {
            return Err(EvalError::Threshold { at_iou });
        }
        Ok(Matches {
            matched: self.overlaps().filter(|(_, iou)| *iou > at_iou).count(),
            true_planes: self.true_planes(),
            found_planes: self.found_planes(),
        })
    }

    /// The pairs that share points, with their IoU.
    fn overlaps(&self) -> impl Iterator<Item = ((PlaneId, PlaneId), f64)> {
        self.both.keys().filter_map(|(truth, found)| Some(((*truth, *found), self.iou(*truth, *found)?)))
    }
}
