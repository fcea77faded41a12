//! What labelled points measure, counted by several threads.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use terrace_regions::{Labeller, Measure, Tally};

/// What points of some regions measure: in a large place those of a view are of few.
pub(crate) type Measures = BTreeMap<u32, Measure>;

/// Tallies that threads borrow, for as many parts of the points as they label on end. Each is as large as there are regions: to make one
/// for every part would cost the more for a point, the larger a place is.
#[derive(Debug, Default)]
pub(super) struct Tallies {
    free: Mutex<Vec<Tally>>,
}

impl Clone for Tallies {
    /// Others of the same kind: what they hold is between two calls nothing.
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl Tallies {
    pub(super) fn borrow(&self, labeller: &Labeller) -> Borrowed<'_> {
        let free = self.free.lock().unwrap_or_else(PoisonError::into_inner).pop();
        Borrowed { tally: free.unwrap_or_else(|| labeller.tally()), of: self }
    }

    /// Adds what was counted since the last time. Sums are of whole numbers: which thread counted what makes no difference.
    pub(super) fn add_to(&self, measures: &mut Measures) {
        for tally in self.free.lock().unwrap_or_else(PoisonError::into_inner).iter_mut() {
            tally.take(|region, measure| measures.entry(region).or_default().add(&measure));
        }
    }
}

/// A tally that is given back when it is dropped.
pub(crate) struct Borrowed<'t> {
    pub(super) tally: Tally,
    of: &'t Tallies,
}

impl Drop for Borrowed<'_> {
    fn drop(&mut self) {
        let tally = std::mem::take(&mut self.tally);
        self.of.free.lock().unwrap_or_else(PoisonError::into_inner).push(tally);
    }
}
