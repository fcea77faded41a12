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
        let [bounds] = Self::of_all(&[*covariance]);
        bounds
    }

    /// [`of`](Self::of) `N` covariances side by side, the same to the last bit: to be inlined into what is compiled for vectors of `N`
    /// numbers, which does them all in the time of one.
    // Into what it is dispatched to.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    pub fn of_all<const N: usize>(covariances: &[SymmetricMatrix3; N]) -> [Self; N] {
        let (mut trace, mut minors, mut determinant) = ([0.0; N], [0.0; N], [0.0; N]);
        for lane in 0..N {
            [trace[lane], minors[lane], determinant[lane]] = covariances[lane].invariants();
        }
        let at = |lane: usize, x: f64| ((x - trace[lane]) * x + minors[lane]) * x - determinant[lane];
        let slope = |lane: usize, x: f64| (3.0 * x - 2.0 * trace[lane]) * x + minors[lane];
        // Above zero where the root was passed, by far more than rounding leaves of numbers of this size: a number, for answers of several
        // lanes are compared at once, and truth values are not.
        let passed_by = |lane: usize, high: f64, slack: f64| {
            let beyond = at(lane, high) - slack * slack * trace[lane];
            if high < trace[lane] / 3.0 { beyond } else { -1.0 }
        };
        let (mut root, mut high, mut passed) = ([0.0; N], [0.0; N], [0.0; N]);
        for lane in 0..N {
            let start = determinant[lane] / minors[lane];
            let mut x = if start > 0.0 { start } else { 0.0 };
            for _ in 0..STEPS {
                x -= at(lane, x) / slope(lane, x);
            }
            let slack = ROUNDING * trace[lane];
            (root[lane], high[lane]) = (x, x * CLOSE + slack);
            passed[lane] = passed_by(lane, high[lane], slack);
        }
        // What is thick takes longer.
        for _ in STEPS..MOST_STEPS {
            if passed.iter().all(|passed| *passed > 0.0) {
                break;
            }
            for lane in 0..N {
                let (x, slack) = (root[lane], ROUNDING * trace[lane]);
                let next = x - at(lane, x) / slope(lane, x);
                root[lane] = if passed[lane] > 0.0 { x } else { next };
                high[lane] = root[lane] * CLOSE + slack;
                passed[lane] = passed_by(lane, high[lane], slack);
            }
        }
        let (mut least, mut middle, mut most) = ([[0.0; N]; 2], [[0.0; N]; 2], [0.0; N]);
        for lane in 0..N {
            let (trace, minors, high) = (trace[lane], minors[lane], high[lane]);
            let low = (root[lane] - ROUNDING * trace).max(0.0);
            let wide = minors - high * (trace - high) > NARROW * trace * trace;
            let smaller =
                |sum: f64, product: f64| 2.0 * product / (sum + (sum * sum - 4.0 * product).max(0.0).sqrt());
            // Sum and product of the other two fall as the least rises; the smaller of them rises with the product and falls with the sum.
            let (sums, products) =
                ([high, low].map(|x| trace - x), [high, low].map(|x| minors - x * (trace - x)));
            let between = [smaller(sums[1], products[0]), smaller(sums[0], products[1]).min(0.5 * sums[1])];
            let known = (passed[lane] > 0.0) & wide;
            let or = |known_so: f64, otherwise: f64| if known { known_so } else { otherwise };
            (least[0][lane], least[1][lane]) = (or(low, 0.0), or(high, trace));
            (middle[0][lane], middle[1][lane]) = (or(between[0], 0.0), or(between[1], 0.5 * trace));
            most[lane] = or(sums[0] - between[1], trace / 3.0);
        }
        std::array::from_fn(|lane| Self {
            least: least.map(|of| of[lane]),
            middle: middle.map(|of| of[lane]),
            most: most[lane],
        })
    }

    /// Whether a direction, given by the variance along it, is off the first eigenvector by less than an angle for sure, by the sine
    /// squared: along a unit vector at the angle θ it is at least λ₀ + (λ₁ − λ₀) sin²θ.
    #[inline]
    pub fn is_within(&self, variance: f64, sine_squared: f64) -> bool {
        let ([least, _], [middle, _]) = (self.least, self.middle);
        variance < (sine_squared * middle + (1.0 - sine_squared) * least) * (1.0 - ROUNDING)
    }
}
