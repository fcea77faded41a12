//! Bounds of the eigenvalues of a scatter, without an eigen-solver.

use terrace_stats::SymmetricMatrix3;

/// Rounding, as a share of the trace.
const ROUNDING: f64 = 1e-9;
/// Newton's steps, those at most, and how much above the last the root is at most, as a share.
const STEPS: usize = 3;
const MOST_STEPS: usize = 10;
const CLOSE: f64 = 1.0 + 1e-6;
/// Of what is narrower, the middle eigenvalue as a share of the trace, the coefficients of the polynomial tell too little.
const NARROW: f64 = 1e-5;

/// Bounds of the eigenvalues λ₀ ≤ λ₁ ≤ λ₂ of a covariance: some thirty multiplications, where [`symmetric_eigen`](crate::symmetric_eigen)
/// takes a thousand instructions. For what only asks whether points are flat, or wide, enough.
///
/// They hold up to 10⁻¹⁴ of the trace. Of a plane, thin and not a line, they are told to a few millionths; where rounding does not tell
/// they are wide. Those of a matrix that is not finite or not positive semidefinite mean nothing.
///
/// ```
/// use terrace_normals::EigenvalueBounds;
/// use terrace_stats::SymmetricMatrix3;
///
/// let bounds = EigenvalueBounds::of(&SymmetricMatrix3::diagonal([2.0, 0.001, 1.0]));
/// let [low, high] = bounds.least;
/// assert!(low <= 0.001 && 0.001 <= high && high - low < 1e-7);
/// assert!(bounds.middle[0] <= 1.0 && 1.0 <= bounds.middle[1] && bounds.most <= 2.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EigenvalueBounds {
    /// λ₀ from below and above.
    pub least: [f64; 2],
    /// λ₁ from below and above.
    pub middle: [f64; 2],
    /// λ₂ from below.
    pub most: f64,
}

impl EigenvalueBounds {
    /// By the characteristic polynomial p(λ) = λ³ − t λ² + m λ − d, of trace, principal minors and determinant. Below the least root
    /// it rises and is concave, so that Newton's steps from 0 end below it; just above them it is looked at whether the root was
    /// passed. The other two have a known sum and product then.
    #[inline]
    pub fn of(covariance: &SymmetricMatrix3) -> Self {
        let [trace, minors, determinant] = covariance.invariants();
        let at = |x: f64| ((x - trace) * x + minors) * x - determinant;
        let slope = |x: f64| (3.0 * x - 2.0 * trace) * x + minors;
        let mut root = (determinant / minors).max(0.0);
        for _ in 0..STEPS {
            root -= at(root) / slope(root);
        }
        let slack = ROUNDING * trace;
        // Of what rounding leaves of numbers of this size it is far more.
        let is_passed = |high: f64| high < trace / 3.0 && at(high) > slack * slack * trace;
        let mut high = root * CLOSE + slack;
        // What is thick takes longer.
        for _ in STEPS..MOST_STEPS {
            if is_passed(high) {
                break;
            }
            root -= at(root) / slope(root);
            high = root * CLOSE + slack;
        }
        let (low, passed) = ((root - slack).max(0.0), is_passed(high));
        let wide = minors - high * (trace - high) > NARROW * trace * trace;
        if !(passed && wide) {
            return Self { least: [0.0, trace], middle: [0.0, 0.5 * trace], most: trace / 3.0 };
        }
        let smaller =
            |sum: f64, product: f64| 2.0 * product / (sum + (sum * sum - 4.0 * product).max(0.0).sqrt());
        // Sum and product of the other two fall as the least rises; the smaller of them rises with the product and falls with the sum.
        let (sums, products) =
            ([high, low].map(|x| trace - x), [high, low].map(|x| minors - x * (trace - x)));
        let middle = [smaller(sums[1], products[0]), smaller(sums[0], products[1]).min(0.5 * sums[1])];
        Self { least: [low, high], middle, most: sums[0] - middle[1] }
    }

    /// Whether a direction, given by the variance along it, is off the first eigenvector by less than an angle for sure, by the sine
    /// squared: along a unit vector at the angle θ it is at least λ₀ + (λ₁ − λ₀) sin²θ.
    #[inline]
    pub fn is_within(&self, variance: f64, sine_squared: f64) -> bool {
        let ([least, _], [middle, _]) = (self.least, self.middle);
        variance < (sine_squared * middle + (1.0 - sine_squared) * least) * (1.0 - ROUNDING)
    }
}
