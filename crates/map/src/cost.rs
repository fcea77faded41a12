//! The cost β of a threshold φ (section V).

use terrace_cluster::{Grower, Interval, Segmentation};
use terrace_crs::{Cost, Evaluation};

/// How the uncertainties of the clusters are summed up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum CostForm {
    /// Each cluster once, as the formula is printed: `Σᵢ (s_x + s_y + s_z)ᵢ`. It grows with every cluster, so that a
    /// cluster of many planes is hardly ever split.
    Sum,
    /// Each cluster by its share of the cells: `Σᵢ (nᵢ/n) (s_x + s_y + s_z)ᵢ`. It falls as clusters become purer,
    /// which is what the paper says of its first term.
    #[default]
    Share,
}

/// Bits of β's mantissa that are left out.
const ROUNDED_BITS: u32 = 22;

/// `β = w_nv Σᵢ fᵢ (s_x + s_y + s_z)ᵢ + w_nc N_c`, with fᵢ = 1 or nᵢ/n by the [`CostForm`].
///
/// Rounded to 30 binary digits after the first, about 1e-9 of its size: the same clusters may be grown in another order,
/// which changes their sums in the last digits, and a search must not take that for a lower cost.
pub fn beta(
    segmentation: &Segmentation,
    form: CostForm,
    weight_uncertainty: f64,
    weight_clusters: f64,
) -> f64 {
    let cells: usize = segmentation.clusters().map(|c| c.nodes().len()).sum();
    let uncertainty: f64 = segmentation
        .clusters()
        .map(|cluster| {
            let total: f64 = cluster.uncertainty().iter().sum();
            match form {
                CostForm::Sum => total,
                CostForm::Share => total * cluster.nodes().len() as f64 / cells as f64,
            }
        })
        .sum();
    rounded(weight_uncertainty * uncertainty + weight_clusters * segmentation.len() as f64)
}

/// To the nearest number with fewer digits; 0, infinities and NaN are as they were.
fn rounded(value: f64) -> f64 {
    let half = 1 << (ROUNDED_BITS - 1);
    // A carry out of the mantissa rightly raises the exponent.
    f64::from_bits((value.to_bits() + half) >> ROUNDED_BITS << ROUNDED_BITS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[allow(clippy::float_cmp, reason = "the values are exact")]
    fn rounding_leaves_a_billionth() {
        for same in [0.0, 1.0, 0.5, 3.0, f64::INFINITY] {
            assert_eq!(rounded(same), same);
            assert_eq!(rounded(same * (1.0 + 1e-14)), same);
            assert_eq!(rounded(same * (1.0 - 1e-14)), same);
        }
        assert!(rounded(f64::NAN).is_nan());
        let mut value = 1e-300;
        while value < 1e300 {
            assert!((rounded(value) / value - 1.0).abs() < 1e-9);
            value *= 1.37;
        }
    }
}

/// β as a function of φ for the cells of one cluster: a staircase of one axis that knows its steps.
#[derive(Debug)]
pub struct PhiCost<'n, N> {
    grower: Grower<'n, N>,
    form: CostForm,
    weight_uncertainty: f64,
    weight_clusters: f64,
    interval: Interval,
}

impl<'n, N> PhiCost<'n, N> {
    /// The cost of clustering with this grower.
    pub fn new(grower: Grower<'n, N>, form: CostForm, weight_uncertainty: f64, weight_clusters: f64) -> Self {
        Self { grower, form, weight_uncertainty, weight_clusters, interval: Interval::ALL }
    }

    /// The step of the last evaluation.
    pub fn interval(&self) -> Interval {
        self.interval
    }

    /// The grower, for the clusters at the φ that was chosen.
    pub fn into_grower(self) -> Grower<'n, N> {
        self.grower
    }
}

impl<'g, N: Fn(usize) -> &'g [u32]> Cost for PhiCost<'_, N> {
    fn evaluate(&mut self, x: &[f64]) -> Evaluation {
        let [phi] = x else { return Evaluation::point(f64::NAN) };
        // A negative or non-finite φ has no cost; the search reports such an answer with its x.
        let Ok(segmentation) = self.grower.grow(*phi) else { return Evaluation::point(f64::NAN) };
        let interval = segmentation.interval();
        self.interval = interval;
        let value = beta(segmentation, self.form, self.weight_uncertainty, self.weight_clusters);
        Evaluation::interval(value, interval.lo..interval.hi.unwrap_or(f64::INFINITY))
    }

    fn dimension(&self) -> Option<usize> {
        Some(1)
    }
}
