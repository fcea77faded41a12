//! `terrace extract`: scans in, planes out.
//!
//! The inputs are read twice, in chunks: for the planes, and then for the label of each point. Memory grows with the cells that hold a
//! point, not with the points.

mod again;
mod chunks;
mod extents;
mod first_pass;
mod image;
mod inputs;
mod mesh_file;
mod params;
#[cfg(feature = "parquet")]
mod saved_map;
mod stages;
mod summary;

use std::path::Path;
use std::time::Instant;

use terrace::{Mapper, PlaneMap};
use terrace_draw::Bounds;
use terrace_io::planes_json::Timings;
use terrace_io::{LabelsWriter, PlyWriter};

use crate::error::CliError;
use crate::extract_args::ExtractArgs;
use crate::picture::{TwoSides, write_png};
use crate::progress::Progress;
use crate::report;

use again::{Again, Labelled, labelled};
pub use chunks::Reading;
use extents::Extents;
pub use first_pass::insert_all;
use image::Lone;
pub use inputs::{intrinsics, not_measured, read_options, sources};
pub use mesh_file::MeshFile;
#[cfg(feature = "parquet")]
pub use params::change;
use params::params;
#[cfg(feature = "parquet")]
pub use saved_map::save_map;
pub use stages::extract_timed;
pub use summary::{Told, print as print_summary};

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
    let mut mapper = mapper(args)?;
    let sources =
        sources(&args.inputs, args.poses.as_deref(), args.pose_covariances.as_deref(), args.pose_sigma)?;
    let mut progress = Progress::new(args.quiet);
    let mut timings = Timings::default();
    if let Some(image) = Lone::of(args, &sources, &options) {
        return image.extract(args, &options, &mut progress, (start, timings));
    }

    let reading = Reading::with(&options);
    let with_extent = !args.no_points || args.extent || !args.mesh.is_empty();
    let inputs = insert_all(&mut mapper, &sources, reading, with_extent, &mut progress, &mut timings)?;
    if let Some(warning) = not_measured(inputs.not_measured()) {
        progress.warn(&warning);
    }
    #[cfg(feature = "parquet")]
    if let Some(file) = &args.save_map {
        save_map(&mapper, file, &mut progress, &mut timings)?;
    }
    let extract = |begins: &mut dyn FnMut(_)| mapper.into_streamed(begins);
    let (mut map, mut labels) = extract_timed(extract, &mut progress, &mut timings)?;

    let mut again = Again { inputs: &inputs, reading: reading.bare(), labels: &mut labels };
    let (points, bounds) = label(args, &mut again, &mut progress, &mut timings)?;
    again.labels.finish(&mut map);
    let extents = outline(args, &map, &mut again, &mut progress, &mut timings)?;
    let writing = Instant::now();
    if let Some(bounds) = bounds.filter(|_| args.picture) {
        write_picture(&args.out.join("planes.png"), bounds, &map, &mut again, args.up, &mut progress)?;
    }
    progress.spin("writing");
    points.finish()?;
    if let Some(extents) = &extents {
        write_extents(extents, args, &mut progress)?;
    }
    timings.write += writing.elapsed().as_secs_f64();
    timings.total = start.elapsed().as_secs_f64();
    let area = |plane| extents.as_ref()?.area(plane);
    report::planes_file(&map, area, inputs.parameters(args), timings).write(&args.out.join("planes.json"))?;
    progress.finish();
    if !args.quiet {
        let used = inputs.used();
        let mut written = vec![args.out.as_path()];
        written.extend(args.mesh.iter().map(MeshFile::path));
        #[cfg(feature = "parquet")]
        written.extend(args.save_map.as_deref());
        let from = format!("{used} of {} inputs used", used + inputs.skipped());
        print_summary(&map, extents.as_ref(), &Told { from, errors_known: inputs.errors_known(), written });
    }
    Ok(())
}

/// One that forgets points, where they can be told again by where they are.
fn mapper(args: &ExtractArgs) -> Result<Mapper, CliError> {
    let params = params(args)?;
    #[cfg(feature = "parquet")]
    if args.save_map.is_some() && !params.by_place() {
        return Err(CliError::Usage(format!(
            "--save-map: the cells of --preset {} depend on the order of points and do not add up to a map",
            args.preset.name()
        )));
    }
    if !params.by_place() {
        return Ok(Mapper::new(params)?);
    }
    let mapper = Mapper::streaming(params)?;
    #[cfg(feature = "parquet")]
    if args.save_map.is_some() {
        return Ok(mapper);
    }
    // Planes are turned to the sensors when points are labelled.
    Ok(mapper.spare_sightings())
}

/// Labels all points into files that have no name yet, and tells what the planes span.
fn label(
    args: &ExtractArgs,
    again: &mut Again,
    progress: &mut Progress,
    timings: &mut Timings,
) -> Result<(Labelled, Option<Bounds>), CliError> {
    let labels = LabelsWriter::create(&args.out.join("labels.npy"), again.inputs.points() as u64)?;
    let coloured = |extent| PlyWriter::create(&args.out.join("points.ply"), extent);
    let points = again.inputs.extent().filter(|_| !args.no_points).map(coloured).transpose()?;
    let mut written = Labelled { labels, points };
    let mut bounds: Option<Bounds> = None;
    let mut seconds = 0.0;
    again.read("labelling", progress, timings, |scan, labels| {
        let writing = Instant::now();
        written.push(scan, labels)?;
        if args.picture {
            let on_planes = labelled(scan, labels).filter(|p| p.plane.is_some()).map(|p| p.position);
            let before = bounds.iter().flat_map(|bounds| [bounds.min(), bounds.max()]);
            bounds = Bounds::of(before.chain(on_planes));
        }
        seconds += writing.elapsed().as_secs_f64();
        Ok(())
    })?;
    timings.write += seconds;
    Ok((written, bounds))
}

/// The extents of the planes, when the arguments ask for anything made of them.
fn outline(
    args: &ExtractArgs,
    map: &PlaneMap,
    again: &mut Again,
    progress: &mut Progress,
    timings: &mut Timings,
) -> Result<Option<Extents>, CliError> {
    if !args.extent && args.mesh.is_empty() {
        return Ok(None);
    }
    let outlining = Instant::now();
    let extents = Extents::of(map, again, progress)?;
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

/// Draws what the planes span: single outliers must not shrink the picture.
fn write_picture(
    path: &Path,
    bounds: Bounds,
    map: &PlaneMap,
    again: &mut Again,
    up: [f64; 3],
    progress: &mut Progress,
) -> Result<(), CliError> {
    let title = format!("{} planes", map.planes.len());
    let mut picture = TwoSides::new(bounds, up, &title)?;
    again.read("planes.png", progress, &mut Timings::default(), |scan, labels| {
        for point in labelled(scan, labels) {
            let inside = (0..3).all(|i| (bounds.min()[i]..=bounds.max()[i]).contains(&point.position[i]));
            if inside {
                picture.add(point.position, point.plane);
            }
        }
        Ok(())
    })?;
    Ok(write_png(path, &picture.image()?.png()?)?)
}
