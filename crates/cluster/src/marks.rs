//! Where the growth of a cluster goes another way at another threshold.

use crate::Interval;
use crate::growth::Position;

/// The decisions of a growth that are the first to come out differently at some other threshold.
///
/// The first accepted distance above a lower threshold is larger than all accepted before it, and the first rejected
/// one at or below a higher threshold is smaller than all rejected before it: those alone are kept. They are few: of n
/// distances in random order about ln n.
#[derive(Debug, Clone, Default)]
pub(crate) struct Marks {
    /// Rising.
    accepted: Vec<Mark>,
    /// Falling.
    rejected: Vec<Mark>,
}

#[derive(Debug, Clone)]
struct Mark {
    distance: f64,
    /// Just before the decision.
    position: Position,
}

impl Marks {
    pub(crate) fn clear(&mut self) {
        self.accepted.clear();
        self.rejected.clear();
    }

    /// Takes note of a decision at `phi`, and returns whether the distance was accepted.
    #[inline]
    pub(crate) fn decide(&mut self, distance: f64, phi: f64, before: impl FnOnce() -> Position) -> bool {
        let accepted = distance <= phi;
        if accepted {
            if distance > self.lo() {
                self.accepted.push(Mark { distance, position: before() });
            }
        } else if distance < self.hi().unwrap_or(f64::INFINITY) {
            self.rejected.push(Mark { distance, position: before() });
        }
        accepted
    }

    fn lo(&self) -> f64 {
        self.accepted.last().map_or(0.0, |mark| mark.distance)
    }

    fn hi(&self) -> Option<f64> {
        self.rejected.last().map(|mark| mark.distance)
    }

    /// The thresholds with the same decisions.
    pub(crate) fn interval(&self) -> Interval {
        Interval { lo: self.lo(), hi: self.hi() }
    }

    /// The position before the first decision that comes out differently at `phi`; forgets that decision and all later
    /// ones. `None` when all come out the same.
    pub(crate) fn back_to_the_first_other(&mut self, phi: f64) -> Option<Position> {
        let accepted = self.accepted.partition_point(|mark| mark.distance <= phi);
        let rejected = self.rejected.partition_point(|mark| mark.distance > phi);
        // All accepted distances are below all rejected ones, so that at most one of the two exists.
        let position = self.accepted.get(accepted).or(self.rejected.get(rejected))?.position;
        let before = |mark: &Mark| mark.position.tests < position.tests;
        self.accepted.truncate(self.accepted.partition_point(before));
        self.rejected.truncate(self.rejected.partition_point(before));
        Some(position)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn decide_all(marks: &mut Marks, distances: &[f64], start: usize, phi: f64) {
        for (tests, distance) in (0..).zip(distances).skip(start) {
            marks.decide(*distance, phi, || Position { tests, ..Position::default() });
        }
    }

    proptest! {
        #[test]
        fn back_to_the_first_decision_that_differs(
            // Few different ones, so that thresholds often equal them.
            distances in prop::collection::vec((0..12u8).prop_map(f64::from), 0..30),
            phis in prop::collection::vec((0..24u8).prop_map(|half| 0.5 * f64::from(half)), 1..10),
        ) {
            let mut marks = Marks::default();
            let mut last = phis[0];
            decide_all(&mut marks, &distances, 0, last);
            for phi in phis {
                let other = distances.iter().position(|distance| (*distance <= phi) != (*distance <= last));
                let back = marks.back_to_the_first_other(phi).map(|position| usize::try_from(position.tests).unwrap());
                prop_assert_eq!(back, other);
                decide_all(&mut marks, &distances, other.unwrap_or(distances.len()), phi);
                let mut interval = Interval::ALL;
                for distance in &distances {
                    interval.decide(*distance, phi);
                }
                prop_assert_eq!(marks.interval(), interval);
                last = phi;
            }
        }
    }
}
