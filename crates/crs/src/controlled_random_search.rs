//! Controlled random search.

use rand::Rng;

use crate::ledger::Ledger;
use crate::{Bounds, Cost, Minimum, SearchError, Steps, StopReason, Stopping, draw};

/// Controlled random search: a population that contracts by reflections, without derivatives.
///
/// # Based on
///
/// * W. L. Price, *A controlled random search procedure for global optimisation*, The Computer Journal 20 (4),
///   367-370, 1977, [doi:10.1093/comjnl/20.4.367](https://doi.org/10.1093/comjnl/20.4.367).
/// * W. L. Price, *Global optimization by controlled random search*, Journal of Optimization Theory and Applications
///   40 (3), 333-348, 1983, [doi:10.1007/BF00933504](https://doi.org/10.1007/BF00933504).
/// * The form is that of *An Optimization Approach for 3D Environment Mapping using Normal Vector Uncertainty*,
///   section V, Fig. 2, which minimises a staircase-shaped cost of one threshold φ with it.
///
/// # Algorithm
///
/// 1. Draw *n* places uniformly in the bounds, after those given as [`start`](Self::start), and ask for their costs.
/// 2. Each round, draw *m* of them without replacement and reflect the last through the centroid of the others:
///    x' = 2 x̄ − xₘ, with x̄ = (x₁ + … + xₘ₋₁) / (m − 1).
/// 3. Ask for the cost of x'. If it is strictly below the largest cost in the population, it takes that place.
/// 4. Stop as [`Stopping`] says; return the lowest cost seen.
///
/// On one axis *m* = 2 by default: x' = 2 x₁ − x₂.
///
/// *Ties*: the earlier found wins. Of equal lowest costs the first found is returned; of equal largest costs the one
/// found last is replaced.
///
/// # Where this differs from the figure
///
/// * Places on a known step cost nothing: their value is looked up in [`Steps`], not evaluated.
/// * The figure does not say what happens to an x' outside the bounds. Here it is dropped without asking for a
///   cost and drawn again; each such draw counts as a round, so that the number of rounds bounds the run.
/// * The text of the paper stops at a small variance of the samples; here it is the range of their costs, see
///   [`Stopping::spread`], and a population on a single step.
/// * The figure's centroid and reflection lose a coordinate that all members share to rounding; here it is kept
///   exactly, so that axes of zero width work.
///
/// # Complexity
///
/// Per round O(*m d*) and one look-up; O(*n d*) more when the new place is accepted. Memory: the population, the known
/// steps, and one trace entry per question.
///
/// # Limits
///
/// A heuristic: nothing proves the result, and a deep step much narrower than the spacing of the population is likely
/// missed. See [`StopReason::OneStep`] for the one case that is proof.
///
/// # Examples
///
/// ```
/// use rand::{SeedableRng, rngs::ChaCha8Rng};
/// use terrace_crs::{Bounds, ControlledRandomSearch, from_stairs};
///
/// // |x - 7.5| rounded down: steps of width one, the lowest of which is [7.5 - 1, 7.5 + 1).
/// let mut cost = from_stairs(|x| {
///     let side = (x - 7.5).floor();
///     (if side < 0.0 { -side - 1.0 } else { side }, side + 7.5..side + 8.5)
/// });
/// let bounds = Bounds::interval(0.0, 100.0)?;
/// let mut rng = ChaCha8Rng::seed_from_u64(1);
/// let minimum = ControlledRandomSearch::default().minimise(&mut cost, &bounds, &mut rng)?;
/// assert_eq!(minimum.value, 0.0);
/// assert!(minimum.evaluations < minimum.calls);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct ControlledRandomSearch {
    /// The population *n*, at least 1. A population of 1 has nothing to reflect: its member is the result.
    /// `None`: 10 (*d* + 3) for *d* axes, or the number of start points if that is larger.
    pub population: Option<usize>,
    /// The subset *m*, 2 ≤ *m* ≤ *n*. A reflection spans all *d* axes only if *m* > *d*.
    /// `None`: *d* + 1, or *n* if that is smaller.
    pub subset: Option<usize>,
    /// Places put into the first population, in this order (the figure's input φ): a value in use, or earlier results.
    pub start: Vec<Vec<f64>>,
    /// When to stop. Rounds left to the method are 50 *n d*, meant for costs that know their steps; for a costly function
    /// that knows none, set rounds or a spread.
    pub stopping: Stopping,
}

