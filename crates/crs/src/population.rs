//! What the methods with a population share.

use std::num::NonZeroUsize;

use crate::ledger::{Ledger, check_starts};
use crate::{Bounds, Cost, SearchError, StopReason};

#[derive(Debug, Clone)]
pub(crate) struct Member {
    pub(crate) x: Vec<f64>,
    pub(crate) value: f64,
    /// Later found, larger number.
    pub(crate) found: usize,
}

/// The first population, or why the search ended before it was complete.
pub(crate) enum First {
    Members(Vec<Member>),
    Ended(StopReason),
}

/// The size of the population: the one asked for, else the usual one or the number of starts.
pub(crate) fn size(
    asked: Option<usize>,
    usual: usize,
    start: &[Vec<f64>],
    bounds: &Bounds,
) -> Result<usize, SearchError> {
    check_starts(start, bounds)?;
    let starts = start.len();
    let population = asked.unwrap_or(usual.max(starts));
    if population == 0 {
        return Err(SearchError::EmptyPopulation);
    }
    if starts > population {
        return Err(SearchError::TooManyStarts { starts, population });
    }
    Ok(population)
}

/// Asks for `count` places, the starts first, then drawn ones, in groups of `batch`.
pub(crate) fn first<C: Cost + ?Sized>(
    ledger: &mut Ledger<'_, C>,
    start: &[Vec<f64>],
    count: usize,
    batch: Option<NonZeroUsize>,
    draw: impl FnMut() -> Vec<f64>,
) -> Result<First, SearchError> {
    let mut places = start.iter().cloned().chain(std::iter::repeat_with(draw)).take(count);
    let mut members = Vec::with_capacity(count);
    while members.len() < count {
        if let Some(stop) = ledger.halt() {
            return Ok(First::Ended(stop));
        }
        let group: Vec<Vec<f64>> =
            places.by_ref().take(ledger.room(batch.unwrap_or(NonZeroUsize::MIN))).collect();
        let values = ledger.ask_many(&group, 0)?;
        ledger.accept(group.len());
        for (x, value) in group.into_iter().zip(values) {
            members.push(Member { x, value, found: members.len() });
        }
    }
    Ok(First::Members(members))
}

/// The member to be replaced next, and by how much its cost exceeds the lowest.
pub(crate) fn range(members: &[Member]) -> (usize, f64) {
    let mut worst = 0;
    let mut lowest = f64::INFINITY;
    for (i, member) in members.iter().enumerate() {
        lowest = lowest.min(member.value);
        let other = &members[worst];
        if (member.value, member.found) > (other.value, other.found) {
            worst = i;
        }
    }
    (worst, members[worst].value - lowest)
}

/// The member of the lowest cost, the first found of several.
pub(crate) fn best(members: &[Member]) -> usize {
    let mut best = 0;
    for (i, member) in members.iter().enumerate() {
        let other = &members[best];
        if (member.value, member.found) < (other.value, other.found) {
            best = i;
        }
    }
    best
}

/// Writes 2 x̄ − xₘ to `trial`: xₘ is the last chosen member, x̄ the centroid of the others.
pub(crate) fn reflect(members: &[Member], chosen: &[usize], trial: &mut [f64]) {
    let [first, others @ .., last] = chosen else { return };
    let (first, last) = (&members[*first].x, &members[*last].x);
    let share = 1.0 / (others.len() + 1) as f64;
    for (axis, new) in trial.iter_mut().enumerate() {
        // Relative to one member: exact where all coordinates are equal, and no sum of large numbers.
        let offset: f64 = others.iter().map(|&i| (members[i].x[axis] - first[axis]) * share).sum();
        let centroid = first[axis] + offset;
        *new = centroid + (centroid - last[axis]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn member(x: &[f64], value: f64, found: usize) -> Member {
        Member { x: x.to_vec(), value, found }
    }

    #[test]
    fn the_last_is_reflected_through_the_centroid_of_the_others() {
        let members =
            [member(&[1.0, 1.0], 0.0, 0), member(&[0.0, 0.0], 0.0, 1), member(&[2.0, -4.0], 0.0, 2)];
        let mut trial = [0.0; 2];
        reflect(&members, &[1, 2, 0], &mut trial);
        assert_eq!(trial, [1.0, -5.0]);
        reflect(&members, &[1, 0], &mut trial);
        assert_eq!(trial, [-1.0, -1.0]);
    }

    #[test]
    fn a_shared_coordinate_survives_reflection_to_the_last_bit() {
        let members: Vec<Member> = (0..7).map(|i| member(&[0.1, f64::MAX], 0.0, i)).collect();
        let mut trial = [0.0; 2];
        reflect(&members, &[0, 1, 2, 3, 4, 5, 6], &mut trial);
        assert_eq!(trial, [0.1, f64::MAX]);
    }

    #[test]
    fn of_equal_largest_costs_the_latest_found_is_replaced() {
        let members = [member(&[0.0], 5.0, 3), member(&[0.0], 5.0, 9), member(&[0.0], 1.0, 10)];
        assert_eq!(range(&members), (1, 4.0));
    }

    #[test]
    fn of_equal_lowest_costs_the_first_found_is_the_best() {
        let members = [member(&[0.0], 5.0, 3), member(&[0.0], 1.0, 9), member(&[0.0], 1.0, 4)];
        assert_eq!(best(&members), 2);
    }
}
