//! The certified search: finds low values early, and proves what it found as far as the budget goes.

mod line;
mod outlook;
mod pieces;
mod space;

use std::num::NonZeroUsize;

use crate::ledger::{Ledger, check_starts};
use crate::{Bounds, Cost, Minimum, SearchError, Steps, Stopping};

/// A search with a proof: evaluates where a lower value is most likely, and tells, whenever it is stopped, for what
/// share of the domain (all allowed places) it is proven that the cost is not lower. With evaluations enough that is
/// all of it, and the result is exact. Any number of axes; nothing is drawn at random.
///
/// # Algorithm
///
/// What is not covered by known steps is kept as boxes that do not overlap; in one axis these are the gaps between
/// known steps. Each has a *score*: how likely it is that a lower value lies in it.
///
/// 1. Ask at the places given as [`start`](Self::start).
/// 2. Take the uncovered box with the best score and ask at one place in it; the cost may give up as soon as it knows
///    that it is not below the lowest value so far ([`Cost::evaluate_below`]).
/// 3. Cut the step that was answered, or on which the cost is bounded, out of the box; score the pieces.
/// 4. Go on at 2. until nothing is uncovered, or [`Stopping`] ends it.
///
/// *The score* decides only in which order places are asked for; the proof does not depend on it. In short: a gap
/// scores high when the values at its ends are low, when it is wide, and when neighbouring steps differ much. The
/// next three paragraphs tell how this is computed, for readers who know some statistics; nothing else here needs
/// them.
///
/// *In one axis.* The cost is seen as a trend with jitter: a large-scale course, and every step apart from it by an
/// error of its own. The trend is taken for a random walk (a Brownian path), so that between two known steps the cost
/// is normally distributed, with a mean on the straight line between their trends and a variance that grows with the
/// width of the gap. The score is the probability that it lies below the lowest value by a margin. In a gap between
/// two known steps two places are compared, the middle and one nearer to the end of lower value, and the better is
/// asked for; in a gap at the end of the axis it is that end.
///
/// *Estimates.* How much the trend varies, and how large the jitter is, are estimated from the differences between
/// neighbouring known steps: near ones tell the jitter, far ones the trend. Medians are used, so that a few large
/// jumps do not spoil them. The trend at the known steps is then found by a Kalman smoother, a kind of running
/// average.
///
/// *In several axes.* The same, with a box in place of the gap, and its centre as the place. The box knows one
/// neighbour, the last place evaluated beside it: the mean is the trend there, and the distance is the one from there
/// to the centre along the axis on which it is largest, as a share of that axis. There is no smoother. Where a real
/// axis is involved and the answer is a single place, the box is halved there along its longest side.
///
/// *Lower bounds.* The cost may give up where it is above the lowest value by half the range of the values so far, so
/// that its answers still tell high from low; during the walk described below, at the lowest value itself. The start
/// places and the first five questions after them are answered in full. For the score a lower bound counts as if it
/// were the value.
///
/// *The largest box.* Every eighth question goes to the middle of the largest uncovered box, whatever its score (in
/// one axis the first five as well), so that narrow steps that no trend announces are met sooner or later, and the
/// certified share grows.
///
/// *The rest.* In one axis, when no lower value was found for a long time, what is uncovered is walked through in
/// ascending order, from the lowest value to the upper end and then from the lower end, for a cost may be cheaper to
/// evaluate beside its last place. A long time is 50 questions, and as many again as had led to the lowest value.
///
/// *Ties*: of equal lowest values the one found first is returned. Of equal scores the box that was made first is
/// taken.
///
/// # When it ends
///
/// With [`StopReason::Certified`](crate::StopReason::Certified) when nothing is uncovered, or before as [`Stopping`]
/// says: a round is one question (or one group of [`batch`](Self::batch)). It does not look at [`Stopping::spread`].
/// If an axis is real, answers that are single places prove nothing; without a limit (evaluations, rounds, stall,
/// target or cancel flag) the search ends after 1000 *d* of them, *d* being the number of axes, with
/// [`StopReason::NoSteps`](crate::StopReason::NoSteps).
///
/// # Based on
///
/// * H. J. Kushner, *A new method of locating the maximum point of an arbitrary multipeak curve in the presence of
///   noise*, Journal of Basic Engineering 86 (1), 97-106, 1964,
///   [doi:10.1115/1.3653121](https://doi.org/10.1115/1.3653121).
/// * A. Žilinskas, *Axiomatic characterization of a global optimization algorithm and investigation of its search
///   strategy*, Operations Research Letters 4 (1), 35-39, 1985,
///   [doi:10.1016/0167-6377(85)90049-5](https://doi.org/10.1016/0167-6377(85)90049-5), which calls it the P-algorithm.
///
/// The steps, the proof, the jitter and the way of several axes are additions.
///
/// # Complexity
///
/// Per question, beside the evaluation: in one axis O(log *k*) for *k* known steps, amortised, about a microsecond.
/// In several axes a look-up, and at most 2 *d* new boxes for each known step that the box overlaps, about ten
/// microseconds. To prove a staircase takes as many evaluations as it has steps if the cost tells them in full, or
/// fewer if it gives up early on stretches of several.
///
/// # Limits
///
/// The proof rests on what the cost tells: a step that is too large, or a lower bound that is too high, makes a false
/// proof. In many axes proof is out of reach, and the certified share small.
///
/// # Examples
///
/// ```
/// use terrace_crs::{Bounds, CertifiedSearch, StopReason, Stopping, from_stairs};
///
/// let mut cost = from_stairs(|x| ((x.floor() - 70.0).abs(), x.floor()..x.floor() + 1.0));
/// let bounds = Bounds::interval(0.0, 99.5)?;
///
/// let stopping = Stopping { evaluations: Some(20), ..Stopping::default() };
/// let early = CertifiedSearch { stopping, ..CertifiedSearch::default() }.minimise(&mut cost, &bounds)?;
/// assert!(early.value <= 2.0 && !early.is_proven());
/// assert!(early.certified > Some(0.19) && early.certified < Some(0.21));
///
/// let exact = CertifiedSearch::default().minimise(&mut cost, &bounds)?;
/// assert_eq!((exact.value, exact.evaluations, exact.stop), (0.0, 100, StopReason::Certified));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct CertifiedSearch {
    /// Places to ask first, in this order: a setting in use, or earlier results.
    pub start: Vec<Vec<f64>>,
    /// How many places are asked for together, by [`Cost::evaluate_many`]; for costs that can run on several threads.
    /// `None`: one.
    ///
    /// The places of a group do not profit from each other's answers, and the cost cannot give up early in a group of
    /// more than one. The result depends on the size of the group and not on the number of threads.
    pub batch: Option<NonZeroUsize>,
    /// When to stop before everything is certified.
    pub stopping: Stopping,
}

