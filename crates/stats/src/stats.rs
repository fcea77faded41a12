//! Moments and the anchor they are relative to.

use crate::{Moments, SymmetricMatrix3, UncertainVector};

/// Additive statistics of uncertain vectors (Definition 1), kept relative to an anchor.
///
/// Choose the anchor near the vectors: the centre of their voxel, or the first of them. See the [crate page](crate)
/// for the reason and an example.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stats {
    anchor: [f64; 3],
    moments: Moments,
}

impl Stats {
    /// No vector yet; sums will be relative to `anchor`.
    pub const fn new(anchor: [f64; 3]) -> Self {
        Self { anchor, moments: Moments::EMPTY }
    }

    /// Sums that were taken relative to `anchor`.
    pub const fn from_moments(anchor: [f64; 3], moments: Moments) -> Self {
        Self { anchor, moments }
    }

    /// Adds a vector with weight 1.
    #[inline]
    pub fn push(&mut self, v: &UncertainVector) {
        self.moments.push(&self.local(v));
    }

    /// Adds a vector with weight 1 whose error has this covariance.
    #[inline]
    pub fn push_covariant(&mut self, value: [f64; 3], covariance: &SymmetricMatrix3) {
        self.moments.push_covariant(difference(value, self.anchor), covariance);
    }

    /// Adds a vector with a weight, which should be positive. `1/σ²` gives the estimate of least variance.
    #[inline]
    pub fn push_weighted(&mut self, v: &UncertainVector, weight: f64) {
        self.moments.push_weighted(&self.local(v), weight);
    }

    /// Adds the vectors of another set, whatever its anchor.
    #[inline]
    pub fn merge(&mut self, other: &Self) {
        let apart = difference(other.anchor, self.anchor);
        self.moments.merge(&other.moments.translated(apart));
    }

    /// The same set relative to another anchor.
    #[must_use]
    pub fn with_anchor(&self, anchor: [f64; 3]) -> Self {
        Self { anchor, moments: self.moments.translated(difference(self.anchor, anchor)) }
    }

    /// The same set with this as the sum of its errors' covariances, see [`Moments::with_noise`].
    #[must_use]
    pub fn with_noise(&self, noise: SymmetricMatrix3) -> Self {
        Self { moments: self.moments.with_noise(noise), ..*self }
    }

    /// What the sums are relative to.
    pub fn anchor(&self) -> [f64; 3] {
        self.anchor
    }

    /// The sums, relative to the anchor.
    pub fn moments(&self) -> &Moments {
        &self.moments
    }

    /// Number of vectors.
    pub fn count(&self) -> u64 {
        self.moments.count()
    }

    /// Sum of the weights.
    pub fn weight(&self) -> f64 {
        self.moments.weight()
    }

    /// The mean; `None` without weight.
    #[inline]
    pub fn mean(&self) -> Option<[f64; 3]> {
        let mean = self.moments.mean()?;
        Some([0, 1, 2].map(|i| self.anchor[i] + mean[i]))
    }

    /// Scatter about the mean, see [`Moments::covariance`].
    pub fn covariance(&self) -> Option<SymmetricMatrix3> {
        self.moments.covariance()
    }

    /// Variance of the mean, see [`Moments::covariance_of_mean`].
    pub fn covariance_of_mean(&self) -> Option<SymmetricMatrix3> {
        self.moments.covariance_of_mean()
    }

    /// Dispersion plus mean squared error, see [`Moments::variance_with_error`].
    pub fn variance_with_error(&self) -> Option<[f64; 3]> {
        self.moments.variance_with_error()
    }

    /// Expected squared distance from the mean (Eq. 3), see [`Moments::expected_squared_distance`].
    #[inline]
    pub fn expected_squared_distance(&self, v: &UncertainVector) -> Option<f64> {
        self.moments.expected_squared_distance(&self.local(v))
    }

    fn local(&self, v: &UncertainVector) -> UncertainVector {
        UncertainVector { value: difference(v.value, self.anchor), error: v.error }
    }
}

fn difference(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}
