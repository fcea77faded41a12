//! `terrace merge`: maps that were saved in, the planes of all of them out.

use std::path::Path;
use std::time::Instant;

use serde_json::{Map, Value, json};
use terrace::{Mapper, MergeError};
use terrace_checkpoint::open_map;
use terrace_io::planes_json::Timings;

use crate::commands::extract::{Told, change, extract_timed, print_summary, save_map};
use crate::error::CliError;
use crate::merge_args::MergeArgs;
use crate::method_args::MethodArgs;
use crate::progress::Progress;
use crate::report;

/// Runs on a pool of its own, so that `--threads` holds for everything.
pub fn run(args: &MergeArgs) -> Result<(), CliError> {
    let mut pool = rayon::ThreadPoolBuilder::new();
    if let Some(threads) = args.threads {
        pool = pool.num_threads(threads.into());
    }
    pool.build()?.install(|| merge(args))
}

fn merge(args: &MergeArgs) -> Result<(), CliError> {
    let start = Instant::now();
    let mut progress = Progress::new(args.quiet);
    let mut timings = Timings::default();
    let mapper = merged(args, &mut progress, &mut timings)?;
    if let Some(file) = &args.save_map {
        save_map(&mapper, file, &mut progress, &mut timings)?;
    }
    let map = extract_timed(
        |begins: &mut dyn FnMut(_)| mapper.extract_observed(begins),
        &mut progress,
        &mut timings,
    )?;
    timings.total = start.elapsed().as_secs_f64();
    let parameters = parameters(args, &mapper);
    report::planes_file(&map, |_| None, parameters, timings).write(&args.out.join("planes.json"))?;
    progress.finish();
    if !args.quiet {
        let mut written = vec![args.out.as_path()];
        written.extend(args.save_map.as_deref());
        let from = format!("{} inputs in {} maps", mapper.views().len(), args.maps.len());
        print_summary(&map, None, &Told { from, errors_known: mapper.knows_errors(), written });
    }
    Ok(())
}

/// All maps as one.
fn merged(args: &MergeArgs, progress: &mut Progress, timings: &mut Timings) -> Result<Mapper, CliError> {
    progress.begin("maps", args.maps.len());
    let mut all: Option<Mapper> = None;
    for path in &args.maps {
        let loading = Instant::now();
        let map = opened(path, &args.method)?;
        timings.load += loading.elapsed().as_secs_f64();
        let adding = Instant::now();
        match &mut all {
            None => all = Some(map),
            Some(all) => all.merge(&map).map_err(|error| does_not_fit(path, error))?,
        }
        timings.grid += adding.elapsed().as_secs_f64();
        progress.advance(1);
    }
    all.ok_or_else(|| CliError::Usage("no map is given".to_owned()))
}

/// A map with the settings that are given.
fn opened(path: &Path, method: &MethodArgs) -> Result<Mapper, CliError> {
    let mut map = open_map(path).map_err(|error| CliError::MapFile { path: path.to_owned(), error })?;
    let mut params = *map.params();
    change(&mut params, method, "the map is one for regions", "a map for clusters")?;
    map.set_params(params)?;
    Ok(map)
}

fn does_not_fit(path: &Path, error: MergeError) -> CliError {
    let advice = match &error {
        MergeError::CellSizes { .. } => "build all parts with the same --cell",
        MergeError::Kinds { .. } | MergeError::NotByPlace { .. } => "build all parts with the same --preset",
        MergeError::Errors { .. } => "state the errors of all parts, or of none",
        MergeError::Settings { name: "regions.errors_are_complete", .. } => {
            "state the errors of all parts in the same way, all by --sensor or none"
        }
        MergeError::Settings { .. } => "build all parts with the same options, or give the option here",
        MergeError::Spared => "save maps with --save-map",
        MergeError::Grid(_) => "use larger cells",
    };
    CliError::Merge { path: path.to_owned(), error, advice }
}

/// What `planes.json` tells of the maps.
fn parameters(args: &MergeArgs, mapper: &Mapper) -> Map<String, Value> {
    let entries = [
        ("maps", json!(args.maps)),
        ("inputs", json!(mapper.views().len())),
        ("program_version", json!(env!("CARGO_PKG_VERSION"))),
    ];
    entries.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
}