/// Answers that are single places on a real axis, per axis, after which a search without limits gives up.
const POINTS: usize = 1000;

/// Of this many questions one goes to the largest uncovered box.
const HONEST: usize = 8;

/// So many questions come before any answer may be a bound: with less nothing can be estimated.
const OPENING: usize = 5;

/// A cost may give up where it is above the lowest value by this part of the range of all values so far. At the lowest
/// value itself its bounds would all be the same, and tell nothing of where to look.
const SLACK: f64 = 0.5;

impl CertifiedSearch {
    /// The lowest cost found within the bounds, and the share of them on which it is proven to be the lowest.
    ///
    /// The same cost, bounds and parameters give the same result and the same trace.
    ///
    /// # Errors
    ///
    /// A [`SearchError`]: start places outside the bounds, reported before the cost is asked; or a cost that breaks
    /// its [contract](Cost#contract), as with a NaN.
    pub fn minimise(&self, cost: &mut (impl Cost + ?Sized), bounds: &Bounds) -> Result<Minimum, SearchError> {
        self.minimise_with(cost, bounds, &mut Steps::new(bounds))
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
    ) -> Result<Minimum, SearchError> {
        let ledger = Ledger::open(cost, bounds, steps, &self.stopping)?.marking_lowest();
        check_starts(&self.start, bounds)?;
        match bounds.axes() {
            [axis] => line::Line::new(axis, ledger, self).run(),
            _ => space::Space::new(ledger, self).run(),
        }
    }

    fn group(&self) -> NonZeroUsize {
        self.batch.unwrap_or(NonZeroUsize::MIN)
    }

    /// The number of answers without a step that are borne.
    fn points(&self, dimension: usize) -> usize {
        let Stopping { evaluations, rounds, spread: _, stall, target, cancel } = &self.stopping;
        let limited = evaluations.is_some()
            || rounds.is_some()
            || stall.is_some()
            || target.is_some()
            || cancel.is_some();
        if limited { usize::MAX } else { POINTS.saturating_mul(dimension) }
    }
}
