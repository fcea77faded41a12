//! Symmetric 3×3 matrices, by their six different entries.

use std::ops::{Add, AddAssign, Mul};

/// A symmetric 3×3 matrix `[xx, xy, xz, yy, yz, zz]`, such as a covariance.
///
/// ```
/// use terrace_stats::SymmetricMatrix3;
///
/// let m = SymmetricMatrix3::outer([1.0, 2.0, 3.0]) + SymmetricMatrix3::diagonal([1.0; 3]);
/// assert_eq!(m.get(0, 1), m.get(1, 0));
/// assert_eq!(m.rows(), [[2.0, 2.0, 3.0], [2.0, 5.0, 6.0], [3.0, 6.0, 10.0]]);
/// assert_eq!(m.quadratic_form([0.0, 0.0, 2.0]), 40.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SymmetricMatrix3(pub [f64; 6]);

impl SymmetricMatrix3 {
    /// All entries zero.
    pub const ZERO: Self = Self([0.0; 6]);

    /// The matrix with these entries on its diagonal.
    #[inline]
    pub const fn diagonal([x, y, z]: [f64; 3]) -> Self {
        Self([x, 0.0, 0.0, y, 0.0, z])
    }

    /// `v vᵀ`.
    #[inline]
    pub fn outer([x, y, z]: [f64; 3]) -> Self {
        Self([x * x, x * y, x * z, y * y, y * z, z * z])
    }

    /// `u vᵀ + v uᵀ`.
    pub fn symmetric_product(u: [f64; 3], v: [f64; 3]) -> Self {
        Self([
            2.0 * u[0] * v[0],
            u[0] * v[1] + u[1] * v[0],
            u[0] * v[2] + u[2] * v[0],
            2.0 * u[1] * v[1],
            u[1] * v[2] + u[2] * v[1],
            2.0 * u[2] * v[2],
        ])
    }

    /// The entry in this row and column, counted from 0.
    ///
    /// # Panics
    /// When `row` or `column` is above 2.
    pub fn get(&self, row: usize, column: usize) -> f64 {
        self.rows()[row][column]
    }

    /// The three rows.
    pub fn rows(&self) -> [[f64; 3]; 3] {
        let [xx, xy, xz, yy, yz, zz] = self.0;
        [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
    }

    /// The entries on the diagonal.
    pub fn diagonal_entries(&self) -> [f64; 3] {
        [self.0[0], self.0[3], self.0[5]]
    }

    /// Sum of the diagonal.
    pub fn trace(&self) -> f64 {
        self.0[0] + self.0[3] + self.0[5]
    }

    /// `vᵀ M v`: for a covariance and a unit `v`, the variance along `v`.
    pub fn quadratic_form(&self, v: [f64; 3]) -> f64 {
        let [xx, xy, xz, yy, yz, zz] = self.0;
        let [x, y, z] = v;
        xx * x * x + yy * y * y + zz * z * z + 2.0 * (xy * x * y + xz * x * z + yz * y * z)
    }

    /// Trace, sum of the principal minors, determinant: the coefficients of the characteristic polynomial.
    #[inline]
    pub fn invariants(&self) -> [f64; 3] {
        let [xx, xy, xz, yy, yz, zz] = self.0;
        let (a, b, c) = (yy * zz - yz * yz, xy * zz - yz * xz, xy * yz - yy * xz);
        [xx + yy + zz, a + (xx * zz - xz * xz) + (xx * yy - xy * xy), xx * a - xy * b + xz * c]
    }

    /// Bounds of `vᵀ M v` for any unit `v`, from below and above: Gershgorin's. Those of a diagonal matrix are its least and largest
    /// entry.
    #[inline]
    pub fn range(&self) -> [f64; 2] {
        let [xx, xy, xz, yy, yz, zz] = self.0;
        let [x, y, z] = [xy.abs() + xz.abs(), xy.abs() + yz.abs(), xz.abs() + yz.abs()];
        [(xx - x).min(yy - y).min(zz - z), (xx + x).max(yy + y).max(zz + z)]
    }

    /// Whether every entry is finite.
    pub fn is_finite(&self) -> bool {
        self.0.iter().all(|x| x.is_finite())
    }
}

impl Add for SymmetricMatrix3 {
    type Output = Self;
    fn add(mut self, other: Self) -> Self {
        self += other;
        self
    }
}

impl AddAssign for SymmetricMatrix3 {
    fn add_assign(&mut self, other: Self) {
        for (a, b) in self.0.iter_mut().zip(other.0) {
            *a += b;
        }
    }
}

impl Mul<f64> for SymmetricMatrix3 {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self(self.0.map(|x| x * factor))
    }
}
