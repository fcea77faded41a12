//! `terrace extract`: scans in, planes out.

mod extents;
mod inputs;
mod mesh_file;
mod summary;

use std::path::Path;
use std::time::Instant;

use terrace::{CostForm, Mapper, Optimise, Params, PlaneMap, Search, Stage};
use terrace_draw::Bounds;
use terrace_io::planes_json::Timings;
use terrace_io::{ReadOptions, read_counted, write_labelled_ply, write_labels_npy};

use crate::args::{Cost, SearchMethod};
use crate::error::CliError;
use crate::extract_args::ExtractArgs;
use crate::picture::{TwoSides, write_png};
use crate::progress::Progress;
use crate::report;

use extents::Extents;
use inputs::{Inputs, labelled_points};
pub use inputs::{insert_all, intrinsics, not_measured, read_options, sources};
pub use mesh_file::MeshFile;

/// Runs on a pool of its own, so that `--threads` holds for everything.
pub fn run(args: &ExtractArgs) -> Result<(), CliError> {
    let mut pool = rayon::ThreadPoolBuilder::new();
    if let Some(threads) = args.threads {
        pool = pool.num_threads(threads.into());
    }
    pool.build()?.install(|| extract(args))
}

fn extract(args: &ExtractArgs) -> Result<(), CliError> {
    let start = Instant::now();
    let options = read_options(&args.read)?;
    let mut mapper = Mapper::new(params(args)?)?;
    let sources =
        sources(&args.inputs, args.poses.as_deref(), args.pose_covariances.as_deref(), args.pose_sigma)?;
    let mut progress = Progress::new(args.quiet);
    let mut timings = Timings::default();

    let inputs = insert_all(
        &mut mapper,
        &sources,
        |source| read_counted(source, &options),
        &mut progress,
        &mut timings,
    )?;
    if let Some(warning) = not_measured(inputs.not_measured()) {
        progress.warn(&warning);
    }
    let map = extract_timed(&mapper, &mut progress, &mut timings)?;
    let extents = outline(args, &map, &inputs, &options, &mut progress, &mut timings)?;

    let writing = Instant::now();
    progress.spin("writing");
    write_labels_npy(&args.out.join("labels.npy"), map.labels.iter().copied(), map.labels.len() as u64)?;
    if !args.no_points {
        write_points(&args.out.join("points.ply"), &inputs, &options, &map, &mut progress)?;
    }
    if args.picture {
        write_picture(&args.out.join("planes.png"), &inputs, &options, &map, args.up)?;
    }
    if let Some(extents) = &extents {
        write_extents(extents, args, &mut progress)?;
    }
    timings.write = writing.elapsed().as_secs_f64();
    timings.total = start.elapsed().as_secs_f64();
    let area = |plane| extents.as_ref()?.area(plane);
    report::planes_file(&map, area, inputs.parameters(args), timings).write(&args.out.join("planes.json"))?;
    progress.finish();
    if !args.quiet {
        summary::print(&map, extents.as_ref(), &inputs, args);
    }
    Ok(())
}

fn params(args: &ExtractArgs) -> Result<Params, CliError> {
    let mut params = args.preset.params();
    match (&mut params.regions, args.about_regions(), args.about_clusters()) {
        (Some(_), _, Some(option)) => {
            return Err(CliError::Usage(format!("{option} is about clusters: add --preset clusters")));
        }
        (None, Some(option), _) => {
            return Err(CliError::Usage(format!(
                "{option} is about regions, which --preset {} does not grow",
                args.preset.name()
            )));
        }
        (Some(regions), ..) => {
            regions.join = args.join.map_or(regions.join, Into::into);
            regions.min_points = args.min_points.or(regions.min_points);
            regions.min_area = args.min_area.or(regions.min_area);
            regions.tilt = args.max_tilt.unwrap_or(regions.tilt);
            regions.reach = args.reach.unwrap_or(regions.reach);
            // The model of a sensor leaves out its distortion.
            regions.errors_are_complete = args.read.sensor.is_none();
        }
        (None, None, _) => {}
    }
    params.cell_size = args.cell.or(params.cell_size);
    params.tau = args.tau.or(params.tau);
    params.phi = args.phi.unwrap_or(params.phi);
    params.omega = args.omega.unwrap_or(params.omega);
    params.depth = args.depth.unwrap_or(params.depth);
    params.min_cells = args.min_cells.unwrap_or(params.min_cells);
    params.seed = args.seed;
    if args.no_covariance {
        params.estimate = None;
    }
    if let Some(floor) = args.floor {
        let Some(estimate) = &mut params.estimate else {
            return Err(CliError::Usage(
                "--floor is part of the covariance of planes, which --preset paper does not make".to_owned(),
            ));
        };
        estimate.floor = floor;
    }
    if args.no_optimise {
        params.optimise = None;
    }
    if let Some(cost) = args.cost {
        let form = match cost {
            Cost::Sum => CostForm::Sum,
            Cost::Share => CostForm::Share,
        };
        params.optimise = Some(Optimise { form, ..params.optimise.unwrap_or_default() });
    }
    if let Some(optimise) = &mut params.optimise {
        match args.search {
            Some(SearchMethod::Certified) => optimise.search = Search::default(),
            Some(SearchMethod::Random) => optimise.search = Search::PAPER,
            None => {}
        }
        if let (Search::Certified { evaluations }, Some(most)) = (&mut optimise.search, args.evaluations) {
            *evaluations = most.into();
        }
    }
    Ok(params)
}

