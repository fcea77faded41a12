//! Distances against expected ones, as pictures.

use std::path::Path;

use terrace_calibration::Calibration;
use terrace_draw::{QqPlot, QqSeries};
use terrace_io::write_atomically;

use crate::error::CliError;
use crate::picture::write_png;

/// Points of a series.
const POINTS: usize = 500;
/// Width and height in pixels.
const SIZE: [usize; 2] = [1200, 800];

/// Writes `qq.png` and `qq.svg`.
pub fn write(folder: &Path, title: &str, series: &[(&str, &Calibration)]) -> Result<(), CliError> {
    let of = |(name, calibration): &(&str, &Calibration)| QqSeries {
        name: (*name).to_owned(),
        points: calibration.quantiles(POINTS),
    };
    let chart =
        QqPlot { title: title.to_owned(), series: series.iter().map(of).collect(), ..QqPlot::default() };
    let [width, height] = SIZE;
    write_png(&folder.join("qq.png"), &chart.png(width, height)?)?;
    let svg = chart.svg(width, height)?;
    write_atomically(&folder.join("qq.svg"), |out| Ok(out.write_all(svg.as_bytes())?))?;
    Ok(())
}
