//! Calibrations as lines of text.

use std::fmt;

use crate::calibration::{Calibration, LEVELS};
use crate::share::Share;

/// What is usually stated of a calibration, to be printed on one line.
///
/// `Display` writes one line without a name's padding; [`table`] aligns several below a heading.
///
/// ```
/// use terrace_calibration::{Calibration, Summary};
///
/// let mut found = Calibration::new(3)?;
/// found.extend([1.0, 2.0, 9.0]);
/// let line = Summary::new("walls", &found).to_string();
/// assert_eq!(line, "walls: n 3, NEES/D 1.333 (95 % band 0.300 to 2.114), \
///     within 50 % 0.667, 68 % 0.667, 95 % 0.667, 99 % 1.000");
/// # Ok::<(), terrace_calibration::CalibrationError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Summary {
    /// What was calibrated.
    pub name: String,
    /// [`Calibration::count`].
    pub count: usize,
    /// [`Calibration::refused`].
    pub refused: usize,
    /// [`Calibration::nees`].
    pub nees: Option<f64>,
    /// [`Calibration::nees_band`] at 95 %.
    pub band: Option<[f64; 2]>,
    /// [`Calibration::coverage`] at [`LEVELS`].
    pub coverage: [Option<Share>; 4],
}

impl Summary {
    /// What is to be told of a calibration.
    pub fn new(name: &str, calibration: &Calibration) -> Self {
        Self {
            name: name.to_owned(),
            count: calibration.count(),
            refused: calibration.refused(),
            nees: calibration.nees(),
            band: calibration.nees_band(0.95),
            coverage: LEVELS.map(|level| calibration.coverage(level)),
        }
    }

    fn cells(&self) -> Vec<String> {
        let band = |end: fn([f64; 2]) -> f64| number(self.band.map(end));
        let mut cells = vec![
            self.name.clone(),
            self.count.to_string(),
            number(self.nees),
            band(|[low, _]| low),
            band(|[_, high]| high),
        ];
        cells.extend(self.coverage.iter().map(|share| number(share.map(Share::value))));
        cells.push(self.refused.to_string());
        cells
    }
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, count, .. } = self;
        write!(f, "{name}: n {count}, NEES/D {}", number(self.nees))?;
        if let Some([low, high]) = self.band {
            write!(f, " (95 % band {low:.3} to {high:.3})")?;
        }
        for (k, (level, share)) in LEVELS.iter().zip(&self.coverage).enumerate() {
            let before = if k == 0 { ", within" } else { "," };
            write!(f, "{before} {:.0} % {}", level * 100.0, number(share.map(Share::value)))?;
        }
        if self.refused > 0 {
            write!(f, ", refused {}", self.refused)?;
        }
        Ok(())
    }
}

/// A table of calibrations, one line each below a heading, columns aligned: name, number of values, NEES per degree of
/// freedom, ends of its 95 % band, shares of errors within the regions of [`LEVELS`], and how many values were refused.
/// What has no value is a dash. Every line ends with a line break.
///
/// ```
/// use terrace_calibration::{Calibration, table};
///
/// let (mut floor, mut walls) = (Calibration::new(3)?, Calibration::new(3)?);
/// floor.extend([1.0, 2.0, 9.0, 4.0]);
/// walls.extend([120.0]);
/// assert_eq!(table(&[("floor", &floor), ("walls", &walls)]), "\
/// name   n  NEES/D    low   high   50 %   68 %   95 %   99 %  refused
/// floor  4   1.333  0.367  1.945  0.500  0.500  0.750  1.000        0
/// walls  1  40.000  0.072  3.116  0.000  0.000  0.000  0.000        0
/// ");
/// # Ok::<(), terrace_calibration::CalibrationError>(())
/// ```
pub fn table(calibrations: &[(&str, &Calibration)]) -> String {
    let mut heading: Vec<String> = ["name", "n", "NEES/D", "low", "high"].map(str::to_owned).to_vec();
    heading.extend(LEVELS.map(|level| format!("{:.0} %", level * 100.0)));
    heading.push("refused".to_owned());
    let mut rows = vec![heading];
    rows.extend(calibrations.iter().map(|(name, calibration)| Summary::new(name, calibration).cells()));
    let mut widths: Vec<usize> = Vec::new();
    for row in &rows {
        widths.resize(widths.len().max(row.len()), 0);
        for (width, cell) in widths.iter_mut().zip(row) {
            *width = (*width).max(cell.chars().count());
        }
    }
    let mut out = String::new();
    for row in &rows {
        for (column, (cell, width)) in row.iter().zip(&widths).enumerate() {
            out += &if column == 0 { format!("{cell:<width$}") } else { format!("  {cell:>width$}") };
        }
        out.push('\n');
    }
    out
}

/// Three decimals, or a dash for what has no value; very large numbers by their power of ten.
fn number(value: Option<f64>) -> String {
    match value {
        None => "-".to_owned(),
        Some(value) if value.abs() >= 1e6 => format!("{value:.3e}"),
        Some(value) => format!("{value:.3}"),
    }
}
