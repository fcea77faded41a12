//! Noisy copies of places whose planes are known.

use std::sync::Mutex;

use rayon::prelude::*;
use terrace_io::{ErrorSource, FieldChoice, ReadOptions, find_sources, read_scan};
use terrace_noise::SensorNoise;
use terrace_synth::{LabelledScan, Scene, SceneKind};
use terrace_trials::{KnownPlace, Outcome, PointNoise, Trials};
use terrace_types::Pose;

use super::record::{Record, exceedance, of_calibration};
use super::{labels, params, qq, table};
use crate::calibrate_args::CalibrateArgs;
use crate::commands::extract::read_options;
use crate::error::CliError;
use crate::progress::Progress;

/// What a corridor is scanned with, unless told otherwise.
const CORRIDOR: &str = "lidar:range=0.02,angle=0.05deg";
const ROOM: &str = "kinect";

/// Copies of a built scene.
pub fn scene(args: &CalibrateArgs, kind: SceneKind) -> Result<(), CliError> {
    let usual = match kind {
        SceneKind::Table | SceneKind::Desk | SceneKind::Strip | SceneKind::Patch => None,
        SceneKind::Room | SceneKind::Building => Some(ROOM),
        SceneKind::Corridor => Some(CORRIDOR),
    };
    let scene = Scene::sized(kind, args.points.unwrap_or(kind.default_points()));
    let scene = match args.offset {
        Some(offset) => scene.transformed(
            &Pose::new(Pose::IDENTITY.rotation(), offset)
                .map_err(|error| CliError::Usage(format!("--offset {offset:?}: {error}")))?,
        )?,
        None => scene,
    };
    let noise = match (model(args)?, usual) {
        (Some(model), _) => PointNoise::Model(model),
        (None, Some(usual)) => {
            PointNoise::Model(usual.parse().map_err(|error| CliError::Usage(format!("{usual}: {error}")))?)
        }
        (None, None) => PointNoise::Own,
    };
    let name = kind.name();
    let place = KnownPlace::Built { scene: Box::new(scene), points: args.points };
    let mut record = Record::new("scene", args);
    record.parameter("scene", name);
    record.parameter("points", args.points);
    record.parameter("offset", args.offset);
    trials(args, &place, noise, &format!("planes of copies of the {name}"), record, Progress::new(args.quiet))
}

/// Copies of exact scans.
pub fn scans(args: &CalibrateArgs) -> Result<(), CliError> {
    let noise = model(args)?.map_or(PointNoise::Own, PointNoise::Model);
    // The model is that of the copies; what the files tell is read for lack of one.
    let field = args.read.sigma_field.clone().map_or(FieldChoice::Automatic, FieldChoice::Named);
    let options = ReadOptions { errors: ErrorSource::FromFile(field), ..read_options(&args.read)? };
    let sources = find_sources(&args.inputs, args.poses.as_deref())?;
    let progress = Progress::new(args.quiet);
    // Labels belong to inputs by their order: none can be left out.
    let scans: Vec<_> =
        sources.par_iter().map(|source| read_scan(source, &options)).collect::<Result<_, _>>()?;
    let counts: Vec<usize> = scans.iter().map(terrace::Scan::len).collect();
    let labels = labels::of_scans(&args.labels, &counts)?;
    let scans: Vec<LabelledScan> =
        scans.into_iter().zip(labels).map(|(scan, labels)| LabelledScan { scan, labels }).collect();
    let place = KnownPlace::of_exact_scans(scans);
    if place.planes().is_empty() {
        return Err(CliError::Usage("--labels: no label has three points that are not on a line".to_owned()));
    }
    let mut record = Record::new("labelled", args);
    record.parameter("inputs", sources.iter().map(|source| &source.path).collect::<Vec<_>>());
    record.parameter("labels", &args.labels);
    trials(args, &place, noise, "planes of copies of scans", record, progress)
}

/// The noise that the arguments name.
fn model(args: &CalibrateArgs) -> Result<Option<SensorNoise>, CliError> {
    match read_options(&args.read)?.errors {
        ErrorSource::Model(model) => Ok(Some(model)),
        ErrorSource::FromFile(_) => Ok(None),
    }
}

fn trials(
    args: &CalibrateArgs,
    place: &KnownPlace,
    noise: PointNoise,
    title: &str,
    mut record: Record,
    mut progress: Progress,
) -> Result<(), CliError> {
    let usual = Trials::default();
    let trials = Trials {
        copies: args.copies.unwrap_or(usual.copies),
        seed: args.seed,
        noise,
        told: !args.unstated,
        pose: args.pose_sigma.map(Into::into),
        pose_told: !args.pose_unstated,
        cells: !args.no_cells,
        params: params(args, args.floor.unwrap_or(0.0)),
    };
    progress.begin("copies", trials.copies.get() as usize);
    let shared = Mutex::new(progress);
    let outcome = trials.run(place, || {
        // A bar that a panic left behind is still a bar.
        shared.lock().unwrap_or_else(std::sync::PoisonError::into_inner).advance(1);
    })?;
    shared.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner).finish();

    let noise = match noise {
        PointNoise::Own => None,
        PointNoise::Model(model) => Some(model.to_string()),
    };
    record.parameter("noise", noise);
    record.parameter("stated", trials.told);
    record.parameter("pose_stated", trials.pose.map(|_| trials.pose_told));
    fill(&mut record, &outcome, trials.cells);
    record.write(&args.out.join("calibrate.json"))?;
    let mut series = vec![("planes", &outcome.planes)];
    if trials.cells {
        series.push(("cells", &outcome.cells));
    }
    qq::write(&args.out, title, &series)?;
    if !args.quiet {
        out!("{}", table::of_outcome(&outcome, trials.cells));
        outln!("written to {}", args.out.display());
    }
    Ok(())
}

fn fill(record: &mut Record, outcome: &Outcome, cells: bool) {
    record.set("copies", outcome.copies);
    record.set("planes", of_calibration(&outcome.planes));
    record.set("mixed", of_calibration(&outcome.mixed));
    record.set("cells", cells.then(|| of_calibration(&outcome.cells)));
    let mut by_plane = Vec::new();
    for (name, calibration) in &outcome.by_plane {
        let mut entry = of_calibration(calibration);
        entry["name"] = name.as_str().into();
        by_plane.push(entry);
    }
    record.set("by_plane", by_plane);
    record.set(
        "min_max_exceeded",
        serde_json::json!({
            "planes": exceedance(&outcome.plane_bounds),
            "cells": exceedance(&outcome.cell_bounds),
            "fitted_cells": exceedance(&outcome.fitted_bounds),
        }),
    );
    record.set("unmatched", outcome.unmatched);
    record.set("without", outcome.without);
    record.set("grown", outcome.grown);
}