/// Extracts the planes, with the time of each stage.
///
/// # Errors
/// [`CliError`] when the map is empty.
pub fn extract_timed(
    mapper: &Mapper,
    progress: &mut Progress,
    timings: &mut Timings,
) -> Result<PlaneMap, CliError> {
    let mut marks = Vec::new();
    let map = mapper.extract_observed(|stage| {
        let what = match stage {
            Stage::Normals { cells } => format!("normals of {cells} cells"),
            Stage::Grow { cells } => format!("growing regions over {cells} cells"),
            Stage::Cluster { cells } => format!("clustering {cells} cells"),
            Stage::Optimise { clusters } => format!("optimising {clusters} uncertain clusters"),
            Stage::Label { points } => format!("labelling {points} points"),
        };
        progress.spin(&what);
        marks.push((stage, Instant::now()));
    })?;
    let ends = marks.iter().skip(1).map(|(_, begin)| *begin).chain([Instant::now()]);
    for ((stage, begin), end) in marks.iter().zip(ends) {
        let slot = match stage {
            Stage::Normals { .. } => &mut timings.normals,
            Stage::Grow { .. } => timings.grow.get_or_insert(0.0),
            Stage::Cluster { .. } => &mut timings.cluster,
            Stage::Optimise { .. } => &mut timings.optimise,
            Stage::Label { .. } => &mut timings.label,
        };
        *slot = (end - *begin).as_secs_f64();
    }
    Ok(map)
}

/// The extents of the planes, when the arguments ask for anything made of them.
fn outline(
    args: &ExtractArgs,
    map: &PlaneMap,
    inputs: &Inputs,
    options: &ReadOptions,
    progress: &mut Progress,
    timings: &mut Timings,
) -> Result<Option<Extents>, CliError> {
    if !args.extent && args.mesh.is_empty() {
        return Ok(None);
    }
    let outlining = Instant::now();
    let extents = Extents::of(map, inputs, options, progress)?;
    timings.extent = Some(outlining.elapsed().as_secs_f64());
    Ok(Some(extents))
}

fn write_extents(extents: &Extents, args: &ExtractArgs, progress: &mut Progress) -> Result<(), CliError> {
    progress.spin("writing extents");
    if args.extent {
        extents.write(&args.out.join("extents.json"))?;
    }
    if !args.mesh.is_empty() {
        let mesh = extents.mesh(progress);
        args.mesh.iter().try_for_each(|file| file.write(&mesh))?;
    }
    Ok(())
}

fn write_points(
    path: &Path,
    inputs: &Inputs,
    options: &ReadOptions,
    map: &PlaneMap,
    progress: &mut Progress,
) -> Result<(), CliError> {
    progress.begin("points.ply", map.labels.len());
    let mut failed = None;
    let points = labelled_points(inputs, options, map, &mut failed);
    let written = write_labelled_ply(path, inputs.extent(), points.inspect(|_| progress.advance(1)));
    failed.map_or(Ok(written?), Err)
}

/// Draws what the planes span, and a tenth around it: single outliers must not shrink the picture.
fn write_picture(
    path: &Path,
    inputs: &Inputs,
    options: &ReadOptions,
    map: &PlaneMap,
    up: [f64; 3],
) -> Result<(), CliError> {
    let mut failed = None;
    let on_planes = labelled_points(inputs, options, map, &mut failed).filter(|p| p.plane.is_some());
    let Some(bounds) = Bounds::of(on_planes.map(|p| p.position)) else {
        return failed.map_or(Ok(()), Err);
    };
    let title = format!("{} planes", map.planes.len());
    let mut picture = TwoSides::new(bounds, up, &title)?;
    for point in labelled_points(inputs, options, map, &mut failed) {
        let inside = (0..3).all(|i| (bounds.min()[i]..=bounds.max()[i]).contains(&point.position[i]));
        if inside {
            picture.add(point.position, point.plane);
        }
    }
    write_png(path, &picture.image()?.png()?)?;
    failed.map_or(Ok(()), Err)
}
