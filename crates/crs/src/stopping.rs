//! When a search ends.

use crate::{SearchError, StopReason};

/// The rules that end a search, shared by all methods; the first one met does.
///
/// Not a rule but always in force: a search ends when its whole population stands on one known step, see
/// [`StopReason::OneStep`].
///
/// Write `Stopping { rounds: Some(60), ..Stopping::default() }`, which stays right when rules are added.
#[derive(Debug, Clone, Default)]
pub struct Stopping {
    /// At most this many rounds after the first population (ζ of the paper); `Some(0)` ends with the best of the
    /// first population. `None` leaves the number to the method.
    pub rounds: Option<usize>,
    /// End when the largest minus the smallest cost of the population is at most this, in the unit of the cost.
    /// `Some(0.0)` ends when all costs are equal; `None` (the default) never ends for this reason.
    ///
    /// Equal costs are not enough by default because on a staircase they say little: steps far apart may share a
    /// value and hide a lower one between them. It is the range and not the variance because it has the unit of the
    /// cost and cannot overflow into a false 'equal'.
    pub spread: Option<f64>,
}

impl Stopping {
    pub(crate) fn check(&self) -> Result<(), SearchError> {
        match self.spread {
            Some(spread) if spread.is_nan() || spread < 0.0 => Err(SearchError::Spread { spread }),
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
