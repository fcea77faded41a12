//! A value with its standard errors.

/// A 3-vector and the standard error of each of its components, in the unit of the vector.
///
/// The paper's uncertain point `(p, ε(p))` (section III-A); a normal with its deviation is one as well.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UncertainVector {
    /// The value.
    pub value: [f64; 3],
    /// Standard error of each component, not negative.
    pub error: [f64; 3],
}

impl UncertainVector {
    /// A vector without error.
    pub const fn exact(value: [f64; 3]) -> Self {
        Self { value, error: [0.0; 3] }
    }

    /// A vector with the same standard error along every axis: the paper's sphere of radius σ.
    pub const fn isotropic(value: [f64; 3], sigma: f64) -> Self {
        Self { value, error: [sigma; 3] }
    }

    /// Square of the standard errors, per axis.
    pub fn variance(&self) -> [f64; 3] {
        self.error.map(|e| e * e)
    }

    /// Whether the value is finite and the errors are finite and not negative.
    pub fn is_finite(&self) -> bool {
        self.value.iter().all(|x| x.is_finite()) && self.error.iter().all(|e| e.is_finite() && *e >= 0.0)
    }

    /// The vector that points the other way, with the same errors.
    #[must_use]
    pub fn flipped(&self) -> Self {
        Self { value: self.value.map(|x| -x), error: self.error }
    }
}
