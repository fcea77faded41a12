//! `terrace calibrate`: whether the covariances of planes are as large as their errors.

mod against;
mod known;
mod labels;
mod qq;
mod record;
mod table;

use terrace::{Estimate, Params};

use crate::calibrate_args::CalibrateArgs;
use crate::error::CliError;

/// Scans that see a plane, at least, unless told otherwise.
const VIEWS: usize = 5;

/// Runs on a pool of its own, so that `--threads` holds for everything.
pub fn run(args: &CalibrateArgs) -> Result<(), CliError> {
    check(args)?;
    let mut pool = rayon::ThreadPoolBuilder::new();
    if let Some(threads) = args.threads {
        pool = pool.num_threads(threads.into());
    }
    pool.build()?.install(|| match (&args.scene, args.labels.is_empty()) {
        (Some(scene), _) => known::scene(args, (*scene).into()),
        (None, false) => known::scans(args),
        (None, true) => against::run(args),
    })
}

/// Refuses options that would be without effect.
fn check(args: &CalibrateArgs) -> Result<(), CliError> {
    let known = args.scene.is_some() || !args.labels.is_empty();
    let without_effect = |option: &str, why: &str| Err(CliError::Usage(format!("{option} {why}")));
    for (option, given) in [("--points", args.points.is_some()), ("--offset", args.offset.is_some())] {
        if given && args.scene.is_none() {
            return without_effect(option, "is about built scenes: it needs --scene");
        }
    }
    if !known {
        for (option, given) in [
            ("--copies", args.copies.is_some()),
            ("--no-cells", args.no_cells),
            ("--unstated", args.unstated),
            ("--pose-unstated", args.pose_unstated),
        ] {
            if given {
                return without_effect(option, "is about known planes: it needs --scene or --labels");
            }
        }
    }
    if known && args.views.is_some() {
        return without_effect(
            "--views",
            "is about scans without truth, and cannot be used with known planes",
        );
    }
    if args.scene.is_some() && (args.read.intrinsics.is_some() || args.read.sigma_field.is_some()) {
        return without_effect(
            "--intrinsics and --sigma-field",
            "are about files, and cannot be used with --scene",
        );
    }
    params(args, args.floor.unwrap_or(0.0)).validate()?;
    Ok(())
}

fn params(args: &CalibrateArgs, floor: f64) -> Params {
    let params = if args.clusters { Params::clusters() } else { Params::default() };
    Params {
        cell_size: args.cell.or(params.cell_size),
        tau: args.tau.or(params.tau),
        phi: args.phi.unwrap_or(params.phi),
        depth: args.depth.unwrap_or(params.depth),
        min_cells: args.min_cells.unwrap_or(params.min_cells),
        estimate: Some(Estimate { floor }),
        seed: args.seed,
        ..params
    }
}
