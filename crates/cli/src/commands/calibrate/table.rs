//! What is printed.

use terrace_calibration::{Calibration, Exceedance, table};
use terrace_trials::{Agreement, MAJORITY, Outcome, PURE, PlaneAgreement, Ratio};

/// Rows of single planes at most.
const ROWS: usize = 40;

/// The tables and counts of copies of known planes.
pub fn of_outcome(outcome: &Outcome, cells: bool) -> String {
    let mut rows: Vec<(&str, &Calibration)> = vec![("planes", &outcome.planes), ("mixed", &outcome.mixed)];
    if cells {
        rows.push(("cells", &outcome.cells));
    }
    rows.extend(outcome.by_plane.iter().map(|(name, of)| (name.as_str(), of)));
    let mut text = table(&rows);
    text += &format!("min-max exceeded: planes {}", exceeded(&outcome.plane_bounds));
    if cells {
        let (estimated, fitted) = (exceeded(&outcome.cell_bounds), exceeded(&outcome.fitted_bounds));
        text += &format!("; cells {estimated}; normals that are clustered {fitted}");
    }
    text += &format!(
        "\n{} copies; pure planes have at least {:.0} % of their points on one known plane, mixed ones {:.0} %\n",
        outcome.copies,
        100.0 * PURE,
        100.0 * MAJORITY
    );
    text += &format!(
        "{} planes are no known one, {} without a covariance, {} with residuals above their errors\n",
        outcome.unmatched, outcome.without, outcome.grown
    );
    text
}

fn exceeded(bounds: &Exceedance) -> String {
    bounds.share().map_or("-".to_owned(), |share| {
        format!("{} of {} ({:.1} %)", share.hits(), share.of(), 100.0 * share.value())
    })
}

/// The tables and counts of scans held against each other, a name for each run.
pub fn of_agreements(runs: &[(String, Agreement)]) -> String {
    let rows: Vec<(&str, &Calibration)> =
        runs.iter().map(|(name, agreement)| (name.as_str(), &agreement.all)).collect();
    let mut text = table(&rows);
    for (name, agreement) in runs {
        text += &format!("\n{name}: {}\n", ratios(&agreement.all));
        if let (Some(reduced), Some([low, high])) =
            (agreement.scatter.reduced(), agreement.scatter.band(0.95))
        {
            text += &format!(
                "scatter of the scans about their means {} per degree of freedom (95 % band {low:.3} to {high:.3})\n",
                number(reduced)
            );
        }
        text += &of_planes(&agreement.planes);
        text += &format!(
            "{} planes are seen too seldom; of scans, {} planes are no plane of all scans, {} a second one on the \
             same, {} turned far from it, {} without a covariance\n",
            agreement.seldom, agreement.unmatched, agreement.lesser, agreement.turned, agreement.without
        );
    }
    text
}

fn ratios(calibration: &Calibration) -> String {
    Ratio::of(calibration).map_or("no plane is seen by enough scans".to_owned(), |ratio| {
        format!(
            "errors are {} times as large as predicted, by medians {}",
            number(ratio.rms),
            number(ratio.median)
        )
    })
}

fn of_planes(planes: &[PlaneAgreement]) -> String {
    let mut text = String::from(
        "plane      points  scans    NEES/D     ratio  by median  scatter  tilt deg  predicted  height mm  predicted  \
         apart m  grown\n",
    );
    for plane in planes.iter().take(ROWS) {
        let ratio = Ratio::of(&plane.calibration);
        let show = |value: Option<f64>| value.map_or("-".to_owned(), number);
        let median = |of: fn(&terrace_trials::Residual) -> f64| {
            let mut values: Vec<f64> = plane.residuals.iter().map(of).collect();
            values.sort_by(f64::total_cmp);
            values.get(values.len() / 2).copied()
        };
        let tilt = median(|r| r.difference[0].hypot(r.difference[1]).to_degrees());
        let tilt_predicted = median(|r| r.predicted[0].hypot(r.predicted[1]).to_degrees());
        let height = median(|r| 1e3 * r.difference[2].abs());
        let height_predicted = median(|r| 1e3 * r.predicted[2]);
        text += &format!(
            "{:>5} {:>11} {:>6} {:>9} {:>9} {:>10} {:>8} {:>9} {:>10} {:>10} {:>10} {:>8} {:>6}\n",
            plane.id,
            plane.points,
            plane.residuals.len(),
            show(plane.calibration.nees()),
            show(ratio.map(|r| r.rms)),
            show(ratio.map(|r| r.median)),
            show(plane.scatter.reduced()),
            show(tilt),
            show(tilt_predicted),
            show(height),
            show(height_predicted),
            show(median(|r| r.distance)),
            plane.residuals.iter().filter(|r| r.growth > 1.0).count(),
        );
    }
    if planes.len() > ROWS {
        text += &format!("  ... and {} more in calibrate.json\n", planes.len() - ROWS);
    }
    text
}

/// Four digits or so.
fn number(value: f64) -> String {
    match value.abs() {
        large if large >= 1e5 => format!("{value:.2e}"),
        large if large >= 100.0 => format!("{value:.0}"),
        large if large >= 10.0 => format!("{value:.1}"),
        large if large >= 0.1 => format!("{value:.3}"),
        _ => format!("{value:.4}"),
    }
}
