//! Controlled random search with local mutation.

use std::num::NonZeroUsize;

use rand::Rng;

use crate::ledger::Ledger;
use crate::population::{self, First, Member};
use crate::{Bounds, Cost, Minimum, SearchError, Steps, StopReason, Stopping, draw};

/// Controlled random search with local mutation: keeps a population (a set of places with their costs), replaces its
/// worst member by a place on the other side of good ones (a reflection) and, where that fails, by a place beside the
/// best (a mutation). Comes to a result in fewer evaluations than
/// [`ControlledRandomSearch`](crate::ControlledRandomSearch), and is more easily caught by a low basin that is not
/// the lowest.
///
/// # Based on
///
/// * P. Kaelo, M. M. Ali, *Some variants of the controlled random search algorithm for global optimization*, Journal
///   of Optimization Theory and Applications 130 (2), 253-264, 2006,
///   [doi:10.1007/s10957-006-9101-0](https://doi.org/10.1007/s10957-006-9101-0). CRS2 is the name there for the
///   second form of Price's controlled random search; this is CRS2 with their local mutation.
///
/// # Algorithm
///
/// For *d* axes and a population of *n*:
///
/// 1. Draw *n* places uniformly in the bounds, after those given as [`start`](Self::start), and ask for their costs.
/// 2. Each round, take the best member b and draw *d* others, none twice. Reflect the last of them, xₗ, through x̄,
///    the centroid (the mean of each coordinate) of b and the rest: x' = 2 x̄ − xₗ. If x' is outside the bounds, the
///    round ends without a question.
/// 3. If the cost of x' is strictly below the largest in the population, x' takes that place.
/// 4. Otherwise try a place on the other side of b, seen from x': on each axis *i* at yᵢ = bᵢ + wᵢ (bᵢ − x'ᵢ), with
///    each wᵢ drawn uniformly in [0, 1) and y moved into the bounds. If its cost is strictly below the largest, y
///    takes that place.
/// 5. Stop as [`Stopping`] says, or when the whole population stands on one known step; return the lowest cost seen.
///
/// On axes of whole numbers or listed values x' and y are rounded to the nearest allowed value, of two the lower.
///
/// *Ties*: the earlier found wins. Of equal lowest costs the first found is the best and is returned; of equal largest
/// costs the one found last is replaced.
///
/// Places on a known step cost nothing: their value is looked up in [`Steps`], not evaluated.
///
/// # Complexity
///
/// Per round O(*n* + *d*²) and at most two look-ups or evaluations.
///
/// # Limits
///
/// The method does not look for a proof. A step much narrower than the distances between the first places is likely
/// missed.
///
/// # Examples
///
/// ```
/// use rand::{SeedableRng, rngs::ChaCha8Rng};
/// use terrace_crs::{Bounds, LocalMutation, from_stairs};
///
/// let mut cost = from_stairs(|x| ((x.floor() - 70.0).abs(), x.floor()..x.floor() + 1.0));
/// let bounds = Bounds::interval(0.0, 100.0)?;
/// let mut rng = ChaCha8Rng::seed_from_u64(1);
/// let minimum = LocalMutation::default().minimise(&mut cost, &bounds, &mut rng)?;
/// assert_eq!(minimum.value, 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct LocalMutation {
    /// The population *n*, at least 1. A population of 1 has nothing to reflect: its member is the result. With fewer
    /// than *d* + 1 members, for *d* axes, each round draws all but the best. `None`: 10 (*d* + 1), or the number of
    /// start places if that is larger.
    pub population: Option<usize>,
    /// Places put into the first population, in this order: a setting in use, or earlier results.
    pub start: Vec<Vec<f64>>,
    /// How many places of the first population are evaluated together; see
    /// [`ControlledRandomSearch::batch`](crate::ControlledRandomSearch::batch).
    pub batch: Option<NonZeroUsize>,
    /// When to stop. If [`Stopping::rounds`] is `None`, it is 50 *n d*. A round is one reflection, with the mutation
    /// that may follow.
    pub stopping: Stopping,
}

