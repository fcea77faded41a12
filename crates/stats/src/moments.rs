//! The sums themselves.

use crate::{SymmetricMatrix3, UncertainVector};

/// Sums over uncertain vectors `pᵢ` with standard errors `εᵢ` and weights `wᵢ`, about the origin of their coordinates.
///
/// | method | sum | paper (weights 1) |
/// |---|---|---|
/// | [`count`](Self::count) | number of vectors | density d |
/// | [`weight`](Self::weight) | Σ w | d |
/// | [`sum`](Self::sum) | Σ w p | L |
/// | [`second`](Self::second) | Σ w p pᵀ | `S_sq` is its diagonal |
/// | [`noise`](Self::noise) | Σ w² C, C the covariance of a vector's error | `E_sq` is its diagonal: [`error`](Self::error) |
///
/// Use [`Stats`](crate::Stats) unless you keep the anchor yourself.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Moments {
    count: u64,
    /// Weight, sum, second and noise in a row: a vector is added with a few instructions for several numbers each.
    sums: [f64; SUMS],
}

const SUMS: usize = 16;

impl Moments {
    /// No vector yet.
    pub const EMPTY: Self = Self { count: 0, sums: [0.0; SUMS] };

    /// Sums that were taken elsewhere, of `count` vectors with weight 1: `Σ p`, `Σ p pᵀ` and the sum of the covariances of their
    /// errors.
    #[inline]
    pub const fn from_sums(
        count: u64,
        sum: [f64; 3],
        second: SymmetricMatrix3,
        noise: SymmetricMatrix3,
    ) -> Self {
        Self::of(count, count as f64, sum, second, noise)
    }

    const fn of(
        count: u64,
        weight: f64,
        [x, y, z]: [f64; 3],
        SymmetricMatrix3([xx, xy, xz, yy, yz, zz]): SymmetricMatrix3,
        SymmetricMatrix3([a, b, c, d, e, f]): SymmetricMatrix3,
    ) -> Self {
        Self { count, sums: [weight, x, y, z, xx, xy, xz, yy, yz, zz, a, b, c, d, e, f] }
    }

    /// Adds a vector with weight 1.
    #[inline]
    pub fn push(&mut self, v: &UncertainVector) {
        self.push_independent(v.value, v.variance());
    }

    /// Adds a vector with weight 1 whose error has any covariance: that of a measurement along a ray, say.
    #[inline]
    pub fn push_covariant(&mut self, value: [f64; 3], covariance: &SymmetricMatrix3) {
        self.merge(&Self::of(1, 1.0, value, SymmetricMatrix3::outer(value), *covariance));
    }

    /// Adds a vector with weight 1 whose errors along the axes are independent and have these variances.
    #[inline]
    pub fn push_independent(&mut self, value: [f64; 3], variances: [f64; 3]) {
        self.push_covariant(value, &SymmetricMatrix3::diagonal(variances));
    }

    /// Adds a vector with a weight, which should be positive.
    #[inline]
    pub fn push_weighted(&mut self, v: &UncertainVector, weight: f64) {
        let errors = v.error.map(|error| weight * error);
        let noise = SymmetricMatrix3::diagonal(errors.map(|error| error * error));
        let second = SymmetricMatrix3::outer(v.value) * weight;
        self.merge(&Self::of(1, weight, v.value.map(|value| weight * value), second, noise));
    }

    /// Adds the sums of other vectors, given in the same coordinates.
    #[inline]
    pub fn merge(&mut self, other: &Self) {
        self.count = self.count.saturating_add(other.count);
        for (sum, more) in self.sums.iter_mut().zip(&other.sums) {
            *sum += more;
        }
    }

    /// The same vectors, each moved by `t`: `Σ w (p+t)(p+t)ᵀ = S + L tᵀ + t Lᵀ + W t tᵀ`.
    #[must_use]
    #[inline]
    pub fn translated(&self, t: [f64; 3]) -> Self {
        let (weight, sum) = (self.weight(), self.sum());
        let second =
            self.second() + SymmetricMatrix3::symmetric_product(sum, t) + SymmetricMatrix3::outer(t) * weight;
        Self::of(self.count, weight, [0, 1, 2].map(|i| sum[i] + weight * t[i]), second, self.noise())
    }

    /// The same vectors with this as the sum of their errors' covariances: for errors that were found out later.
    #[must_use]
    pub fn with_noise(&self, noise: SymmetricMatrix3) -> Self {
        Self::of(self.count, self.weight(), self.sum(), self.second(), noise)
    }

