//! The thresholds on which a result holds.

/// A half-open interval `[lo, hi)` of the orientation threshold φ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// The largest distance that was accepted, 0 when none was: the smallest φ with this result.
    pub lo: f64,
    /// The smallest distance that was rejected: the first φ that may give another result. `None` when no
    /// finite distance was rejected, so that every φ from `lo` up gives this result.
    pub hi: Option<f64>,
}

impl Interval {
    /// Every φ from 0 up: no decision was taken yet.
    pub const ALL: Self = Self { lo: 0.0, hi: None };

    /// Whether the result holds at `phi`.
    pub fn contains(&self, phi: f64) -> bool {
        self.lo <= phi && self.hi.is_none_or(|hi| phi < hi)
    }

    /// The thresholds of both.
    pub(crate) fn and(&self, other: &Self) -> Self {
        let hi = match (self.hi, other.hi) {
            (Some(a), Some(b)) => Some(a.min(b)),
            (a, b) => a.or(b),
        };
        Self { lo: self.lo.max(other.lo), hi }
    }

    /// Takes note of a decision at `phi`, and returns whether the distance was accepted.
    #[inline]
    pub(crate) fn decide(&mut self, distance: f64, phi: f64) -> bool {
        let accepted = distance <= phi;
        if accepted {
            self.lo = self.lo.max(distance);
        } else if distance.is_finite() {
            self.hi = Some(self.hi.map_or(distance, |hi| hi.min(distance)));
        }
        accepted
    }
}