impl LocalMutation {
    /// The lowest cost found within the bounds.
    ///
    /// The same cost, bounds, parameters and generator state give the same result and the same trace.
    ///
    /// # Errors
    ///
    /// A [`SearchError`]: parameters that do not fit each other or the bounds, reported before the cost is asked; or
    /// a cost that breaks its [contract](Cost#contract), as with a NaN.
    pub fn minimise(
        &self,
        cost: &mut (impl Cost + ?Sized),
        bounds: &Bounds,
        rng: &mut (impl Rng + ?Sized),
    ) -> Result<Minimum, SearchError> {
        self.minimise_with(cost, bounds, &mut Steps::new(bounds), rng)
    }

    /// As [`minimise`](Self::minimise), with the steps known from earlier searches of the same cost; adds to them.
    ///
    /// # Errors
    ///
    /// As [`minimise`](Self::minimise); `steps` then keeps what was learnt before the error.
    pub fn minimise_with(
        &self,
        cost: &mut (impl Cost + ?Sized),
        bounds: &Bounds,
        steps: &mut Steps,
        rng: &mut (impl Rng + ?Sized),
    ) -> Result<Minimum, SearchError> {
        let mut ledger = Ledger::open(cost, bounds, steps, &self.stopping)?;
        let dimension = bounds.dimension();
        let count = population::size(self.population, 10 * (dimension + 1), &self.start, bounds)?;
        let most = self.stopping.rounds.unwrap_or_else(|| count.saturating_mul(dimension).saturating_mul(50));
        let places = || draw::place(bounds, rng);
        let mut members = match population::first(&mut ledger, &self.start, count, self.batch, places)? {
            First::Members(members) => members,
            First::Ended(stop) => return ledger.finish(0, stop),
        };
        let mut order: Vec<usize> = (0..members.len()).collect();
        let mut simplex = Vec::with_capacity(dimension + 1);
        let mut trial = vec![0.0; dimension];
        let mut rounds = 0;
        loop {
            let (worst, spread) = population::range(&members);
            let one_step = spread == 0.0 && ledger.on_one_step(members.iter().map(|member| &*member.x));
            if let Some(stop) = ledger.halt().or_else(|| self.stopping.converged(spread, one_step)) {
                return ledger.finish(rounds, stop);
            }
            if rounds == most {
                return ledger.finish(rounds, StopReason::Rounds);
            }
            rounds += 1;
            let best = population::best(&members);
            simplex.clear();
            simplex.push(best);
            simplex.extend(draw::others(&mut order, best, dimension, rng));
            population::reflect(&members, &simplex, &mut trial);
            if !bounds.surrounds(&trial) {
                continue;
            }
            bounds.snap(&mut trial);
            let largest = members[worst].value;
            let mut value = ledger.ask(&trial, rounds)?;
            if value >= largest {
                if let Some(stop) = ledger.halt() {
                    return ledger.finish(rounds, stop);
                }
                mutate(&members[best].x, &mut trial, || draw::unit(rng));
                bounds.snap(&mut trial);
                value = ledger.ask(&trial, rounds)?;
            }
            if value < largest {
                ledger.accept(1);
                members[worst] = Member { x: trial.clone(), value, found: members.len() + rounds };
            }
        }
    }
}

/// Moves `trial` to the other side of `best`, by a share of the distance that is drawn for each axis.
fn mutate(best: &[f64], trial: &mut [f64], mut share: impl FnMut() -> f64) {
    for (best, x) in best.iter().zip(trial) {
        *x = best + share() * (best - *x);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mutation_lies_beyond_the_best_by_the_share_drawn() {
        let mut shares = [0.5, 0.0].into_iter();
        let mut trial = [0.0, 7.0];
        mutate(&[1.0, 3.0], &mut trial, || shares.next().unwrap());
        // (1 + w) b - w x
        assert_eq!(trial, [1.5, 3.0]);
    }
}