    /// Number of vectors: the density of a cell.
    #[inline]
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Sum of the weights; the count when all weights are 1.
    #[inline]
    pub fn weight(&self) -> f64 {
        self.sums[0]
    }

    /// `L = Σ w p`.
    #[inline]
    pub fn sum(&self) -> [f64; 3] {
        let [_, x, y, z, ..] = self.sums;
        [x, y, z]
    }

    /// `S = Σ w p pᵀ`.
    #[inline]
    pub fn second(&self) -> SymmetricMatrix3 {
        let [_, _, _, _, xx, xy, xz, yy, yz, zz, ..] = self.sums;
        SymmetricMatrix3([xx, xy, xz, yy, yz, zz])
    }

    /// `Σ w² C`: the covariance of the weighted sum of the vectors, their errors being independent.
    #[inline]
    pub fn noise(&self) -> SymmetricMatrix3 {
        let [.., xx, xy, xz, yy, yz, zz] = self.sums;
        SymmetricMatrix3([xx, xy, xz, yy, yz, zz])
    }

    /// Mean covariance of the vectors' errors, `Σ w² C / W`, of vectors with weight 1. `None` without weight.
    #[inline]
    pub fn mean_noise(&self) -> Option<SymmetricMatrix3> {
        let weight = self.weight();
        (weight > 0.0).then(|| self.noise() * (1.0 / weight))
    }

    /// `E = Σ w² ε²`, per axis: the diagonal of [`noise`](Self::noise).
    #[inline]
    pub fn error(&self) -> [f64; 3] {
        self.noise().diagonal_entries()
    }

    /// The mean `L / W`: the expectation of the virtual centre, Eq. (1). `None` without weight.
    #[inline]
    pub fn mean(&self) -> Option<[f64; 3]> {
        (self.weight() > 0.0).then(|| self.sum().map(|s| s / self.weight()))
    }

    /// The scatter of the vectors about their mean, `S/W − m mᵀ`: the covariance of the set itself, divided by its
    /// weight and not by one less. Not negative on the diagonal. `None` without weight.
    pub fn covariance(&self) -> Option<SymmetricMatrix3> {
        let mean = self.mean()?;
        let mut c = self.second() * (1.0 / self.weight()) + SymmetricMatrix3::outer(mean) * -1.0;
        for diagonal in [0, 3, 5] {
            // Rounding alone makes a variance negative. `f64::max` would also turn NaN into 0.
            if c.0[diagonal] < 0.0 {
                c.0[diagonal] = 0.0;
            }
        }
        Some(c)
    }

    /// Variance of the mean along each pair of axes: scatter over count, plus what the stated errors add,
    /// `(S/W − m mᵀ)/d + Σ w² C/W²`. `None` without weight.
    ///
    /// "Dependent on the distribution of the points in each cell as well as their inherent uncertainty" (section I).
    pub fn covariance_of_mean(&self) -> Option<SymmetricMatrix3> {
        let squared = self.weight() * self.weight();
        let scatter = self.covariance()? * (1.0 / self.count as f64);
        Some(scatter + SymmetricMatrix3(self.noise().0.map(|c| c / squared)))
    }

    /// Dispersion plus mean squared error per axis, `S/d − (L/d)² + E/d`: the variance of a vector drawn from the set
    /// and then measured. Meant for weights of 1, the paper's case: other weights are not undone. `None` without
    /// weight.
    ///
    /// Its root is the paper's uncertainty `(s_x, s_y, s_z)` of a cluster, when the vectors are its cells' normals.
    pub fn variance_with_error(&self) -> Option<[f64; 3]> {
        let scatter = self.covariance()?.diagonal_entries();
        let error = self.error();
        Some([0, 1, 2].map(|i| scatter[i] + error[i] / self.weight()))
    }

    /// Expected squared distance of an uncertain vector from the uncertain mean (Lemma 3.1, Eq. 3):
    /// `‖p‖² + ‖ε‖² + ‖L‖²/d² + ΣE/d² − 2 p·L/d`, here summed as `‖p − L/W‖² + ‖ε‖² + ΣE/W²`, which is the same
    /// number and does not cancel. `None` without weight.
    #[inline]
    pub fn expected_squared_distance(&self, v: &UncertainVector) -> Option<f64> {
        let mean = self.mean()?;
        let squared = self.weight() * self.weight();
        let error = self.error();
        let terms = [0, 1, 2].map(|i| {
            let difference = v.value[i] - mean[i];
            difference * difference + v.error[i] * v.error[i] + error[i] / squared
        });
        Some(terms[0] + terms[1] + terms[2])
    }
}
