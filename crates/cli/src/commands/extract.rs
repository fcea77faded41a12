//! `terrace extract`: scans in, planes out.

use std::path::Path;
use std::time::Instant;

use rayon::prelude::*;
use serde_json::{Map, Value, json};
use terrace::{CostForm, Inserted, Mapper, Optimise, Params, PlaneId, PlaneMap, Scan, Search, Sigma, Stage};
use terrace_draw::Bounds;
use terrace_io::planes_json::Timings;
use terrace_io::{
    ErrorSource, FieldChoice, Intrinsics, LabelledPoint, NoiseModel, PlyExtent, ReadOptions, Source,
    find_sources, read_scan, write_labelled_ply, write_labels_npy,
};

use crate::args::{Cost, ExtractArgs, Preset, ReadArgs, SearchMethod, Sensor};
use crate::error::CliError;
use crate::picture::{TwoSides, write_png};
use crate::progress::Progress;
use crate::report;

/// Rows of the table printed at the end.
const ROWS: usize = 20;

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
    let mut mapper = Mapper::new(params(args))?;
    let sources = find_sources(&args.inputs, args.poses.as_deref())?;
    let mut progress = Progress::new(args.quiet);
    let mut timings = Timings::default();

    let inputs = insert_all(&mut mapper, &sources, &options, &mut progress, &mut timings)?;
    let map = extract_timed(&mapper, &mut progress, &mut timings)?;

    let writing = Instant::now();
    progress.spin("writing");
    write_labels_npy(&args.out.join("labels.npy"), map.labels.iter().copied(), map.labels.len() as u64)?;
    if !args.no_points {
        write_points(&args.out.join("points.ply"), &inputs, &options, &map, &mut progress)?;
    }
    if args.picture {
        write_picture(&args.out.join("planes.png"), &inputs, &options, &map, args.up)?;
    }
    timings.write = writing.elapsed().as_secs_f64();
    timings.total = start.elapsed().as_secs_f64();
    report::planes_file(&map, inputs.parameters(args), timings).write(&args.out.join("planes.json"))?;
    progress.finish();
    if !args.quiet {
        summarise(&map, &inputs, args);
    }
    Ok(())
}

/// How files are read, from the arguments.
pub fn read_options(args: &ReadArgs) -> Result<ReadOptions, CliError> {
    let errors = match (args.sigma, args.sensor, &args.sigma_field) {
        (Some(sigma), ..) if !Sigma::is_valid(sigma) => {
            return Err(CliError::Usage(format!(
                "--sigma is {sigma}, it must be a number of metres from 0 up"
            )));
        }
        (Some(sigma), ..) => ErrorSource::Model(NoiseModel::Uniform(sigma)),
        (None, Some(Sensor::Kinect), _) => ErrorSource::Model(NoiseModel::Kinect),
        (None, None, Some(field)) => ErrorSource::FromFile(FieldChoice::Named(field.clone())),
        (None, None, None) => ErrorSource::FromFile(FieldChoice::Automatic),
    };
    if !(args.depth_scale.is_finite() && args.depth_scale > 0.0) {
        return Err(CliError::Usage(format!("--depth-scale is {}, it must be above 0", args.depth_scale)));
    }
    let intrinsics = args.intrinsics.as_deref().map(intrinsics).transpose()?;
    Ok(ReadOptions { intrinsics, depth_scale: args.depth_scale, errors })
}

/// Intrinsics from numbers or, when a file of that name exists, from the file.
pub fn intrinsics(text: &str) -> Result<Intrinsics, CliError> {
    if Path::new(text).is_file() {
        Intrinsics::open(Path::new(text)).map_err(|e| CliError::Intrinsics(e.to_string()))
    } else {
        text.parse().map_err(|e: terrace_io::IntrinsicsError| CliError::Intrinsics(e.to_string()))
    }
}

fn params(args: &ExtractArgs) -> Params {
    let mut params = match args.preset {
        Preset::Default => Params::default(),
        Preset::Paper => Params::paper(),
    };
    params.cell_size = args.cell.or(params.cell_size);
    params.tau = args.tau.or(params.tau);
    params.phi = args.phi.unwrap_or(params.phi);
    params.omega = args.omega.unwrap_or(params.omega);
    params.depth = args.depth.unwrap_or(params.depth);
    params.min_cells = args.min_cells.unwrap_or(params.min_cells);
    params.seed = args.seed;
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
    params
}

/// The inputs that were used, with their number of points, and those that were not, with the reason.
#[derive(Default)]
pub struct Inputs {
    used: Vec<(Source, usize)>,
    skipped: Vec<(Source, String)>,
    extent: PlyExtent,
    errors_known: bool,
}

impl Inputs {
    fn parameters(&self, args: &ExtractArgs) -> Map<String, Value> {
        let errors = match (args.read.sigma, args.read.sensor) {
            (Some(sigma), _) => json!({ "sigma": sigma }),
            (None, Some(Sensor::Kinect)) => json!({ "sensor": "kinect" }),
            (None, None) if self.errors_known => {
                json!({ "field": args.read.sigma_field.as_deref().unwrap_or("sigma") })
            }
            (None, None) => Value::Null,
        };
        let skipped: Vec<_> =
            self.skipped.iter().map(|(s, why)| json!({ "input": s.path, "reason": why })).collect();
        let preset = match args.preset {
            Preset::Default => "default",
            Preset::Paper => "paper",
        };
        let entries = [
            ("preset", json!(preset)),
            ("inputs", json!(self.used.len())),
            ("inputs_skipped", json!(skipped)),
            ("errors", errors),
            ("program_version", json!(env!("CARGO_PKG_VERSION"))),
        ];
        entries.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
    }
}

