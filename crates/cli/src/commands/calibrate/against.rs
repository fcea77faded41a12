//! Posed scans without truth, each against the others.

use rayon::prelude::*;
use serde_json::{Value, json};
use terrace::Mapper;
use terrace_io::{Counted, ReadOptions, Source, read_counted, read_scan};
use terrace_trials::{Agreement, Look, Reference, TrialError};

use super::record::{Record, of_calibration, of_plane, of_scatter};
use super::{VIEWS, params, qq, table};
use crate::calibrate_args::CalibrateArgs;
use crate::commands::extract::{extract_timed, not_measured, read_options, sources};
use crate::error::CliError;
use crate::progress::Progress;

/// An input that is in the map, and where its points begin there.
struct Used {
    source: Source,
    first: usize,
    points: usize,
}

type Skipped = Vec<(Source, String)>;

/// Reads each scan twice and keeps none: first for the planes of all, then for its own.
pub fn run(args: &CalibrateArgs) -> Result<(), CliError> {
    let options = read_options(&args.read)?;
    let sources =
        sources(&args.inputs, args.poses.as_deref(), args.pose_covariances.as_deref(), args.pose_sigma)?;
    let mut progress = Progress::new(args.quiet);
    let mut mapper = Mapper::new(params(args, 0.0))?;
    let (used, skipped) = insert_all(&mut mapper, &sources, &options, &mut progress)?;
    let extract = |begins: &mut dyn FnMut(_)| mapper.extract_observed(begins);
    let map = extract_timed(extract, &mut progress, &mut terrace_io::planes_json::Timings::default())?;
    drop(mapper);
    let (cell_size, tau) = (map.used.cell_size, map.used.tau);
    let places: Vec<Value> = map
        .planes
        .iter()
        .map(|p| json!({ "coefficients": p.plane.coefficients(), "centroid": p.centroid }))
        .collect();
    let reference = Reference::new(map);

    // A floor of zero is none.
    let floors: Vec<f64> = [0.0].into_iter().chain(args.floor.filter(|floor| *floor > 0.0)).collect();
    let looks = look_all(&reference, &used, &options, &floors, &mut progress)?;
    let views = args.views.map_or(VIEWS, usize::from);
    let mut runs = Vec::new();
    for (floor, looks) in floors.iter().zip(&looks) {
        let name = if *floor > 0.0 { format!("floor {floor} m") } else { "without floor".to_owned() };
        runs.push((name, reference.compare(looks, views)?));
    }

    let mut record = Record::new("scans", args);
    record.parameter("cell_size", cell_size);
    record.parameter("tau", tau);
    record.parameter("views", views);
    record.parameter("noise", noise(args));
    record.parameter("pose_covariances", &args.pose_covariances);
    record.parameter("inputs", used.iter().map(|used| &used.source.path).collect::<Vec<_>>());
    record.parameter("inputs_skipped", skipped_inputs(&skipped));
    let entries: Vec<Value> = floors
        .iter()
        .zip(&runs)
        .map(|(floor, (_, agreement))| of_agreement(*floor, agreement, &places))
        .collect();
    record.set("runs", entries);
    record.write(&args.out.join("calibrate.json"))?;
    let series: Vec<_> = runs.iter().map(|(name, agreement)| (name.as_str(), &agreement.all)).collect();
    qq::write(&args.out, "planes of scans against those of the others", &series)?;
    progress.finish();
    if !args.quiet {
        out!("{}", table::of_agreements(&runs));
        outln!(
            "{} of {} inputs used; cells of {cell_size:.4} m; written to {}",
            used.len(),
            used.len() + skipped.len(),
            args.out.display()
        );
    }
    Ok(())
}

