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

impl Eigen3 {
    const NAN: Self = Self { values: [f64::NAN; 3], vectors: [[f64::NAN; 3]; 3] };
}

/// Each sweep rotates every off-diagonal entry away once and squares what is left, so that four or five reach the
/// rounding of any matrix; the rest are for nearly equal eigenvalues, and end early.
const SWEEPS: usize = 12;

/// Fewer matrices are solved before others have begun with wider vectors.
const WIDE: usize = 4;

/// Square of a quarter of the rounding unit: an off-diagonal entry this small beside its diagonal changes nothing.
const NEGLIGIBLE: f64 = (f64::EPSILON / 4.0) * (f64::EPSILON / 4.0);

/// Square of what is nothing beside a largest entry near 1, whatever the diagonal. Above it no square of an entry is
/// subnormal, so that rotations keep all their digits.
const VANISHING: f64 = 1e-200;

/// The eigenvalues and eigenvectors of `matrix`. Entries that are not finite make every number NaN; an eigenvalue beyond
/// the largest f64 becomes infinite. There is no other failure.
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

/// [`symmetric_eigen`] of `N` matrices side by side; 4 and 8 are good numbers. The result for each matrix is the same to the
/// last bit, whatever the others are.
pub fn symmetric_eigen_batch<const N: usize>(matrices: &[SymmetricMatrix3; N]) -> [Eigen3; N] {
    // The same operations, for more numbers at a time where the processor can.
    if N < WIDE { solve(matrices) } else { pulp::Arch::new().dispatch(Wide(matrices)) }
}

/// Matrices that are solved with vectors of any width: a closure of this size would not be made into such instructions.
struct Wide<'m, const N: usize>(&'m [SymmetricMatrix3; N]);

impl<const N: usize> pulp::WithSimd for Wide<'_, N> {
    type Output = [Eigen3; N];

    #[allow(clippy::inline_always)]
    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> Self::Output {
        solve(self.0)
    }
}

// Into what it is dispatched to, and what it calls as well.
#[allow(clippy::inline_always)]
#[inline(always)]
fn solve<const N: usize>(matrices: &[SymmetricMatrix3; N]) -> [Eigen3; N] {
    let scales = matrices.map(|m| scale_of(&m));
    let mut lanes = Lanes::<N>::of(matrices, &scales);
    for _ in 0..SWEEPS {
        if lanes.done() {
            break;
        }
        lanes.rotate::<0, 1>();
        lanes.rotate::<0, 2>();
        lanes.rotate::<1, 2>();
    }
    lanes.sort();
    std::array::from_fn(|lane| scales[lane].map_or(Eigen3::NAN, |scale| lanes.get(lane, scale)))
}

/// A power of two near the largest entry: dividing by it is exact and keeps squares from over- and underflow. `None`
/// for entries that are not finite.
#[allow(clippy::inline_always)]
#[inline(always)]
fn scale_of(m: &SymmetricMatrix3) -> Option<f64> {
    let largest = m.0.iter().fold(0.0, |a: f64, x| a.max(x.abs()));
    // The exponent bits alone are the power of two below.
    let power = f64::from_bits(largest.to_bits() & (0x7ff << 52));
    m.is_finite().then(|| power.max(f64::MIN_POSITIVE))
}

struct Lanes<const N: usize> {
    /// The upper triangle, row by row: `a[row][column]`, rows ≤ columns used.
    a: [[[f64; N]; 3]; 3],
    /// Eigenvectors as columns: `v[vector][component]`.
    v: [[[f64; N]; 3]; 3],
}

// Into what they are dispatched to.
#[allow(clippy::inline_always)]
impl<const N: usize> Lanes<N> {
    /// A lane that is not finite works on zeros instead, which are done at once.
    #[inline(always)]
    fn of(matrices: &[SymmetricMatrix3; N], scales: &[Option<f64>; N]) -> Self {
        let mut a = [[[0.0; N]; 3]; 3];
        for lane in 0..N {
            let Some(scale) = scales[lane] else { continue };
            let (rows, inverse) = (matrices[lane].rows(), 1.0 / scale);
            for row in 0..3 {
                for column in row..3 {
                    a[row][column][lane] = rows[row][column] * inverse;
                }
            }
        }
        let v = std::array::from_fn(|i| std::array::from_fn(|j| [if i == j { 1.0 } else { 0.0 }; N]));
        Self { a, v }
    }

