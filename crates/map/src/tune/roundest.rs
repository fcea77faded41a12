//! Numbers with few digits.

/// The middle of `[lo, hi)` with as few decimals as keep it in the inner half; `at`, a number of it, when none does.
///
/// A search likes to ask at the ends of steps, where a threshold written with fewer digits falls on the other side.
pub(crate) fn roundest(lo: f64, hi: f64, at: f64) -> f64 {
    let (middle, quarter) = (f64::midpoint(lo, hi), (hi - lo) / 4.0);
    let inner = lo + quarter..=hi - quarter;
    (0..=17)
        .filter_map(|decimals| format!("{middle:.decimals$}").parse().ok())
        .find(|short| (lo..hi).contains(short) && inner.contains(short))
        .unwrap_or(at)
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "the values are exact")]
mod tests {
    use super::*;

    #[test]
    fn few_digits_inside() {
        assert_eq!(roundest(0.1234, 0.1301, 0.1234), 0.127);
        assert_eq!(roundest(0.12, 0.121, 0.12), 0.1205);
        assert_eq!(roundest(0.0, 1.0_f64.next_up(), 0.3), 0.5);
        assert_eq!(roundest(0.2, 0.9, 0.3), 0.6);
        let narrow = 1e-30;
        assert_eq!(roundest(narrow, narrow.next_up(), narrow), narrow);
        assert_eq!(roundest(0.3, 0.3_f64.next_up(), 0.3), 0.3);
        for (lo, hi) in [(0.0, 0.0_f64.next_up()), (0.7, 0.700_000_000_1), (0.0, 0.001)] {
            assert!((lo..hi).contains(&roundest(lo, hi, lo)));
        }
    }
}
