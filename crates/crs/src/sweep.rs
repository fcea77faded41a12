//! The walk along a staircase from end to end.

use crate::ledger::{Heard, Ledger};
use crate::{Bounds, Cost, Minimum, SearchError, Step, Steps, StopReason, Stopping};

/// The walk along one axis from end to end: evaluates at the lower end of the bounds, then at the end of each step it
/// is told, up to the upper end. Visits every step once and so proves its result.
///
/// Places are asked for in strictly ascending order, and each is the place at which the last answer ends. A cost can
/// make use of that, and change its last result where one decision changed instead of computing everything anew.
///
/// On an axis of whole numbers or listed values it goes on at the first value that the last step does not cover; if
/// the cost tells no steps, every value is evaluated. On a real axis a cost without steps cannot be swept, unless the
/// axis has no width: after more than a thousand answers in a row that are single places this is an error
/// ([`SearchError::NoStep`]).
///
/// *Ties*: of equal lowest values the one at the lowest place is returned.
///
/// # When it ends
///
/// With [`StopReason::Certified`] at the upper end, or before as [`Stopping`] says: a round is one question. Ended
/// before, it has proven its result for the part that was walked, whose share is in [`Minimum::certified`]. It does
/// not look at [`Stopping::spread`].
///
/// # Complexity
///
/// One evaluation per step of the staircase, if the cost tells its steps in full, and O(log *k*) beside it for *k*
/// known steps.
///
/// # Examples
///
/// ```
/// use terrace_crs::{Bounds, StopReason, Sweep, from_stairs};
///
/// let mut cost = from_stairs(|x| ((x.floor() - 3.0).abs(), x.floor()..x.floor() + 1.0));
/// let minimum = Sweep::default().minimise(&mut cost, &Bounds::interval(0.0, 9.5)?)?;
/// assert_eq!((minimum.value, minimum.stop, minimum.evaluations), (0.0, StopReason::Certified, 10));
/// assert!(minimum.is_proven());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Sweep {
    /// Whether the cost may give up as soon as it knows that it does not fall below the lowest value so far
    /// ([`Cost::evaluate_below`]). True by default; with false the trace holds the value of every step.
    pub stop_early: bool,
    /// When to stop before the end.
    pub stopping: Stopping,
}

/// Single places in a row that are borne on a real axis: a step can be that narrow.
const NARROW: usize = 1000;

impl Default for Sweep {
    fn default() -> Self {
        Self { stop_early: true, stopping: Stopping::default() }
    }
}

impl Sweep {
    /// The lowest cost within the bounds.
    ///
    /// # Errors
    ///
    /// A [`SearchError`]: bounds of several axes, a cost that tells no steps on a real axis, or one that breaks its
    /// [contract](Cost#contract), as with a NaN.
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
        let [axis] = bounds.axes() else { return Err(SearchError::NotOneAxis { axes: bounds.dimension() }) };
        let mut ledger = Ledger::open(cost, bounds, steps, &self.stopping)?.marking_lowest();
        let mut rounds = 0;
        let mut next = Some(axis.lo());
        // Where a row of answers without a step began, and how many they are: a step may be a single number wide.
        let (mut row_from, mut row) = (axis.lo(), 0);
        while let Some(x) = next {
            if let Some(stop) = ledger.halt() {
                return ledger.finish(rounds, stop);
            }
            if self.stopping.rounds.is_some_and(|most| rounds >= most) {
                return ledger.finish(rounds, StopReason::Rounds);
            }
            rounds += 1;
            let heard = if self.stop_early {
                ledger.ask_below(&[x], rounds, 0.0)?
            } else {
                Heard::Value(ledger.ask(&[x], rounds)?)
            };
            let known = match heard {
                Heard::Value(_) => ledger.steps().step_at(&[x]),
                Heard::Bound(_) => ledger.steps().bound_at(&[x]),
            };
            next = match known.map(|known| known.step) {
                Some(Step::Box { hi, .. }) => {
                    row = 0;
                    hi.first().and_then(|hi| axis.at_or_above(*hi))
                }
                Some(Step::Point) | None => {
                    if row == 0 {
                        row_from = x;
                    }
                    row += 1;
                    if row > NARROW && axis.count().is_none() {
                        return Err(SearchError::NoStep { x: row_from });
                    }
                    axis.at_or_above(x.next_up())
                }
            };
        }
        ledger.finish(rounds, StopReason::Certified)
    }
}
