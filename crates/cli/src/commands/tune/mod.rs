//! `terrace tune`: scans in, the settings that suit them best out.

mod again;
mod landscape;
mod record;

use rayon::prelude::*;
use terrace::tune::{
    Objective, Quality, TrueLabel, TuneAxis, TuneError, TuneSearch, TuneSpace, Tuned, Tuner,
};
use terrace::{Params, ParamsError, Scan};
use terrace_io::{ReadOptions, Source, find_sources, npy, read_counted};

use crate::args::{QualityMeasure, TuneArgs};
use crate::commands::extract::{not_measured, read_options};
use crate::error::CliError;
use crate::picture::write_png;
use crate::progress::Progress;

/// The intersection over union above which planes match, for `--quality f1`.
const MATCH_ABOVE: f64 = 0.8;

/// Most steps of the cost along a setting in the landscape.
const SLICE: usize = 256;

/// Runs on a pool of its own, so that `--threads` holds for everything.
pub fn run(args: &TuneArgs) -> Result<(), CliError> {
    let mut pool = rayon::ThreadPoolBuilder::new();
    if let Some(threads) = args.threads {
        pool = pool.num_threads(threads.into());
    }
    pool.build()?.install(|| tune(args))
}

fn tune(args: &TuneArgs) -> Result<(), CliError> {
    let options = read_options(&args.read)?;
    let params = params(args)?;
    params.validate().map_err(|error| named(error.into()))?;
    let objective = objective(args)?;
    let sources = find_sources(&args.inputs, args.poses.as_deref())?;
    let mut progress = Progress::new(args.quiet);
    let (scans, skipped) = read_all(&sources, &options, &mut progress)?;

    progress.spin("first look");
    let tuner = Tuner::new(params, scans, objective).map_err(named)?;
    let space = space(args, tuner.space());
    let mut cost = tuner.cost(&space).map_err(named)?;
    progress.begin("tuning", args.evaluations);
    let search = TuneSearch { evaluations: args.evaluations, ..TuneSearch::default() };
    let tuned = cost.tune(&search, |now| {
        progress.advance(1);
        progress.tell(format!("cost {:.4}", now.best));
    });
    let tuned = tuned.map_err(named)?;

    progress.spin("landscape");
    let mut slices = Vec::new();
    for axis in TuneAxis::ALL.into_iter().filter(|axis| space.varies(*axis)) {
        slices.push((axis, cost.slice(&tuned.best, axis, SLICE).map_err(named)?));
    }
    progress.spin("writing");
    let record = record::Record { args, space: &space, tuned: &tuned, slices: &slices, skipped: &skipped };
    record.write(&args.out.join("tune.json"))?;
    if let Some(picture) = landscape::draw(&tuned, &slices)? {
        write_png(&args.out.join("landscape.png"), &picture.png()?)?;
    }
    progress.finish();
    if !args.quiet {
        summarise(args, &tuned);
    }
    Ok(())
}

fn params(args: &TuneArgs) -> Result<Params, CliError> {
    let params = args.preset.params();
    if params.regions.is_some() {
        return Err(CliError::Usage(
            "what is tuned are the settings of clusters, --preset clusters or paper: regions need no tuning"
                .to_owned(),
        ));
    }
    let single = |sizes: &Vec<f64>| if let [only] = sizes[..] { Some(only) } else { None };
    Ok(Params {
        // One cell size is the one in use, so that tau follows from it.
        cell_size: args.cell.as_ref().and_then(single),
        min_cells: args.min_cells.unwrap_or(params.min_cells),
        seed: args.seed,
        ..params
    })
}

fn objective(args: &TuneArgs) -> Result<Objective, CliError> {
    let Some(path) = &args.labels else {
        return Ok(Objective::Uncertainty { weight_uncertainty: 1.0, weight_clusters: args.weight_clusters });
    };
    let refused = |reason: String| CliError::Labels { path: path.clone(), reason };
    let bytes = std::fs::read(path).map_err(|error| refused(error.to_string()))?;
    let labels = npy::read_labels(&bytes).map_err(|error| refused(error.to_string()))?;
    let quality = match args.quality {
        QualityMeasure::Cover => Quality::Cover,
        QualityMeasure::F1 => Quality::F1 { at_iou: MATCH_ABOVE },
    };
    Ok(Objective::Labels { truth: labels.into_iter().map(TrueLabel::from).collect(), quality })
}

fn space(args: &TuneArgs, around: TuneSpace) -> TuneSpace {
    TuneSpace {
        cell_size: args.cell.clone().unwrap_or(around.cell_size),
        depth: args.depth.unwrap_or(around.depth),
        tau: args.tau.clone().unwrap_or(around.tau),
        omega: args.omega.unwrap_or(around.omega),
        phi: args.phi.unwrap_or(around.phi),
    }
}

/// Inputs that could not be used, with the reason.
type Skipped = Vec<(Source, String)>;

