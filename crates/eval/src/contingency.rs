//! How many points each pair of planes shares.

use std::collections::BTreeMap;

use terrace_types::PlaneId;

use crate::{EvalError, Matches};

/// A true plane and the found one that is most like it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Best {
    pub truth: PlaneId,
    pub points: u64,
    pub iou: f64,
    pub found: Option<PlaneId>,
}

/// Two planes that share points, with the points of each.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pair {
    pub truth: PlaneId,
    pub found: PlaneId,
    pub shared: u64,
    pub of_truth: u64,
    pub of_found: u64,
}

impl Pair {
    pub(crate) fn iou(&self) -> f64 {
        self.shared as f64 / (self.of_truth + self.of_found - self.shared) as f64
    }
}

/// The number of points of each true plane, of each found plane, of each pair of the two that share any, and of neither.
///
/// Memory follows the pairs that occur, not the numbers of the planes.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Contingency {
    truth: BTreeMap<PlaneId, u64>,
    found: BTreeMap<PlaneId, u64>,
    both: BTreeMap<(PlaneId, PlaneId), u64>,
    neither: u64,
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

    /// Counts labels as they stand in files. Points whose true label is below 0 are left out: it is not known what they
    /// are. A label of 0, and a found one below 0, is no plane.
    ///
    /// ```
    /// use terrace_eval::Contingency;
    ///
    /// let counted = Contingency::of_numbers(&[1, 1, 0, -1], &[4, -1, 0, 4])?;
    /// assert_eq!((counted.points(), counted.weighted_cover()), (3, Some(0.5)));
    /// # Ok::<(), terrace_eval::EvalError>(())
    /// ```
    ///
    /// # Errors
    /// [`EvalError::Length`] when they are not of the same length.
    pub fn of_numbers(truth: &[i32], found: &[i32]) -> Result<Self, EvalError> {
        if truth.len() != found.len() {
            return Err(EvalError::Length { truth: truth.len(), found: found.len() });
        }
        let plane = |number: i32| u32::try_from(number).ok().and_then(PlaneId::new);
        let known = truth.iter().zip(found).filter(|(truth, _)| **truth >= 0);
        Ok(Self::of_counts(known.map(|(truth, found)| (plane(*truth), plane(*found), 1))))
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
        if truth.is_none() && found.is_none() {
            self.neither += points;
        }
    }

    /// Number of points counted.
    pub fn points(&self) -> u64 {
        self.truth.values().sum::<u64>() + self.claimed() + self.neither
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
        let (of_truth, of_found) = (*self.truth.get(&truth)?, *self.found.get(&found)?);
        let shared = self.both.get(&(truth, found)).copied().unwrap_or(0);
        Some(Pair { truth, found, shared, of_truth, of_found }.iou())
    }

    /// The best IoU of each true plane, weighted by its points; 1 when every true plane was found to the point. `None`
    /// without true planes.
    pub fn weighted_cover(&self) -> Option<f64> {
        let points: u64 = self.truth.values().sum();
        let covered: f64 = self.best().into_iter().map(|best| best.iou * best.points as f64).sum();
        (points > 0).then(|| covered / points as f64)
    }

    /// The share of the points of no true plane that a found plane claims; `None` when there are no such points.
    pub fn non_planar_claimed(&self) -> Option<f64> {
        let claimed = self.claimed();
        let points = claimed + self.neither;
        (points > 0).then(|| claimed as f64 / points as f64)
    }

    /// Points of found planes, and of no true one.
    fn claimed(&self) -> u64 {
        self.found.values().sum::<u64>() - self.both.values().sum::<u64>()
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
        Ok(self.matches_above(at_iou))
    }

    /// [`Contingency::matches`] at a threshold that is known to be in range.
    pub(crate) fn matches_above(&self, at_iou: f64) -> Matches {
        Matches {
            matched: self.overlaps().filter(|(_, iou)| *iou > at_iou).count(),
            true_planes: self.true_planes(),
            found_planes: self.found_planes(),
        }
    }

    /// Each true plane with the found plane of the greatest IoU, the one of the least number where several have it.
    pub(crate) fn best(&self) -> Vec<Best> {
        let mut best: BTreeMap<PlaneId, Best> = self
            .truth
            .iter()
            .map(|(truth, points)| (*truth, Best { truth: *truth, points: *points, iou: 0.0, found: None }))
            .collect();
        for ((truth, found), iou) in self.overlaps() {
            if let Some(best) = best.get_mut(&truth).filter(|best| iou > best.iou) {
                (best.iou, best.found) = (iou, Some(found));
            }
        }
        best.into_values().collect()
    }

    /// Each pair that shares points: the planes, the points they share, those of the true and those of the found plane.
    pub(crate) fn pairs(&self) -> impl Iterator<Item = Pair> {
        self.both.iter().filter_map(|((truth, found), shared)| {
            let (of_truth, of_found) = (*self.truth.get(truth)?, *self.found.get(found)?);
            Some(Pair { truth: *truth, found: *found, shared: *shared, of_truth, of_found })
        })
    }

    /// The pairs that share points, with their IoU.
    fn overlaps(&self) -> impl Iterator<Item = ((PlaneId, PlaneId), f64)> {
        self.pairs().map(|pair| ((pair.truth, pair.found), pair.iou()))
    }
}
