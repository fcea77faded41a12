//! The χ² distribution, and quantiles of the normal one.

use statrs::distribution::{ChiSquared, ContinuousCDF, Normal};
use statrs::function::gamma::ln_gamma;

/// From so many degrees of freedom on, the cube root of the variable is normal (Wilson and Hilferty) to more digits than
/// the sums of the exact distribution leave, which grow long and in the end do not end.
const MANY: f64 = 1e7;

/// Below this, one term of the series gives the quantile to 12 digits; statrs takes what is far below for zero.
const TINY: f64 = 1e-12;

/// The probability that a χ² variable with these degrees of freedom is at most `value`.
///
/// `None` when the degrees of freedom are not positive and finite, or the value is NaN.
///
/// ```
/// use terrace_calibration::chi_squared_cdf;
///
/// assert!((chi_squared_cdf(3.0, 7.814_727_903).unwrap() - 0.95).abs() < 1e-10);
/// ```
pub fn chi_squared_cdf(degrees_of_freedom: f64, value: f64) -> Option<f64> {
    if value.is_nan() {
        return None;
    }
    let distribution = distribution(degrees_of_freedom)?;
    if value <= 0.0 {
        return Some(0.0);
    }
    if value == f64::INFINITY {
        return Some(1.0);
    }
    if degrees_of_freedom > MANY {
        let [mean, deviation] = cube_root(degrees_of_freedom);
        let normal = Normal::new(0.0, 1.0).ok()?;
        return Some(normal.cdf(((value / degrees_of_freedom).cbrt() - mean) / deviation));
    }
    Some(distribution.cdf(value).clamp(0.0, 1.0))
}

/// The value below which a χ² variable with these degrees of freedom lies with this probability.
///
/// `None` when the degrees of freedom are not positive and finite, or the probability is not above 0 and below 1.
///
/// ```
/// use terrace_calibration::chi_squared_quantile;
///
/// assert!((chi_squared_quantile(1.0, 0.95).unwrap() - 3.841_458_821).abs() < 1e-9);
/// ```
pub fn chi_squared_quantile(degrees_of_freedom: f64, probability: f64) -> Option<f64> {
    let (k, p) = (degrees_of_freedom, probability);
    let distribution = distribution(k)?;
    let start = start(k, p)?;
    if start < TINY || k > MANY {
        return Some(start);
    }
    // What lies above is compared in the upper half, where the probability below has no digits left.
    let beyond = |x: f64| if p < 0.5 { distribution.cdf(x) - p } else { (1.0 - p) - distribution.sf(x) };
    let (mut low, mut high) = (start, start);
    while low > f64::MIN_POSITIVE && beyond(low) > 0.0 {
        low /= 2.0;
    }
    while high < f64::MAX / 2.0 && beyond(high) < 0.0 {
        high *= 2.0;
    }
    // Newton's steps as long as they stay in the bracket; halving it otherwise. The quantile of statrs 0.18 does not
    // stay in its own: it is NaN near 0 with one degree of freedom, and wrong with millions.
    let mut x = start;
    for _ in 0..200 {
        let excess = beyond(x);
        if excess > 0.0 {
            high = x;
        } else {
            low = x;
        }
        let log_density = (k / 2.0 - 1.0) * (x / 2.0).ln() - x / 2.0 - ln_gamma(k / 2.0);
        let newton = x - excess * 2.0 / log_density.exp();
        let next = if newton > low && newton < high { newton } else { f64::midpoint(low, high) };
        let moved = (next - x).abs();
        x = next;
        if moved <= x * 4.0 * f64::EPSILON {
            break;
        }
    }
    Some(x)
}

/// The value below which a standard normal variable lies with this probability; `None` unless it is above 0 and below 1.
pub(crate) fn normal_quantile(probability: f64) -> Option<f64> {
    let inside = probability > 0.0 && probability < 1.0;
    let normal = Normal::new(0.0, 1.0).ok()?;
    inside.then(|| normal.inverse_cdf(probability))
}

/// How many standard deviations to each side of the mean of a normal variable hold this probability.
pub(crate) fn two_sided(level: f64) -> Option<f64> {
    let inside = level > 0.0 && level < 1.0;
    // By the lower tail, which has digits where the upper one has none.
    if inside { normal_quantile(f64::midpoint(1.0, -level)).map(|z| -z) } else { None }
}

/// The probabilities below and above which half of what `level` leaves out lies.
pub(crate) fn tails(level: f64) -> Option<[f64; 2]> {
    (level > 0.0 && level < 1.0).then(|| [f64::midpoint(1.0, -level), f64::midpoint(1.0, level)])
}

fn distribution(degrees_of_freedom: f64) -> Option<ChiSquared> {
    let valid = degrees_of_freedom.is_finite() && degrees_of_freedom > 0.0;
    if valid { ChiSquared::new(degrees_of_freedom).ok() } else { None }
}

/// Near the quantile: the cube of Wilson and Hilferty, or near 0 the first term of the distribution's series.
fn start(k: f64, p: f64) -> Option<f64> {
    let z = normal_quantile(p)?;
    let [mean, deviation] = cube_root(k);
    let root = mean + z * deviation;
    let cube = k * root.powi(3);
    if k > MANY {
        return Some(cube);
    }
    // Without the factor e^(-t) of the density the term is above the probability, and its inverse below the quantile.
    let series = 2.0 * ((p.ln() + ln_gamma(k / 2.0 + 1.0)) * 2.0 / k).exp();
    Some(if root > 0.1 { cube.max(series) } else { series })
}

/// Mean and deviation of the cube root of a χ² variable over its degrees of freedom.
fn cube_root(k: f64) -> [f64; 2] {
    let variance = 2.0 / 9.0 / k;
    [1.0 - variance, variance.sqrt()]
}
