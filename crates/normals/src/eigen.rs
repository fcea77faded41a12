//! Eigenvalues and eigenvectors of symmetric 3×3 matrices by cyclic Jacobi rotations.
//!
//! Jacobi is the most accurate of the usual methods on such small matrices, also where eigenvalues are nearly equal or
//! many orders of magnitude apart; Golub and Van Loan, *Matrix Computations*, section 8.5. Several matrices are solved
//! side by side in plain array lanes, which the compiler turns into vector instructions.

use terrace_stats::SymmetricMatrix3;

/// Eigenvalues and eigenvectors of a symmetric 3×3 matrix.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Eigen3 {
    /// Eigenvalues in rising order.
    pub values: [f64; 3],
    /// Unit eigenvectors, perpendicular and right-handed; `vectors[k]` belongs to `values[k]`.
    pub vectors: [[f64; 3]; 3],
}

/// Each sweep rotates every off-diagonal entry away once and squares what is left, so that four or five reach the
/// rounding of any matrix; the rest are for nearly equal eigenvalues, and end early.
const SWEEPS: usize = 12;

/// Square of a quarter of the rounding unit: an off-diagonal entry this small beside its diagonal changes nothing.
const NEGLIGIBLE: f64 = (f64::EPSILON / 4.0) * (f64::EPSILON / 4.0);

/// The eigenvalues and eigenvectors of `matrix`. Entries that are not finite give NaN; there is no other failure.
///
/// ```
/// use terrace_normals::symmetric_eigen;
/// use terrace_stats::SymmetricMatrix3;
///
/// let e = symmetric_eigen(&SymmetricMatrix3::diagonal([3.0, 1.0, 2.0]));
/// assert_eq!(e.values, [1.0, 2.0, 3.0]);
/// assert_eq!(e.vectors[0].map(f64::abs), [0.0, 1.0, 0.0]);
/// ```
pub fn symmetric_eigen(matrix: &SymmetricMatrix3) -> Eigen3 {
    let [eigen] = symmetric_eigen_batch(&[*matrix]);
    eigen
}

/// [`symmetric_eigen`] of `N` matrices side by side; 4 is a good number. The result for each matrix does not depend on
/// the others.
pub fn symmetric_eigen_batch<const N: usize>(matrices: &[SymmetricMatrix3; N]) -> [Eigen3; N] {
    let scales: [f64; N] = std::array::from_fn(|lane| scale_of(&matrices[lane]));
    let mut lanes = Lanes::<N>::of(matrices, &scales);
    for _ in 0..SWEEPS {
        lanes.rotate::<0, 1>();
        lanes.rotate::<0, 2>();
        lanes.rotate::<1, 2>();
        if lanes.done() {
            break;
        }
    }
    std::array::from_fn(|lane| lanes.sorted(lane, scales[lane]))
}

/// A power of two near the largest entry: dividing by it is exact and keeps squares from over- and underflow.
fn scale_of(m: &SymmetricMatrix3) -> f64 {
    let largest = m.0.iter().fold(0.0, |a: f64, x| a.max(x.abs()));
    if !largest.is_finite() {
        return f64::NAN;
    }
    if largest < f64::MIN_POSITIVE {
        return f64::MIN_POSITIVE;
    }
    // The exponent bits alone are the power of two below.
    f64::from_bits(largest.to_bits() & (0x7ff << 52))
}

struct Lanes<const N: usize> {
    /// The upper triangle, row by row: `a[row][column]`, rows ≤ columns used.
    a: [[[f64; N]; 3]; 3],
    /// Eigenvectors as columns: `v[component][vector]`.
    v: [[[f64; N]; 3]; 3],
}

impl<const N: usize> Lanes<N> {
    fn of(matrices: &[SymmetricMatrix3; N], scales: &[f64; N]) -> Self {
        let mut a = [[[0.0; N]; 3]; 3];
        for (lane, m) in matrices.iter().enumerate() {
            for (row, entries) in m.rows().iter().enumerate() {
                for (column, entry) in entries.iter().enumerate() {
                    a[row][column][lane] = entry / scales[lane];
                }
            }
        }
        let v = std::array::from_fn(|i| std::array::from_fn(|j| [if i == j { 1.0 } else { 0.0 }; N]));
        Self { a, v }
    }

    /// Rotates the plane of axes P < Q so that `a[P][Q]` vanishes.
    #[inline]
    fn rotate<const P: usize, const Q: usize>(&mut self) {
        let r = 3 - P - Q;
        let (p_r, q_r) = ((P.min(r), P.max(r)), (Q.min(r), Q.max(r)));
        for lane in 0..N {
            let (pp, qq) = (self.a[P][P][lane], self.a[Q][Q][lane]);
            // Relative to both diagonal entries, so that small eigenvalues beside large ones keep their digits.
            let off = self.a[P][Q][lane];
            let off = if off * off <= NEGLIGIBLE * (pp * qq).abs() { 0.0 } else { off };
            let difference = qq - pp;
            // tan of the rotation, the smaller root of t² + 2 t θ − 1 = 0 with θ = difference / (2 off), written so
            // that it needs no division by `off`; no rotation where `off` is zero already.
            let root = (difference * difference + 4.0 * off * off).sqrt();
            let divisor = difference.abs() + root;
            let t = if off == 0.0 { 0.0 } else { 2.0 * off * 1f64.copysign(difference) / divisor };
            let c = 1.0 / (t * t + 1.0).sqrt();
            let s = t * c;
            self.a[P][P][lane] = pp - t * off;
            self.a[Q][Q][lane] = qq + t * off;
            self.a[P][Q][lane] = 0.0;
            let (ap, aq) = (self.a[p_r.0][p_r.1][lane], self.a[q_r.0][q_r.1][lane]);
            self.a[p_r.0][p_r.1][lane] = c * ap - s * aq;
            self.a[q_r.0][q_r.1][lane] = s * ap + c * aq;
            for component in &mut self.v {
                let (vp, vq) = (component[P][lane], component[Q][lane]);
                component[P][lane] = c * vp - s * vq;
                component[Q][lane] = s * vp + c * vq;
            }
        }
    }

    /// Whether every off-diagonal entry is zero. Further sweeps then turn nothing, so that a lane that is done early
    /// ends with the same bits as it would alone.
    fn done(&self) -> bool {
        (0..N).all(|lane| [(0, 1), (0, 2), (1, 2)].iter().all(|(p, q)| self.a[*p][*q][lane] == 0.0))
    }

    fn sorted(&self, lane: usize, scale: f64) -> Eigen3 {
        let values: [f64; 3] = std::array::from_fn(|k| self.a[k][k][lane]);
        let mut order = [0, 1, 2];
        order.sort_by(|i, j| values[*i].total_cmp(&values[*j]));
        let column = |k: usize| -> [f64; 3] { std::array::from_fn(|i| self.v[i][k][lane]) };
        let (x, y) = (column(order[0]), column(order[1]));
        let z = [x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]];
        Eigen3 { values: order.map(|k| values[k] * scale), vectors: [x, y, z] }
    }
}
