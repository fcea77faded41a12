//! Sums over all clusters, kept up to date as single clusters change.

use crate::Interval;

/// What one cluster adds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Term {
    pub(crate) clusters: usize,
    pub(crate) members: usize,
    pub(crate) uncertainty: f64,
    pub(crate) weighted: f64,
    /// `s_x + s_y + s_z` of the members themselves.
    pub(crate) errors: f64,
    pub(crate) interval: Interval,
}

impl Term {
    pub(crate) const NOTHING: Self = Self {
        clusters: 0,
        members: 0,
        uncertainty: 0.0,
        weighted: 0.0,
        errors: 0.0,
        interval: Interval::ALL,
    };

    fn and(&self, other: &Self) -> Self {
        Self {
            clusters: self.clusters + other.clusters,
            members: self.members + other.members,
            uncertainty: self.uncertainty + other.uncertainty,
            weighted: self.weighted + other.weighted,
            errors: self.errors + other.errors,
            interval: self.interval.and(&other.interval),
        }
    }
}

/// A binary tree over the places of clusters: the sum is that of both halves, and so depends on what stands at
/// the places, to the last bit, and not on how it came there. A change costs O(log n).
#[derive(Debug, Clone)]
pub(crate) struct Sums {
    /// The root is at 1, the halves of `i` at `2 i` and `2 i + 1`, the places from `leaves` on.
    nodes: Vec<Term>,
    leaves: usize,
}

impl Sums {
    pub(crate) fn new(places: usize) -> Self {
        let leaves = places.next_power_of_two();
        Self { nodes: vec![Term::NOTHING; 2 * leaves], leaves }
    }

    pub(crate) fn set(&mut self, place: usize, term: Term) {
        let mut at = self.leaves + place;
        self.nodes[at] = term;
        while at > 1 {
            at /= 2;
            self.nodes[at] = self.nodes[2 * at].and(&self.nodes[2 * at + 1]);
        }
    }

    pub(crate) fn total(&self) -> Term {
        self.nodes[1]
    }

    /// The sum over the places before `end`.
    pub(crate) fn before(&self, end: usize) -> Term {
        let (mut sum, mut at, mut width) = (Term::NOTHING, 1, self.leaves);
        let mut start = 0;
        // Down to `end`, taking along each left half that lies before it.
        while start < end {
            if start + width <= end {
                return sum.and(&self.nodes[at]);
            }
            (at, width) = (2 * at, width / 2);
            if start + width <= end {
                sum = sum.and(&self.nodes[at]);
                start += width;
                at += 1;
            }
        }
        sum
    }

    /// The first place from `start` on whose interval does not hold `phi`.
    pub(crate) fn first_other(&self, start: usize, phi: f64) -> Option<usize> {
        let mut at = self.leaves + start;
        if start >= self.leaves {
            return None;
        }
        // Up and to the right until a part holds such a place, then down to its first.
        while self.nodes[at].interval.contains(phi) {
            while at % 2 == 1 {
                at /= 2;
            }
            if at == 0 {
                return None;
            }
            at += 1;
        }
        while at < self.leaves {
            at = 2 * at + usize::from(self.nodes[2 * at].interval.contains(phi));
        }
        Some(at - self.leaves)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn term() -> impl Strategy<Value = Term> {
        // Whole numbers, so that the order of summation does not matter.
        (0..9u8, 0.0..1.0f64, prop::option::of(0.0..1.0f64)).prop_map(|(of, lo, width)| {
            let (number, interval) = (f64::from(of), Interval { lo, hi: width.map(|width| lo + width) });
            Term {
                clusters: 1,
                members: of.into(),
                uncertainty: number,
                weighted: number,
                errors: 1.0,
                interval,
            }
        })
    }

    fn sum(terms: &[Term]) -> Term {
        terms.iter().fold(Term::NOTHING, |sum, term| sum.and(term))
    }

    proptest! {
        #[test]
        fn as_term_by_term(
            places in 0..70usize,
            changes in prop::collection::vec((any::<prop::sample::Index>(), term()), 1..60),
            phi in 0.0..2.0f64,
        ) {
            let (mut sums, mut terms) = (Sums::new(places), vec![Term::NOTHING; places]);
            for (place, term) in changes.iter().filter(|_| places > 0) {
                terms[place.index(places)] = *term;
                sums.set(place.index(places), *term);
            }
            prop_assert_eq!(sums.total(), sum(&terms));
            for at in 0..=places {
                prop_assert_eq!(sums.before(at), sum(&terms[..at]));
                let other = (at..places).find(|place| !terms[*place].interval.contains(phi));
                prop_assert_eq!(sums.first_other(at, phi), other);
            }
            prop_assert_eq!(sums.first_other(2 * places + 2, phi), None);
        }
    }
}
