//! Section VI-B: a posed Kinect sequence.

use std::path::Path;

use terrace::{Frame, Mapper, Params, PlaneMap, Scan, Sigma};
use terrace_draw::Bounds;
use terrace_io::planes_json::Timings;
use terrace_io::{ErrorSource, FieldChoice, ReadError, ReadErrorKind, ReadOptions, Source, find_sources};
use terrace_noise::{Kinect, SensorNoise};

use super::runs::{row, run as run_all};
use crate::args::ReproduceArgs;
use crate::commands::extract::{Reading, insert_all, intrinsics};
use crate::error::CliError;
use crate::picture::{TwoSides, write_png};
use crate::progress::Progress;

/// Clusters the whole sequence and prints Table II.
pub fn run(args: &ReproduceArgs, data: &Path) -> Result<(), CliError> {
    let params = Params {
        cell_size: Some(0.06),
        tau: Some(20),
        omega: 0.2,
        phi: 0.3,
        min_cells: 5,
        seed: args.seed,
        ..Params::paper()
    };
    let options = ReadOptions {
        intrinsics: Some(intrinsics(&args.intrinsics)?),
        errors: ErrorSource::FromFile(FieldChoice::Ignore),
        ..ReadOptions::default()
    };
    let sources = find_sources(&[data], None)?;
    let mut progress = Progress::new(args.quiet);
    let runs = run_all(params, |mapper: &mut Mapper| {
        let reading = Reading { change: &with_axial_errors, ..Reading::with(&options) };
        insert_all(mapper, &sources, reading, false, &mut progress, &mut Timings::default()).map(|_| ())
    })?;
    progress.finish();

    outln!("Section VI-B: {} posed scans, initial phi {}\n", sources.len(), params.phi);
    outln!("Table II                              s_x    s_y    s_z  clusters");
    out!("{}", row("without optimisation", &runs.without));
    out!("{}", row("with optimisation, share", &runs.share));
    out!("{}", row("with optimisation, sum as printed", &runs.sum));
    for (name, after) in [("share", &runs.share), ("sum", &runs.sum)] {
        let means = (runs.without.summary().normal_uncertainty_mean, after.summary().normal_uncertainty_mean);
        if let (Some(before), Some(after)) = means {
            let ratio = [0, 1, 2].map(|axis| format!("{:.2}", after[axis] / before[axis]));
            outln!("  with over without, {name:<5}              {}", ratio.join("   "));
        }
    }
    let clusters: usize = runs.share.optimised.len();
    outln!("  {clusters} uncertain clusters were optimised");
    for (name, title, map) in
        [("fig3.png", "without optimisation", &runs.without), ("fig4.png", "with optimisation", &runs.share)]
    {
        draw(&args.out.join(name), title, map)?;
    }
    outln!("figures: {0}/fig3.png, {0}/fig4.png\n", args.out.display());
    Ok(())
}

/// A depth image with the errors that the paper takes: one σ for all axes, here the Kinect's along its optical axis, at
/// an incidence that is not known.
fn with_axial_errors(source: &Source, scan: Scan) -> Result<Scan, ReadError> {
    let refused = |kind| ReadError { path: source.path.clone(), kind: Box::new(kind) };
    let kinect = Kinect::default();
    if let Frame::World { .. } = scan.frame() {
        return Err(refused(ReadErrorKind::NoSensorPosition { noise: SensorNoise::Kinect(kinect) }));
    }
    let sigma = |point: &[f64; 3]| kinect.axial(point[2], None).unwrap_or(f64::NAN);
    let sigmas = Sigma::PerPoint(scan.points().iter().map(sigma).collect());
    scan.with_sigma(sigmas).map_err(|error| refused(ReadErrorKind::Scan(error.into())))
}

/// Draws the cells, as the paper does. Up is against the camera's y axis of the first frame.
fn draw(path: &Path, title: &str, map: &PlaneMap) -> Result<(), CliError> {
    let of_planes = map.cells.iter().filter(|cell| cell.plane.is_some());
    let Some(bounds) = Bounds::of(of_planes.map(|cell| cell.centroid)) else { return Ok(()) };
    let mut picture = TwoSides::new(bounds, [0.0, -1.0, 0.0], title)?;
    for cell in &map.cells {
        picture.add(cell.centroid, cell.plane);
    }
    write_png(path, &picture.image()?.png()?)?;
    Ok(())
}
