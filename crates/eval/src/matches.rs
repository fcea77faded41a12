//! Which planes were found, counted.

/// How many planes match, and of how many. See [`Contingency::matches`](crate::Contingency::matches).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Matches {
    /// Pairs of a true and a found plane that match.
    pub matched: usize,
    /// Number of true planes.
    pub true_planes: usize,
    /// Number of found planes.
    pub found_planes: usize,
}

impl Matches {
    /// The share of the found planes that match a true one; `None` when none was found.
    pub fn precision(&self) -> Option<f64> {
        share(self.matched, self.found_planes)
    }

    /// The share of the true planes that were found; `None` when there are none.
    pub fn recall(&self) -> Option<f64> {
        share(self.matched, self.true_planes)
    }

    /// The harmonic mean of precision and recall, 0 when nothing matches; `None` when there are no true planes.
    pub fn f1(&self) -> Option<f64> {
        (self.true_planes > 0)
            .then(|| 2.0 * self.matched as f64 / (self.true_planes + self.found_planes) as f64)
    }
}

fn share(of: usize, all: usize) -> Option<f64> {
    (all > 0).then(|| of as f64 / all as f64)
}
