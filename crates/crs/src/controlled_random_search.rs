//! Controlled random search.

use std::num::NonZeroUsize;

use rand::Rng;

use crate::ledger::Ledger;
use crate::population::{self, First, Member};
use crate::{Bounds, Cost, Minimum, SearchError, Steps, StopReason, Stopping, draw};

/// Controlled random search: keeps a population, a set of places with their costs, and again and again replaces the
/// worst of them by a better place, found by reflection: from one member through the centre of some others to the far
/// side. So the population draws together around low places. No slope is needed.
///
/// # Based on
///
/// * W. L. Price, *A controlled random search procedure for global optimisation*, The Computer Journal 20 (4),
///   367-370, 1977, [doi:10.1093/comjnl/20.4.367](https://doi.org/10.1093/comjnl/20.4.367).
/// * W. L. Price, *Global optimization by controlled random search*, Journal of Optimization Theory and Applications
///   40 (3), 333-348, 1983, [doi:10.1007/BF00933504](https://doi.org/10.1007/BF00933504).
/// * The form is that of a paper that minimises a staircase of one threshold with it, *An Optimization Approach for 3D
///   Environment Mapping using Normal Vector Uncertainty*, section V, Fig. 2. Nothing of the paper's subject is needed
///   here.
///
/// # Algorithm
///
/// For *d* axes, a population of *n* and a subset of *m*:
///
/// 1. Draw *n* places uniformly in the bounds, after those given as [`start`](Self::start), and ask for their costs.
/// 2. Each round, draw *m* of them, none twice, and reflect the last through x̄, the centroid (the mean of each
///    coordinate) of the others: x' = 2 x̄ − xₘ, with x̄ = (x₁ + … + xₘ₋₁) / (m − 1).
/// 3. Ask for the cost of x'. If it is strictly below the largest cost in the population, it takes that place.
/// 4. Stop as [`Stopping`] says, or when the whole population stands on one known step; return the lowest cost seen.
///
/// On one axis *m* = 2 by default: x' = 2 x₁ − x₂.
///
/// On axes of whole numbers or listed values x' is rounded to the nearest allowed value, of two the lower.
///
/// *Ties*: the earlier found wins. Of equal lowest costs the first found is returned; of equal largest costs the one
/// found last is replaced.
///
/// # Where this differs from the figure
///
/// Only for readers of the paper named above. Its input φ is [`start`](Self::start) here, and its ζ is
/// [`Stopping::rounds`].
///
/// * Places on a known step cost nothing: their value is looked up in [`Steps`], not evaluated.
/// * The figure does not say what happens to an x' outside the bounds. Here it is dropped without asking for a
///   cost and drawn again; each such draw counts as a round, so that the run ends after the given number of rounds.
/// * The text of the paper stops at a small variance of the samples; here it is a small range of their costs, see
///   [`Stopping::spread`], or a population on a single step.
/// * A coordinate that all members share would be changed by rounding in the figure's formulas; here it is kept
///   exactly, so that axes of zero width work.
///
/// # Complexity
///
/// Per round O(*m d*) and one look-up or evaluation; O(*n d*) more when the new place is accepted. Memory: the
/// population, the known steps, and one trace entry per question.
///
/// # Limits
///
/// The method does not look for a proof, and a low step much narrower than the distances between the first places is
/// likely missed. With one axis [`Minimum::is_proven`] tells whether it happens to have met every step.
///
/// # Examples
///
/// ```
/// use rand::{SeedableRng, rngs::ChaCha8Rng};
/// use terrace_crs::{Bounds, ControlledRandomSearch, from_stairs};
///
/// // The distance of x from 7.5, in whole units: it is 0 on the two steps [6.5, 7.5) and [7.5, 8.5).
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
    /// `None`: 10 (*d* + 3) for *d* axes, or the number of start places if that is larger.
    pub population: Option<usize>,
    /// The subset *m*, the members drawn for a reflection: 2 ≤ *m* ≤ *n*. With *m* > *d* a reflection can lead in any
    /// direction; with fewer it stays on the line, plane and so on through its members. `None`: *d* + 1, or *n* if
    /// that is smaller.
    pub subset: Option<usize>,
    /// Places put into the first population, in this order: a setting in use, or earlier results.
    pub start: Vec<Vec<f64>>,
    /// How many places of the first population are evaluated together, by
    /// [`Cost::evaluate_many`]; for costs that can run on several threads. `None`: one.
    ///
    /// Places of a group do not profit from each other: two on the same step are both evaluated. A larger group is
    /// faster on many threads and costs more evaluations. The result does not depend on the number of threads.
    pub batch: Option<NonZeroUsize>,
    /// When to stop. If [`Stopping::rounds`] is `None`, it is 50 *n d*. That many are meant for costs that know their
    /// steps; for a slow function that knows none, set evaluations, rounds or a spread. A round is one reflection,
    /// whether it enters the population or not.
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
        let mut ledger = Ledger::open(cost, bounds, steps, &self.stopping)?;
        let plan = self.plan(bounds)?;
        let places = || draw::place(bounds, rng);
        let mut members =
            match population::first(&mut ledger, &self.start, plan.population, self.batch, places)? {
                First::Members(members) => members,
                First::Ended(stop) => return ledger.finish(0, stop),
            };
        let mut order: Vec<usize> = (0..members.len()).collect();
        let mut trial = vec![0.0; bounds.dimension()];
        let mut rounds = 0;
        loop {
            let (worst, spread) = population::range(&members);
            let one_step = spread == 0.0 && ledger.on_one_step(members.iter().map(|member| &*member.x));
            if let Some(stop) = self.stopping.converged(spread, one_step) {
                return ledger.finish(rounds, stop);
            }
            // The population stays as it is until a trial is accepted, so the above needs no repetition till then.
            loop {
                if let Some(stop) = ledger.halt() {
                    return ledger.finish(rounds, stop);
                }
                if rounds == plan.rounds {
                    return ledger.finish(rounds, StopReason::Rounds);
                }
                rounds += 1;
                population::reflect(&members, draw::subset(&mut order, plan.subset, rng), &mut trial);
                if !bounds.surrounds(&trial) {
                    continue;
                }
                bounds.snap(&mut trial);
                let value = ledger.ask(&trial, rounds)?;
                if value < members[worst].value {
                    ledger.accept(1);
                    members[worst] = Member { x: trial.clone(), value, found: members.len() + rounds };
                    break;
                }
            }
        }
    }

    fn plan(&self, bounds: &Bounds) -> Result<Plan, SearchError> {
        let dimension = bounds.dimension();
        let population = population::size(self.population, 10 * (dimension + 3), &self.start, bounds)?;
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
}
