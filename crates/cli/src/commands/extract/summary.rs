//! What `extract` prints at its end.

use std::path::Path;

use terrace::{ExtractedPlane, NoiseKnot, NoiseLevel, PlaneMap};

use super::Extents;
use crate::report::tilt_offset;

/// Rows of the table.
const ROWS: usize = 20;

/// What the planes were found in, and where they are written.
pub struct Told<'a> {
    /// As in "3 of 3 inputs used".
    pub from: String,
    pub errors_known: bool,
    pub written: Vec<&'a Path>,
}

/// Tells people what was found, and how sure it is.
pub fn print(map: &PlaneMap, extents: Option<&Extents>, told: &Told) {
    let summary = map.summary();
    out!("{}", table(map, extents));
    outln!(
        "{} planes, {} of {} points labelled, {}; cells of {:.4} m, tau {}",
        summary.planes,
        summary.labelled,
        summary.points,
        told.from,
        map.used.cell_size,
        map.used.tau,
    );
    match &map.noise {
        Some(noise) => outln!("{}", found(noise)),
        None if told.errors_known => {}
        None => outln!(
            "standard errors of the points are unknown (--sigma, --sensor){}: uncertainties rest on their scatter",
            // With the default preset they are looked for, so there was nothing to find them from.
            if map.used.params.estimate.is_some() { " and no flat place shows any" } else { "" },
        ),
    }
    let written: Vec<_> = told.written.iter().map(|path| path.display().to_string()).collect();
    outln!("written to {}", written.join(", "));
}

/// The largest planes. How sure they are, and their areas, are left out where that was not asked for.
fn table(map: &PlaneMap, extents: Option<&Extents>) -> String {
    let asked = map.used.params.estimate.is_some();
    let how_sure = if asked { " tilt deg   off mm " } else { "" };
    let areas = if extents.is_some() { "   area m2" } else { "" };
    let clustered = map.planes.iter().any(|plane| plane.phi.is_some());
    let phi = if clustered { "    phi" } else { "" };
    let mut text = format!(
        "  id    points   cells{areas}        a        b        c          d    s_x    s_y    s_z  rms mm{how_sure}{phi}\n",
    );
    let shown = || map.planes.iter().take(ROWS);
    for plane in shown() {
        let [a, b, c, d] = plane.plane.coefficients();
        text += &format!(
            "{:>4} {:>9} {:>7}{} {a:>8.4} {b:>8.4} {c:>8.4} {d:>10.4}{} {:>7.2}{}{}\n",
            plane.id.get(),
            plane.points,
            plane.cells,
            extents.map_or_else(String::new, |extents| area(extents, plane)),
            plane.normal_uncertainty.map_or_else(
                || "      -      -      -".to_owned(),
                |[x, y, z]| format!("  {x:.3}  {y:.3}  {z:.3}"),
            ),
            1000.0 * plane.rms,
            if asked { uncertainty(plane) } else { String::new() },
            plane.phi.map_or_else(String::new, |phi| format!("  {phi:.3}")),
        );
    }
    if map.planes.len() > ROWS {
        text += &format!("  ... and {} more in planes.json\n", map.planes.len() - ROWS);
    }
    if shown().any(|plane| plane.estimate.is_some()) {
        text += "tilt, off: standard errors of the orientation, where it is least sure, and of the offset at the centroid\n";
        if shown().any(has_grown) {
            text += "*: residuals are larger than the errors say; tilt and off are raised to match\n";
        }
        if shown().any(|plane| plane.estimate.is_none()) {
            text += "-: no flat part is large enough to tell\n";
        }
    }
    text
}

fn has_grown(plane: &ExtractedPlane) -> bool {
    plane.estimate.is_some_and(|estimate| estimate.growth > 1.0)
}

fn uncertainty(plane: &ExtractedPlane) -> String {
    plane.estimate.map_or_else(
        || format!(" {:>8} {:>8} ", "-", "-"),
        |estimate| {
            let covariance = tilt_offset(&estimate);
            let (tilt, offset) = (covariance.largest_tilt().to_degrees(), 1000.0 * covariance.offset());
            format!(" {tilt:>8.3} {offset:>8.3}{}", if has_grown(plane) { "*" } else { " " })
        },
    )
}

fn area(extents: &Extents, plane: &ExtractedPlane) -> String {
    extents.area(plane.id).map_or_else(|| format!(" {:>9}", "-"), |area| format!(" {area:>9.3}"))
}

/// The errors that the residuals show, in a sentence.
fn found(noise: &NoiseLevel) -> String {
    let mm = |metres: f64| format!("{:.2} mm", 1000.0 * metres);
    let level = match (noise.knots.first(), noise.knots.last()) {
        (
            Some(NoiseKnot { range: Some(from), along: low, across }),
            Some(NoiseKnot { range: Some(to), along: high, across: across_high }),
        ) if from < to => format!(
            "{} at {from:.1} m to {} at {to:.1} m along rays, {} to {} across",
            mm(*low),
            mm(*high),
            mm(*across),
            mm(*across_high)
        ),
        (Some(NoiseKnot { range: Some(range), along, across }), _) => {
            format!("{} along rays and {} across at {range:.1} m", mm(*along), mm(*across))
        }
        _ => mm(noise.at(None).0),
    };
    format!(
        "standard errors of the points are not given (--sigma, --sensor); found from the residuals of {} flat places:\n  {level}",
        noise.places
    )
}
