//! Axes: from numbers to places on the sheet, with round ticks.

/// A range of numbers laid along a stretch of the sheet.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Axis {
    low: f64,
    high: f64,
    /// Places of `low` and `high` on the sheet.
    from: f64,
    to: f64,
}

impl Axis {
    /// Both ends finite and `low` not above `high`. A range too narrow for its numbers to differ is widened.
    pub(crate) fn new(low: f64, high: f64, from: f64, to: f64) -> Self {
        let magnitude = low.abs().max(high.abs());
        let (low, high) =
            if high / 2.0 - low / 2.0 > magnitude * 1e-12 && high - low > f64::MIN_POSITIVE * 1e3 {
                (low, high)
            } else if magnitude > f64::MIN_POSITIVE * 1e6 {
                // A tenth to each side, held within the numbers there are.
                ((low - magnitude * 0.1).max(-f64::MAX), (high + magnitude * 0.1).min(f64::MAX))
            } else {
                (-1.0, 1.0)
            };
        Self { low, high, from, to }
    }

    /// The place of a value, held within the axis; halves keep the widest ranges from overflowing.
    pub(crate) fn place(&self, value: f64) -> f64 {
        let share = (value / 2.0 - self.low / 2.0) / (self.high / 2.0 - self.low / 2.0);
        self.from + share.clamp(0.0, 1.0) * (self.to - self.from)
    }

    /// At most `most` round numbers within the range with their labels: multiples of 1, 2 or 5 times a power of ten.
    pub(crate) fn ticks(&self, most: usize) -> Vec<(f64, String)> {
        let most = most.clamp(2, 20);
        let half_range = self.high / 2.0 - self.low / 2.0;
        let least = half_range / (most as f64 / 2.0);
        let power = 10_f64.powf(least.log10().floor());
        let Some(step) =
            [1.0, 2.0, 5.0, 10.0].map(|m| m * power).into_iter().find(|s| *s >= least * (1.0 - 1e-9))
        else {
            return Vec::new();
        };
        if !step.is_normal() {
            return Vec::new();
        }
        let first = (self.low / step - 1e-6).ceil();
        (0..=most)
            .map(|k| (first + k as f64) * step)
            .filter(|value| value.is_finite() && *value / 2.0 <= self.high / 2.0 + step * 1e-6)
            .map(|value| (value, label(value, step)))
            .collect()
    }
}

/// A tick as short as its step allows.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 0 to 5")]
fn label(value: f64, step: f64) -> String {
    let value = if value.abs() < step * 1e-6 { 0.0 } else { value };
    if !(1e-4..1e6).contains(&value.abs().max(step)) {
        if value == 0.0 {
            return "0".to_owned();
        }
        // Two digits beyond the step's place tell neighbours apart.
        let digits = (value.abs() / step).log10().ceil().clamp(0.0, 5.0) as usize;
        return format!("{value:.digits$e}");
    }
    let decimals = (-step.log10().floor()).clamp(0.0, 5.0) as usize;
    format!("{value:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(low: f64, high: f64) -> Vec<String> {
        Axis::new(low, high, 0.0, 100.0).ticks(6).into_iter().map(|(_, label)| label).collect()
    }

    #[test]
    fn ticks_are_round() {
        assert_eq!(labels(0.0, 1.0), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(labels(-3.0, 11.0), ["0", "5", "10"]);
        assert_eq!(labels(0.0, 3e-9), ["0", "5e-10", "1.0e-9", "1.5e-9", "2.0e-9", "2.5e-9", "3.0e-9"]);
        assert_eq!(labels(0.12, 0.121), ["0.1200", "0.1202", "0.1204", "0.1206", "0.1208", "0.1210"]);
    }

    #[test]
    fn extreme_ranges_keep_their_places_on_the_sheet() {
        for (low, high) in [
            (5.0, 5.0),
            (0.0, 0.0),
            (-1e300, 1e300),
            (0.0, 1e-300),
            (f64::MAX, f64::MAX),
            (-f64::MAX, f64::MAX),
        ] {
            let axis = Axis::new(low, high, 10.0, 20.0);
            for value in [low, high, low / 2.0 + high / 2.0] {
                assert!((10.0..=20.0).contains(&axis.place(value)), "{low} {high} {value}");
            }
            for (value, _) in axis.ticks(6) {
                assert!((10.0..=20.0).contains(&axis.place(value)));
            }
        }
    }
}