/// The parameters with what was left open filled in.
struct Plan {
    population: usize,
    subset: usize,
    rounds: usize,
}

impl ControlledRandomSearch {
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
        let plan = self.plan(cost.dimension(), bounds, steps)?;
        let mut ledger = Ledger::new(steps);
        let mut members = Vec::new();
        let mut starts = self.start.iter();
        while members.len() < plan.population {
            let x = starts.next().map_or_else(|| draw::place(bounds, rng), Clone::clone);
            let value = ledger.ask(cost, &x, 0)?;
            ledger.accept();
            members.push(Member { x, value, found: members.len() });
        }

        let mut order: Vec<usize> = (0..members.len()).collect();
        let mut trial = vec![0.0; bounds.dimension()];
        let mut rounds = 0;
        loop {
            let (worst, spread) = range(&members);
            let one_step = spread == 0.0 && ledger.on_one_step(members.iter().map(|member| &*member.x));
            if let Some(stop) = self.stopping.converged(spread, one_step) {
                return ledger.finish(rounds, stop);
            }
            // The population stays as it is until a trial is accepted, so the above needs no repetition till then.
            loop {
                if rounds == plan.rounds {
                    return ledger.finish(rounds, StopReason::Rounds);
                }
                rounds += 1;
                reflect(&members, draw::subset(&mut order, plan.subset, rng), &mut trial);
                if !bounds.contains(&trial) {
                    continue;
                }
                let value = ledger.ask(cost, &trial, rounds)?;
                if value < members[worst].value {
                    ledger.accept();
                    members[worst] = Member { x: trial.clone(), value, found: members.len() + rounds };
                    break;
                }
            }
        }
    }

    fn plan(&self, cost: Option<usize>, bounds: &Bounds, steps: &Steps) -> Result<Plan, SearchError> {
        let dimension = bounds.dimension();
        if let Some(cost) = cost.filter(|&cost| cost != dimension) {
            return Err(SearchError::CostDimension { cost, bounds: dimension });
        }
        if steps.dimension() != dimension {
            return Err(SearchError::StepsDimension { steps: steps.dimension(), bounds: dimension });
        }
        self.stopping.check()?;
        self.check_starts(bounds)?;

        let starts = self.start.len();
        let population = self.population.unwrap_or_else(|| (10 * (dimension + 3)).max(starts));
        if population == 0 {
            return Err(SearchError::EmptyPopulation);
        }
        if starts > population {
            return Err(SearchError::TooManyStarts { starts, population });
        }
        let subset = self.subset.unwrap_or_else(|| (dimension + 1).min(population).max(2));
        if subset < 2 {
            return Err(SearchError::SubsetTooSmall { subset });
        }
        if subset > population && (population > 1 || self.subset.is_some()) {
            return Err(SearchError::SubsetTooLarge { subset, population });
        }
        let rounds =
            self.stopping.rounds.unwrap_or_else(|| population.saturating_mul(dimension).saturating_mul(50));
        Ok(Plan { population, subset, rounds })
    }

    fn check_starts(&self, bounds: &Bounds) -> Result<(), SearchError> {
        for (index, x) in self.start.iter().enumerate() {
            if x.len() != bounds.dimension() {
                let (axes, dimension) = (x.len(), bounds.dimension());
                return Err(SearchError::StartDimension { index, axes, dimension });
            }
            if let Some(axis) = bounds.outside(x) {
                let (lo, hi) = bounds.axes()[axis];
                return Err(SearchError::StartOutside { index, axis, value: x[axis], lo, hi });
            }
        }
        Ok(())
    }
}

struct Member {
    x: Vec<f64>,
    value: f64,
    /// Later found, larger number.
    found: usize,
}

/// The member to be replaced next, and by how much its cost exceeds the lowest.
fn range(members: &[Member]) -> (usize, f64) {
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

/// Writes 2 x̄ − xₘ to `trial`: xₘ is the last chosen member, x̄ the centroid of the others.
fn reflect(members: &[Member], chosen: &[usize], trial: &mut [f64]) {
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
}
