//! The least eigenvector of arrowhead matrices, without an eigen-solver.

use terrace_stats::SymmetricMatrix3;

/// Newton's steps, those at most.
const STEPS: usize = 8;
/// Each step squares what is left, as a share of the distance from the next eigenvalue: after one this small nothing is.
const CLOSE: f64 = 1e-8;

/// `N` matrices `[[a, 0, p], [0, b, q], [p, q, t]]` side by side, with a ≥ b: what a covariance in the frame of its axes becomes where
/// points are moved along the normal.
///
/// The least eigenvalue is the one root below b of `f(λ) = t − λ − p²/(a − λ) − q²/(b − λ)`, which falls and is concave there, so that
/// Newton's steps from t come down to it; its eigenvector is `(p/(λ − a), q/(λ − b), 1)`. Golub and Van Loan, *Matrix Computations*,
/// section 8.4.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Arrows<const N: usize> {
    /// a and b, of all.
    pub(crate) shaft: [f64; 2],
    /// p and q.
    pub(crate) barbs: [[f64; N]; 2],
    /// t.
    pub(crate) tip: [f64; N],
}

/// Least eigenvalues and their eigenvectors.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Least<const N: usize> {
    pub(crate) value: [f64; N],
    /// Of length 1, the last component not negative.
    pub(crate) vector: [[f64; N]; 3],
    /// Whether it was found. It is not where t is nearly b or more, and where p, q or t is not finite.
    pub(crate) is_found: [bool; N],
}

impl<const N: usize> Arrows<N> {
    // Into what it is dispatched to.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    pub(crate) fn least(&self) -> Least<N> {
        let Self { shaft: [a, b], barbs: [p, q], tip } = self;
        let mut least = Least { value: *tip, vector: [[0.0; N]; 3], is_found: [false; N] };
        for _ in 0..STEPS {
            let mut all = true;
            for lane in 0..N {
                let value = least.value[lane];
                let (x, y) = (p[lane] / (value - a), q[lane] / (value - b));
                let step = (tip[lane] - value + x * p[lane] + y * q[lane]) / (1.0 + x * x + y * y);
                let value = value + step;
                least.value[lane] = value;
                least.is_found[lane] = step.abs() <= CLOSE * (b - value);
                all &= least.is_found[lane];
            }
            if all {
                break;
            }
        }
        for lane in 0..N {
            let value = least.value[lane];
            let (x, y) = (p[lane] / (value - a), q[lane] / (value - b));
            let z = 1.0 / (1.0 + x * x + y * y).sqrt();
            (least.vector[0][lane], least.vector[1][lane], least.vector[2][lane]) = (x * z, y * z, z);
        }
        least
    }

    /// One of them.
    #[cold]
    #[inline(never)]
    pub(crate) fn matrix(&self, lane: usize) -> SymmetricMatrix3 {
        let Self { shaft: [a, b], barbs: [p, q], tip } = self;
        SymmetricMatrix3([*a, 0.0, p[lane], *b, q[lane], tip[lane]])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::symmetric_eigen;
    use proptest::prelude::*;

    fn least(a: f64, b: f64, p: f64, q: f64, t: f64) -> Option<(f64, [f64; 3])> {
        let found = Arrows { shaft: [a, b], barbs: [[p], [q]], tip: [t] }.least();
        found.is_found[0].then_some((found.value[0], found.vector.map(|lanes| lanes[0])))
    }

    #[test]
    fn what_is_not_moved_keeps_its_normal() {
        assert_eq!(least(2.0, 1.0, 0.0, 0.0, 0.0), Some((0.0, [0.0, 0.0, 1.0])));
        assert_eq!(least(1.0, 1.0, 0.0, 0.0, 0.5), Some((0.5, [0.0, 0.0, 1.0])));
    }

    #[test]
    fn what_has_no_least_eigenvector_near_the_normal_is_not_found() {
        assert_eq!(least(2.0, 1.0, 0.0, 0.0, 1.0), None);
        assert_eq!(least(2.0, 1.0, 0.0, 0.0, 1.5), None);
        assert_eq!(least(0.0, 0.0, 0.0, 0.0, 0.0), None);
        for bad in [f64::NAN, f64::INFINITY] {
            assert_eq!(least(2.0, 1.0, bad, 0.0, 0.1), None);
            assert_eq!(least(2.0, 1.0, 0.1, 0.0, bad), None);
            assert_eq!(least(2.0, 1.0, 0.1, bad, 0.1), None);
        }
    }

    #[test]
    fn sizes_whose_squares_are_nothing_or_infinite_are_as_any() {
        let (_, expected) = least(2.0, 1.0, 0.1, 0.2, 0.1).unwrap();
        for size in [1e-200, 1e200] {
            let (_, found) = least(2.0 * size, size, 0.1 * size, 0.2 * size, 0.1 * size).unwrap();
            let close = |i: usize| (found[i] / expected[i] - 1.0).abs() < 1e-14;
            assert!((0..3).all(close), "{found:?}");
        }
    }

    proptest! {
        /// Found or not is another test's matter, but what is found is right.
        #[test]
        fn the_least_eigenvector_is_that_of_the_solver(
            b in 1e-6..1.0_f64,
            pull in prop::array::uniform2(-1.0..1.0_f64),
            size in -12.0..1.0_f64,
            thin in -16.0..0.5_f64,
        ) {
            let [p, q] = pull.map(|pull| pull * b * 10_f64.powf(size));
            let t = b * 10_f64.powf(thin);
            let solved = symmetric_eigen(&SymmetricMatrix3([1.0, 0.0, p, b, q, t]));
            if let Some((value, vector)) = least(1.0, b, p, q, t) {
                let expected = solved.vectors[0].map(|x| x * 1_f64.copysign(solved.vectors[0][2]));
                let (size, gap) = (solved.values[2], solved.values[1] - solved.values[0]);
                prop_assert!((value - solved.values[0]).abs() <= 1e-14 * size);
                for i in 0..3 {
                    prop_assert!((vector[i] - expected[i]).abs() <= 1e-14 * size / gap, "{vector:?} {expected:?}");
                }
            }
        }

        /// And it is found of all that is thin, however far it is turned.
        #[test]
        fn of_what_is_thin_it_is_found(
            b in 1e-6..1.0_f64,
            pull in prop::array::uniform2(-0.5..0.5_f64),
            thin in 0.0..0.5_f64,
        ) {
            let [p, q] = pull.map(|pull| pull * b);
            prop_assert!(least(1.0, b, p, q, thin * b).is_some());
        }
    }
}
