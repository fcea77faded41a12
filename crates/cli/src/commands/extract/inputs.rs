//! The inputs of `extract`: how they are read, and what became of them.

use std::path::Path;
use std::time::Instant;

use rayon::prelude::*;
use serde_json::{Map, Value, json};
use terrace::{Frame, Inserted, Mapper, PlaneId, PlaneMap, Scan, Sigma};
use terrace_io::planes_json::Timings;
use terrace_io::{
    Counted, ErrorSource, FieldChoice, Intrinsics, LabelledPoint, PlyExtent, ReadError, ReadOptions, Source,
    find_sources, find_uncertain_sources, read_scan,
};
use terrace_noise::{PoseSigma, SensorNoise, Uniform};

use crate::args::ReadArgs;
use crate::error::CliError;
use crate::extract_args::ExtractArgs;
use crate::progress::Progress;

/// How files are read, from the arguments.
pub fn read_options(args: &ReadArgs) -> Result<ReadOptions, CliError> {
    let errors = match (args.sigma, args.sensor, &args.sigma_field) {
        (Some(sigma), ..) => {
            ErrorSource::Model(SensorNoise::Uniform(Uniform::from_metres(sigma).map_err(|_| {
                CliError::Usage(format!("--sigma is {sigma}, it must be a number of metres from 0 up"))
            })?))
        }
        (None, Some(noise), _) => ErrorSource::Model(noise),
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

/// The scans that `inputs` name, with their poses and how sure these are: by a file, or all alike.
pub fn sources(
    inputs: &[String],
    poses: Option<&Path>,
    covariances: Option<&Path>,
    sigma: Option<PoseSigma>,
) -> Result<Vec<Source>, CliError> {
    let mut sources = match covariances {
        Some(file) => find_uncertain_sources(inputs, poses, file)?,
        None => find_sources(inputs, poses)?,
    };
    if let Some(sigma) = sigma {
        for source in &mut sources {
            source.pose_noise = Some(sigma.into());
        }
    }
    Ok(sources)
}

/// The inputs that were used, with their number of points, and those that were not, with the reason.
#[derive(Default)]
pub struct Inputs {
    used: Vec<(Source, usize)>,
    skipped: Vec<(Source, String)>,
    extent: PlyExtent,
    errors_known: bool,
    not_measured: usize,
}

impl Inputs {
    /// Number of inputs that were used.
    pub fn used(&self) -> usize {
        self.used.len()
    }

    /// Number of inputs that were not.
    pub fn skipped(&self) -> usize {
        self.skipped.len()
    }

    /// What the present points span.
    pub fn extent(&self) -> PlyExtent {
        self.extent
    }

    /// Whether the errors of any points are known.
    pub fn errors_known(&self) -> bool {
        self.errors_known
    }

    /// Points that are no measurements by the noise model.
    pub fn not_measured(&self) -> usize {
        self.not_measured
    }

    /// What `planes.json` tells of the inputs.
    pub fn parameters(&self, args: &ExtractArgs) -> Map<String, Value> {
        let errors = match (args.read.sigma, args.read.sensor) {
            (Some(sigma), _) => json!({ "sigma": sigma }),
            (None, Some(noise)) => json!({ "sensor": noise.to_string() }),
            (None, None) if self.errors_known => {
                json!({ "field": args.read.sigma_field.as_deref().unwrap_or("sigma") })
            }
            (None, None) => Value::Null,
        };
        let pose_sigma = args
            .pose_sigma
            .map(|sigma| json!({ "translation": sigma.translation(), "rotation": sigma.rotation() }));
        let skipped: Vec<_> =
            self.skipped.iter().map(|(s, why)| json!({ "input": s.path, "reason": why })).collect();
        let entries = [
            ("preset", json!(args.preset.name())),
            ("inputs", json!(self.used.len())),
            ("inputs_skipped", json!(skipped)),
            ("errors", errors),
            ("pose_sigma", json!(pose_sigma)),
            ("pose_covariances", json!(args.pose_covariances)),
            ("program_version", json!(env!("CARGO_PKG_VERSION"))),
        ];
        entries.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
    }
}

/// A warning about points that are no measurements; `None` when there are none.
pub fn not_measured(points: usize) -> Option<String> {
    (points > 0).then(|| {
        format!(
            "{points} points are no measurements by the noise model and taken as absent: they are at the sensor itself, \
             or too far away for an error"
        )
    })
}

/// Reads the sources with `read`, as many at a time as there are threads, and inserts them in order. A source that cannot be read
/// is reported and left out.
///
/// # Errors
/// [`CliError`] when none could be used, or the map refuses a scan.
pub fn insert_all(
    mapper: &mut Mapper,
    sources: &[Source],
    read: impl Fn(&Source) -> Result<Counted, ReadError> + Sync,
    progress: &mut Progress,
    timings: &mut Timings,
) -> Result<Inputs, CliError> {
    let mut inputs = Inputs::default();
    progress.begin("reading", sources.len());
    for batch in sources.chunks(rayon::current_num_threads()) {
        let reading = Instant::now();
        let scans: Vec<_> = batch.par_iter().map(&read).collect();
        timings.load += reading.elapsed().as_secs_f64();
        let inserting = Instant::now();
        for (source, scan) in batch.iter().zip(scans) {
            let outcome = scan.map_err(|e| e.to_string()).and_then(|scan| {
                insert(mapper, source, &scan, &mut inputs)
                    .map_err(|e| format!("{}: {e}", source.path.display()))
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

fn insert(
    mapper: &mut Mapper,
    source: &Source,
    Counted { scan, not_measured }: &Counted,
    inputs: &mut Inputs,
) -> Result<(usize, Inserted), String> {
    if source.pose_noise.is_some() && !has_pose(source, scan) {
        return Err("the pose of the scan is said to be uncertain, but it is not known: give --poses, or a PCD with a \
                    VIEWPOINT"
            .to_owned());
    }
    let inserted = mapper.insert_from(scan, source.pose_noise).map_err(|e| e.to_string())?;
    inputs.not_measured += not_measured;
    let extent = PlyExtent::of(scan.world_points().flatten().map(|p| p.position));
    inputs.extent.points += extent.points;
    inputs.extent.largest = inputs.extent.largest.max(extent.largest);
    inputs.errors_known |= !matches!(scan.sigma(), Sigma::Unknown);
    Ok((scan.len(), inserted))
}

/// Whether it is known where the sensor stood, and not only taken as the origin.
fn has_pose(source: &Source, scan: &Scan) -> bool {
    source.pose.is_some() || matches!(scan.frame(), Frame::World { sensor: Some(_) })
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