/// Reads the sources, as many at a time as there are threads, and inserts them in order. A source that cannot be read
/// is reported and left out.
///
/// # Errors
/// [`CliError`] when none could be used, or the map refuses a scan.
pub fn insert_all(
    mapper: &mut Mapper,
    sources: &[Source],
    options: &ReadOptions,
    progress: &mut Progress,
    timings: &mut Timings,
) -> Result<Inputs, CliError> {
    let mut inputs = Inputs::default();
    progress.begin("reading", sources.len());
    for batch in sources.chunks(rayon::current_num_threads()) {
        let reading = Instant::now();
        let scans: Vec<_> = batch.par_iter().map(|source| read_scan(source, options)).collect();
        timings.load += reading.elapsed().as_secs_f64();
        let inserting = Instant::now();
        for (source, scan) in batch.iter().zip(scans) {
            let outcome = scan.map_err(|e| e.to_string()).and_then(|scan| {
                insert(mapper, &scan, &mut inputs).map_err(|e| format!("{}: {e}", source.path.display()))
            });
            match outcome {
                Ok((count, inserted)) => {
                    if let Some(first) = inserted.first_refusal {
                        let (left_out, path) = (inserted.out_of_range, source.path.display());
                        progress.warn(&format!("{path}: {left_out} points left out; the first: {first}"));
                    }
                    inputs.used.push((source.clone(), count));
                }
                Err(reason) => {
                    progress.warn(&format!("left out: {reason}"));
                    inputs.skipped.push((source.clone(), reason));
                }
            }
            progress.advance(1);
        }
        timings.grid += inserting.elapsed().as_secs_f64();
    }
    match inputs.skipped.pop() {
        Some((_, last)) if inputs.used.is_empty() => {
            Err(CliError::NothingUsable { inputs: sources.len(), last })
        }
        popped => {
            inputs.skipped.extend(popped);
            Ok(inputs)
        }
    }
}

fn insert(mapper: &mut Mapper, scan: &Scan, inputs: &mut Inputs) -> Result<(usize, Inserted), String> {
    let inserted = mapper.insert(scan).map_err(|e| e.to_string())?;
    let extent = PlyExtent::of(scan.world_points().flatten().map(|p| p.position));
    inputs.extent.points += extent.points;
    inputs.extent.largest = inputs.extent.largest.max(extent.largest);
    inputs.errors_known |= !matches!(scan.sigma(), Sigma::Unknown);
    Ok((scan.len(), inserted))
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
            Stage::Cluster { .. } => &mut timings.cluster,
            Stage::Optimise { .. } => &mut timings.optimise,
            Stage::Label { .. } => &mut timings.label,
        };
        *slot = (end - *begin).as_secs_f64();
    }
    Ok(map)
}

/// The present points of all inputs with their labels, read again from the files. Ends early, with the reason in
/// `failed`, when a file cannot be read or no longer has as many points.
pub fn labelled_points<'a>(
    inputs: &'a Inputs,
    options: &'a ReadOptions,
    map: &'a PlaneMap,
    failed: &'a mut Option<CliError>,
) -> impl Iterator<Item = LabelledPoint> + 'a {
    let mut labels = map.labels.as_slice();
    inputs
        .used
        .iter()
        .map_while(move |(source, count)| {
            let (of_scan, rest) = labels.split_at_checked(*count)?;
            labels = rest;
            match read_scan(source, options) {
                Ok(scan) if scan.len() == *count => Some(label_scan(&scan, of_scan)),
                Ok(_) => {
                    *failed = Some(CliError::Changed { path: source.path.clone() });
                    None
                }
                Err(error) => {
                    *failed = Some(error.into());
                    None
                }
            }
        })
        .flatten()
}

fn label_scan(scan: &Scan, labels: &[Option<PlaneId>]) -> Vec<LabelledPoint> {
    let points = scan.world_points().zip(labels);
    points.filter_map(|(p, plane)| Some(LabelledPoint { position: p?.position, plane: *plane })).collect()
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
    let written = write_labelled_ply(path, inputs.extent, points.inspect(|_| progress.advance(1)));
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

fn summarise(map: &PlaneMap, inputs: &Inputs, args: &ExtractArgs) {
    let summary = map.summary();
    print!("{}", report::table(map, ROWS));
    println!(
        "{} planes, {} of {} points labelled, {} of {} inputs used; cells of {:.4} m, tau {}",
        summary.planes,
        summary.labelled,
        summary.points,
        inputs.used.len(),
        inputs.used.len() + inputs.skipped.len(),
        map.used.cell_size,
        map.used.tau,
    );
    if !inputs.errors_known {
        println!(
            "standard errors of the points are unknown (--sigma, --sensor): uncertainties rest on their scatter"
        );
    }
    println!("written to {}", args.out.display());
}
