//! Additive statistics of uncertain 3-vectors: count, mean, covariance and expected distance from mergeable sums
