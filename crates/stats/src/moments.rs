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
    weight: f64,
    sum: [f64; 3],
    second: SymmetricMatrix3,
    noise: SymmetricMatrix3,
}

impl Moments {
    /// No vector yet.
    pub const EMPTY: Self = Self {
        count: 0,
        weight: 0.0,
        sum: [0.0; 3],
        second: SymmetricMatrix3::ZERO,
        noise: SymmetricMatrix3::ZERO,
    };

    /// Sums that were taken elsewhere, of `count` vectors with weight 1: `Σ p`, `Σ p pᵀ` and the sum of the covariances of their
    /// errors.
    #[inline]
    pub const fn from_sums(
        count: u64,
        sum: [f64; 3],
        second: SymmetricMatrix3,
        noise: SymmetricMatrix3,
    ) -> Self {
        Self { count, weight: count as f64, sum, second, noise }
    }

    /// Adds a vector with weight 1.
    #[inline]
    pub fn push(&mut self, v: &UncertainVector) {
        self.push_independent(v.value, v.variance());
    }

    /// Adds vectors one after the other, each as [`push_independent`](Self::push_independent) does: the sums stay in registers.
    #[inline]
    pub fn extend_independent(&mut self, vectors: impl Iterator<Item = ([f64; 3], [f64; 3])>) {
        let (mut count, mut sum, mut second) = (0_u64, self.sum, self.second.0);
        let [mut a, xy, xz, mut b, yz, mut c] = self.noise.0;
        for ([x, y, z], [va, vb, vc]) in vectors {
            count += 1;
            for (sum, value) in sum.iter_mut().zip([x, y, z]) {
                *sum += value;
            }
            for (sum, product) in second.iter_mut().zip([x * x, x * y, x * z, y * y, y * z, z * z]) {
                *sum += product;
            }
            (a, b, c) = (a + va, b + vb, c + vc);
        }
        self.count = self.count.saturating_add(count);
        self.weight += count as f64;
        (self.sum, self.second) = (sum, SymmetricMatrix3(second));
        self.noise = SymmetricMatrix3([a, xy, xz, b, yz, c]);
    }

    /// Adds a vector with weight 1 whose error has any covariance: that of a measurement along a ray, say.
    #[inline]
    pub fn push_covariant(&mut self, value: [f64; 3], covariance: &SymmetricMatrix3) {
        self.count = self.count.saturating_add(1);
        self.weight += 1.0;
        self.second += SymmetricMatrix3::outer(value);
        self.noise += *covariance;
        for i in 0..3 {
            self.sum[i] += value[i];
        }
    }

    /// Adds a vector with weight 1 whose errors along the axes are independent and have these variances.
    #[inline]
    pub fn push_independent(&mut self, value: [f64; 3], variances: [f64; 3]) {
        self.count = self.count.saturating_add(1);
        self.weight += 1.0;
        self.second += SymmetricMatrix3::outer(value);
        self.noise += SymmetricMatrix3::diagonal(variances);
        for i in 0..3 {
            self.sum[i] += value[i];
        }
    }

    /// Adds a vector with a weight, which should be positive.
    #[inline]
    pub fn push_weighted(&mut self, v: &UncertainVector, weight: f64) {
        self.count = self.count.saturating_add(1);
        self.weight += weight;
        self.second += SymmetricMatrix3::outer(v.value) * weight;
        let errors = v.error.map(|error| weight * error);
        self.noise += SymmetricMatrix3::diagonal(errors.map(|error| error * error));
        for i in 0..3 {
            self.sum[i] += weight * v.value[i];
        }
    }

    /// Adds the sums of other vectors, given in the same coordinates.
    #[inline]
    pub fn merge(&mut self, other: &Self) {
        self.count = self.count.saturating_add(other.count);
        self.weight += other.weight;
        self.second += other.second;
        self.noise += other.noise;
        for i in 0..3 {
            self.sum[i] += other.sum[i];
        }
    }