/// Puts all scans into the map, as many read at a time as there are threads. One that cannot be used is reported and left out.
fn insert_all(
    mapper: &mut Mapper,
    sources: &[Source],
    options: &ReadOptions,
    progress: &mut Progress,
) -> Result<(Vec<Used>, Skipped), CliError> {
    let inputs = sources.len();
    let (mut used, mut skipped, mut absent) = (Vec::new(), Skipped::new(), 0);
    progress.begin("reading", inputs);
    for batch in sources.chunks(rayon::current_num_threads()) {
        let scans: Vec<_> = batch.par_iter().map(|source| read_counted(source, options)).collect();
        for (source, scan) in batch.iter().zip(scans) {
            let first = mapper.len();
            let outcome =
                scan.map_err(|error| error.to_string()).and_then(|Counted { scan, not_measured }| {
                    let inserted = mapper
                        .insert_from(&scan, source.pose_noise)
                        .map_err(|error| format!("{}: {error}", source.path.display()))?;
                    if let Some(refusal) = inserted.first_refusal {
                        let (left_out, path) = (inserted.out_of_range, source.path.display());
                        progress.warn(&format!("{path}: {left_out} points left out; the first: {refusal}"));
                    }
                    absent += not_measured;
                    Ok(scan.len())
                });
            match outcome {
                Ok(points) => used.push(Used { source: source.clone(), first, points }),
                Err(reason) => {
                    progress.warn(&format!("left out: {reason}"));
                    skipped.push((source.clone(), reason));
                }
            }
            progress.advance(1);
        }
    }
    if let Some(warning) = not_measured(absent) {
        progress.warn(&warning);
    }
    match skipped.last() {
        Some((_, last)) if used.is_empty() => Err(CliError::NothingUsable { inputs, last: last.clone() }),
        _ => Ok((used, skipped)),
    }
}

/// What each scan sees by itself, for each floor.
fn look_all(
    reference: &Reference,
    used: &[Used],
    options: &ReadOptions,
    floors: &[f64],
    progress: &mut Progress,
) -> Result<Vec<Vec<Look>>, CliError> {
    progress.begin("each alone", used.len());
    let mut looks: Vec<Vec<Look>> = vec![Vec::with_capacity(used.len()); floors.len()];
    for batch in used.chunks(rayon::current_num_threads()) {
        let of_batch: Vec<Vec<Look>> = batch
            .par_iter()
            .map(|used| {
                let scan = read_scan(&used.source, options)?;
                if scan.len() != used.points {
                    return Err(CliError::Changed { path: used.source.path.clone() });
                }
                let look = |floor: &f64| reference.look(&scan, used.source.pose_noise, used.first, *floor);
                Ok(floors.iter().map(look).collect::<Result<Vec<Look>, TrialError>>()?)
            })
            .collect::<Result<_, CliError>>()?;
        for of_scan in of_batch {
            for (all, look) in looks.iter_mut().zip(of_scan) {
                all.push(look);
            }
            progress.advance(1);
        }
    }
    Ok(looks)
}

fn noise(args: &CalibrateArgs) -> Value {
    match (args.read.sigma, args.read.sensor) {
        (Some(sigma), _) => json!({ "sigma": sigma }),
        (None, Some(noise)) => json!({ "sensor": noise.to_string() }),
        (None, None) => json!({ "field": args.read.sigma_field.as_deref().unwrap_or("sigma") }),
    }
}

fn skipped_inputs(skipped: &Skipped) -> Vec<Value> {
    skipped.iter().map(|(source, why)| json!({ "input": source.path, "reason": why })).collect()
}

fn of_agreement(floor: f64, agreement: &Agreement, places: &[Value]) -> Value {
    let mut entry = of_calibration(&agreement.all);
    entry["floor"] = floor.into();
    entry["scatter"] = of_scatter(&agreement.scatter);
    entry["seldom"] = agreement.seldom.into();
    entry["unmatched"] = agreement.unmatched.into();
    entry["without"] = agreement.without.into();
    entry["turned"] = agreement.turned.into();
    entry["lesser"] = agreement.lesser.into();
    entry["by_plane"] = agreement
        .planes
        .iter()
        .map(|plane| {
            let mut entry = of_plane(plane);
            if let Some(Value::Object(place)) = places.get(plane.id.index()) {
                for (name, value) in place {
                    entry[name.as_str()] = value.clone();
                }
            }
            entry
        })
        .collect();
    entry
}