/// Reads the sources, as many at a time as there are threads. One that cannot be read is reported and left out.
fn read_all(
    sources: &[Source],
    options: &ReadOptions,
    progress: &mut Progress,
) -> Result<(Vec<Scan>, Skipped), CliError> {
    let (mut scans, mut skipped, mut absent) = (Vec::new(), Vec::new(), 0);
    progress.begin("reading", sources.len());
    for batch in sources.chunks(rayon::current_num_threads()) {
        let read: Vec<_> = batch.par_iter().map(|source| read_counted(source, options)).collect();
        for (source, scan) in batch.iter().zip(read) {
            match scan {
                Ok(counted) => {
                    absent += counted.not_measured;
                    scans.push(counted.scan);
                }
                Err(error) => {
                    progress.warn(&format!("left out: {error}"));
                    skipped.push((source.clone(), error.to_string()));
                }
            }
            progress.advance(1);
        }
    }
    if let Some(warning) = not_measured(absent) {
        progress.warn(&warning);
    }
    match skipped.last() {
        Some((_, last)) if scans.is_empty() => {
            Err(CliError::NothingUsable { inputs: sources.len(), last: last.clone() })
        }
        _ => Ok((scans, skipped)),
    }
}

/// With the option that an error is about, where it is about one.
fn named(error: TuneError) -> CliError {
    let parameter = match &error {
        TuneError::Params(ParamsError { name, .. }) => name,
        TuneError::NoValue { axis } | TuneError::Reversed { axis, .. } => axis.name(),
        TuneError::Evaluations { .. } => "evaluations",
        TuneError::Labels { .. } | TuneError::NoTruePlanes { .. } => "labels",
        _ => return CliError::Tune(error),
    };
    CliError::TuneOption { option: again::option(parameter), error }
}

fn summarise(args: &TuneArgs, tuned: &Tuned) {
    let measure = match (&args.labels, args.quality) {
        (None, _) => "cost",
        (Some(_), QualityMeasure::Cover) => "1 - cover",
        (Some(_), QualityMeasure::F1) => "1 - F1",
    };
    outln!("          cell m   depth   tau       omega         phi   {measure}");
    let rows = [("before", &tuned.before_settings, &tuned.before), ("best", &tuned.best, &tuned.step)];
    for (name, s, step) in rows {
        outln!(
            "{name:<6} {:>9} {:>7} {:>5} {:>11} {:>11}   {}",
            significant(s.cell_size),
            s.depth,
            s.tau,
            short(s.omega),
            short(s.phi),
            fixed(step.value)
        );
    }
    let step = &tuned.step;
    outln!(
        "the same result for tau {} to {}, omega {} to {}, phi {} to {}",
        step.tau.0,
        step.tau.1.map_or("any".to_owned(), |tau| tau.to_string()),
        short(step.omega.0),
        short(step.omega.1),
        short(step.phi.lo),
        step.phi.hi.map_or("any".to_owned(), short),
    );
    outln!(
        "{} evaluations; for {} % of the settings it is proven that none is better",
        tuned.evaluations,
        percent(tuned.certified)
    );
    outln!("{}", again::command(args, &tuned.best));
    outln!("written to {}", args.out.display());
}

/// Six decimals at most.
fn short(value: f64) -> String {
    if !value.is_finite() {
        return "any".to_owned();
    }
    let text = format!("{value:.6}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// Four significant digits.
fn significant(value: f64) -> String {
    let short = format!("{value:.3e}").parse().unwrap_or(value);
    if (1e-4..1e6).contains(&short) { short.to_string() } else { format!("{short:e}") }
}

/// Six decimals, unless that makes a long number.
fn fixed(value: f64) -> String {
    if value.abs() < 1e6 { format!("{value:.6}") } else { format!("{value:.6e}") }
}

/// A share as per cent with two significant digits; 100 only when it is all.
fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    match percent {
        _ if share >= 1.0 => "100".to_owned(),
        p if p >= 10.0 => format!("{:.0}", p.min(99.0)),
        p if p >= 0.01 => format!("{p:.2}"),
        p if p > 0.0 => format!("{p:.1e}"),
        _ => "0".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_honest() {
        assert_eq!([0.25, 1.0, 0.123_456_789, f64::INFINITY].map(short), ["0.25", "1", "0.123457", "any"]);
        assert_eq!([0.088_14, 1e-9, 2.5, 1e7].map(significant), ["0.08814", "1e-9", "2.5", "1e7"]);
        assert_eq!([0.25, -1.0, 2.5e300].map(fixed), ["0.250000", "-1.000000", "2.500000e300"]);
        let shares = [0.0, 3.2e-7, 0.0123, 0.42, 0.9999, 1.0];
        assert_eq!(shares.map(percent), ["0", "3.2e-5", "1.23", "42", "99", "100"]);
    }
}
