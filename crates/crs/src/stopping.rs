//! When a search ends.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use crate::{SearchError, StopReason};

/// The rules that end a search, shared by all methods; the first one met does. All are `None` by default: then only
/// the method's own end is in force, which its page tells.
///
/// When several of target, cancel, evaluations and stall are met at once, the reason given is the first of them in
/// this order. When one is met together with the number of rounds, the spread or the method's own end, it depends on
/// the method which is given. To know whether a result is proven ask
/// [`Minimum::is_proven`](crate::Minimum::is_proven), not for the reason.
///
/// Write `Stopping { rounds: Some(60), ..Stopping::default() }`, which still compiles when rules are added.
///
/// ```
/// use std::sync::Arc;
/// use std::sync::atomic::{AtomicBool, Ordering};
/// use terrace_crs::{Bounds, StopReason, Stopping, Sweep, from_stairs};
///
/// // Another thread could hold this flag; here the cost itself raises it.
/// let flag = Arc::new(AtomicBool::new(false));
/// let mut cost = from_stairs(|x| {
///     flag.store(x >= 3.0, Ordering::Relaxed);
///     (x.floor(), x.floor()..x.floor() + 1.0)
/// });
/// let stopping = Stopping { cancel: Some(flag.clone()), ..Stopping::default() };
/// let minimum = Sweep { stopping, ..Sweep::default() }.minimise(&mut cost, &Bounds::interval(0.0, 9.5)?)?;
/// assert_eq!((minimum.stop, minimum.evaluations), (StopReason::Cancelled, 4));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct Stopping {
    /// End when the cost was evaluated this often, answers that gave up early included. A value that is looked up
    /// among the known steps does not count. With `Some(0)` a search sees no value, which is an error.
    pub evaluations: Option<usize>,
    /// At most this many rounds after the first population or the start places; `Some(0)` ends with the best of
    /// these, and is an error for a method that has none. What a round is, and what `None` means, is told by each
    /// method.
    pub rounds: Option<usize>,
    /// End when the largest minus the smallest cost of the population is at most this, in the unit of the cost.
    /// `Some(0.0)` ends when all costs are equal; `None` (the default) never ends for this reason. A population is a
    /// set of places that a method keeps and improves; methods without one do not look at this.
    ///
    /// By default equal costs do not end a search, because on a staircase they say little: steps far apart may have
    /// the same value, and a lower one may lie between them.
    pub spread: Option<f64>,
    /// End after this many evaluations in a row of which none gave a lower value than the lowest before.
    pub stall: Option<usize>,
    /// End as soon as a value at or below this one was seen, in the unit of the cost.
    pub target: Option<f64>,
    /// End, with what was found so far, when the caller sets this flag. It is looked at before every question (or
    /// group of questions asked together); a running evaluation is not interrupted.
    pub cancel: Option<Arc<AtomicBool>>,
}

impl Stopping {
    pub(crate) fn check(&self) -> Result<(), SearchError> {
        match (self.spread, self.target) {
            (Some(spread), _) if spread.is_nan() || spread < 0.0 => Err(SearchError::Spread { spread }),
            (_, Some(target)) if target.is_nan() => Err(SearchError::Target { target }),
            _ => Ok(()),
        }
    }

    /// The rules about a population, whose costs lie `spread` apart.
    pub(crate) fn converged(&self, spread: f64, one_step: bool) -> Option<StopReason> {
        if one_step {
            return Some(StopReason::OneStep);
        }
        self.spread.filter(|&tolerance| spread <= tolerance).map(|_| StopReason::Spread)
    }
}