    /// Whether the entry is too small to matter: relative to both diagonal entries, so that small eigenvalues beside
    /// large ones keep their digits.
    #[inline(always)]
    fn negligible(&self, p: usize, q: usize, lane: usize) -> bool {
        let off = self.a[p][q][lane];
        off * off <= NEGLIGIBLE * (self.a[p][p][lane] * self.a[q][q][lane]).abs() + VANISHING
    }

    /// Whether no lane has anything left to turn. Further sweeps then change no bit, so that a lane that is done early
    /// ends as it would alone.
    #[inline(always)]
    fn done(&self) -> bool {
        let mut done = true;
        for lane in 0..N {
            done &= self.negligible(0, 1, lane) & self.negligible(0, 2, lane) & self.negligible(1, 2, lane);
        }
        done
    }

    /// Rotates the plane of axes P < Q so that `a[P][Q]` vanishes.
    #[inline(always)]
    fn rotate<const P: usize, const Q: usize>(&mut self) {
        let r = 3 - P - Q;
        let (p_r, q_r) = ((P.min(r), P.max(r)), (Q.min(r), Q.max(r)));
        let (mut c, mut s) = ([1.0; N], [0.0; N]);
        for lane in 0..N {
            let (pp, qq, off) = (self.a[P][P][lane], self.a[Q][Q][lane], self.a[P][Q][lane]);
            let turn = !self.negligible(P, Q, lane);
            // tan of the rotation is the smaller root of t² + 2 t θ − 1 = 0 with θ = difference / (2 off), here as the
            // quotient of `opposite` and `adjacent`, which needs no division by `off`.
            let difference = qq - pp;
            let opposite = 2.0 * off * 1f64.copysign(difference);
            let adjacent = difference.abs() + (difference * difference + opposite * opposite).sqrt();
            let hypotenuse = (adjacent * adjacent + opposite * opposite).sqrt();
            c[lane] = if turn { adjacent / hypotenuse } else { 1.0 };
            s[lane] = if turn { opposite / hypotenuse } else { 0.0 };
            let shift = if turn { opposite / adjacent * off } else { 0.0 };
            self.a[P][P][lane] = pp - shift;
            self.a[Q][Q][lane] = qq + shift;
            self.a[P][Q][lane] = 0.0;
        }
        for lane in 0..N {
            let (ap, aq) = (self.a[p_r.0][p_r.1][lane], self.a[q_r.0][q_r.1][lane]);
            self.a[p_r.0][p_r.1][lane] = c[lane] * ap - s[lane] * aq;
            self.a[q_r.0][q_r.1][lane] = s[lane] * ap + c[lane] * aq;
        }
        for i in 0..3 {
            for lane in 0..N {
                let (vp, vq) = (self.v[P][i][lane], self.v[Q][i][lane]);
                self.v[P][i][lane] = c[lane] * vp - s[lane] * vq;
                self.v[Q][i][lane] = s[lane] * vp + c[lane] * vq;
            }
        }
    }

    /// Brings the eigenvalues of every lane into rising order.
    #[inline(always)]
    fn sort(&mut self) {
        for (p, q) in [(0, 1), (1, 2), (0, 1)] {
            for lane in 0..N {
                let swap = self.a[q][q][lane] < self.a[p][p][lane];
                let exchanged = |x: f64, y: f64| if swap { (y, x) } else { (x, y) };
                (self.a[p][p][lane], self.a[q][q][lane]) = exchanged(self.a[p][p][lane], self.a[q][q][lane]);
                for i in 0..3 {
                    (self.v[p][i][lane], self.v[q][i][lane]) =
                        exchanged(self.v[p][i][lane], self.v[q][i][lane]);
                }
            }
        }
    }

    #[inline(always)]
    fn get(&self, lane: usize, scale: f64) -> Eigen3 {
        // A dozen rotations leave the lengths some roundings off; one Newton step each brings them back to 1.
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let unit = |v: [f64; 3]| v.map(|c| c * (1.5 - 0.5 * dot(v, v)));
        let [x, y] = [0, 1].map(|k| [0, 1, 2].map(|i| self.v[k][i][lane]));
        let (x, y) = (unit(x), unit(y));
        let z = [x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]];
        let values = [0, 1, 2].map(|k| self.a[k][k][lane] * scale);
        // A sweep with nothing to turn may still change the sign of a zero; adding zero makes all of them positive.
        Eigen3 { values: values.map(|v| v + 0.0), vectors: [x, y, z] }
    }
}