    /// The same vectors, each moved by `t`: `Σ w (p+t)(p+t)ᵀ = S + L tᵀ + t Lᵀ + W t tᵀ`.
    #[must_use]
    #[inline]
    pub fn translated(&self, t: [f64; 3]) -> Self {
        Self {
            sum: [0, 1, 2].map(|i| self.sum[i] + self.weight * t[i]),
            second: self.second
                + SymmetricMatrix3::symmetric_product(self.sum, t)
                + SymmetricMatrix3::outer(t) * self.weight,
            ..*self
        }
    }

    /// The same vectors with this as the sum of their errors' covariances: for errors that were found out later.
    #[must_use]
    pub fn with_noise(&self, noise: SymmetricMatrix3) -> Self {
        Self { noise, ..*self }
    }

    /// Number of vectors: the density of a cell.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Sum of the weights; the count when all weights are 1.
    pub fn weight(&self) -> f64 {
        self.weight
    }

    /// `L = Σ w p`.
    pub fn sum(&self) -> [f64; 3] {
        self.sum
    }

    /// `S = Σ w p pᵀ`.
    pub fn second(&self) -> SymmetricMatrix3 {
        self.second
    }

    /// `Σ w² C`: the covariance of the weighted sum of the vectors, their errors being independent.
    pub fn noise(&self) -> SymmetricMatrix3 {
        self.noise
    }

    /// `E = Σ w² ε²`, per axis: the diagonal of [`noise`](Self::noise).
    #[inline]
    pub fn error(&self) -> [f64; 3] {
        self.noise.diagonal_entries()
    }

    /// The mean `L / W`: the expectation of the virtual centre, Eq. (1). `None` without weight.
    #[inline]
    pub fn mean(&self) -> Option<[f64; 3]> {
        (self.weight > 0.0).then(|| self.sum.map(|s| s / self.weight))
    }

    /// The scatter of the vectors about their mean, `S/W − m mᵀ`: the covariance of the set itself, divided by its
    /// weight and not by one less. Not negative on the diagonal. `None` without weight.
    pub fn covariance(&self) -> Option<SymmetricMatrix3> {
        let mean = self.mean()?;
        let mut c = self.second * (1.0 / self.weight) + SymmetricMatrix3::outer(mean) * -1.0;
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
        let squared = self.weight * self.weight;
        let scatter = self.covariance()? * (1.0 / self.count as f64);
        Some(scatter + SymmetricMatrix3(self.noise.0.map(|c| c / squared)))
    }

    /// Dispersion plus mean squared error per axis, `S/d − (L/d)² + E/d`: the variance of a vector drawn from the set
    /// and then measured. Meant for weights of 1, the paper's case: other weights are not undone. `None` without
    /// weight.
    ///
    /// Its root is the paper's uncertainty `(s_x, s_y, s_z)` of a cluster, when the vectors are its cells' normals.
    pub fn variance_with_error(&self) -> Option<[f64; 3]> {
        let scatter = self.covariance()?.diagonal_entries();
        let error = self.error();
        Some([0, 1, 2].map(|i| scatter[i] + error[i] / self.weight))
    }

    /// Expected squared distance of an uncertain vector from the uncertain mean (Lemma 3.1, Eq. 3):
    /// `‖p‖² + ‖ε‖² + ‖L‖²/d² + ΣE/d² − 2 p·L/d`, here summed as `‖p − L/W‖² + ‖ε‖² + ΣE/W²`, which is the same
    /// number and does not cancel. `None` without weight.
    #[inline]
    pub fn expected_squared_distance(&self, v: &UncertainVector) -> Option<f64> {
        let mean = self.mean()?;
        let squared = self.weight * self.weight;
        let error = self.error();
        let terms = [0, 1, 2].map(|i| {
            let difference = v.value[i] - mean[i];
            difference * difference + v.error[i] * v.error[i] + error[i] / squared
        });
        Some(terms[0] + terms[1] + terms[2])
    }
}
