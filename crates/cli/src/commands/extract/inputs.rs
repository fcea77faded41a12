//! The inputs of `extract`: how they are read, and what became of them.

use std::path::Path;

use serde_json::{Map, Value, json};
use terrace_io::{
    ErrorSource, FieldChoice, Intrinsics, PlyExtent, ReadOptions, Source, find_sources,
    find_uncertain_sources,
};
use terrace_noise::{PoseSigma, SensorNoise, Uniform};

use crate::args::ReadArgs;
use crate::error::CliError;
use crate::extract_args::ExtractArgs;

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

/// The inputs that were used, with their number of points, and those that were not, or not to their end, with the reason.
#[derive(Default)]
pub struct Inputs {
    used: Vec<Source>,
    points: Vec<usize>,
    /// The number of an input that was used to where it could be read.
    in_part: Vec<(usize, String)>,
    skipped: Vec<(Source, String)>,
    /// Where that is asked for.
    pub(super) extent: Option<PlyExtent>,
    pub(super) errors_known: bool,
    pub(super) not_measured: usize,
}

impl Inputs {
    /// Adds an input that was used with so many points; for one that could not be read to its end, the reason.
    pub(super) fn take(&mut self, source: &Source, points: usize, cut: Option<String>) {
        self.in_part.extend(cut.map(|reason| (self.used.len(), reason)));
        self.used.push(source.clone());
        self.points.push(points);
    }

    /// Adds an input that was not used.
    pub(super) fn skip(&mut self, source: &Source, reason: String) {
        self.skipped.push((source.clone(), reason));
    }

    /// Number of inputs that were used.
    pub fn used(&self) -> usize {
        self.used.len()
    }

    /// The inputs that were used, in order.
    pub fn sources(&self) -> &[Source] {
        &self.used
    }

    /// How many points of an input were used, and whether these are all.
    pub fn points_of(&self, number: usize) -> (usize, bool) {
        let whole = self.in_part.iter().all(|(cut, _)| *cut != number);
        (self.points.get(number).copied().unwrap_or(0), whole)
    }

    /// Points of all inputs.
    pub fn points(&self) -> usize {
        self.points.iter().sum()
    }

    /// Number of inputs that were not.
    pub fn skipped(&self) -> usize {
        self.skipped.len()
    }

    /// Why the last of these was not.
    pub fn last_skipped(&self) -> Option<&str> {
        self.skipped.last().map(|(_, reason)| reason.as_str())
    }

    /// What the present points span, if that was asked for.
    pub fn extent(&self) -> Option<PlyExtent> {
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
        let in_part: Vec<_> = self
            .in_part
            .iter()
            .filter_map(|(number, why)| {
                let (points, _) = self.points_of(*number);
                Some(json!({ "input": self.used.get(*number)?.path, "points": points, "reason": why }))
            })
            .collect();
        let entries = [
            ("preset", json!(args.preset.name())),
            ("inputs", json!(self.used.len())),
            ("inputs_skipped", json!(skipped)),
            ("inputs_in_part", json!(in_part)),
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
