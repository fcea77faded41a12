//! What covariances cost: CPU time of a whole extraction, points into the grid included, with them and without.
//!
//! The two alternate in one process, so that both meet the same machine.
//!
//! `cargo bench -p terrace-benches --bench price`

use std::error::Error;
use std::process::ExitCode;

use terrace::{Estimate, Mapper, Params, Scan, Sigma};
use terrace_benches::{Usage, scenes};

const PAIRS: usize = 21;
const ROOM: &str = "scenes/room300k/points.npy";
const ERRORS: &str = "scenes/room300k/sigma.npy";

type Outcome<T> = Result<T, Box<dyn Error + Send + Sync>>;

fn main() -> ExitCode {
    if !std::env::args().any(|a| a == "--bench") {
        println!("nothing is measured without `cargo bench`");
        return ExitCode::SUCCESS;
    }
    match table() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn table() -> Outcome<()> {
    let mut inputs = Vec::new();
    if let Some(room) = scenes::npy(ROOM)?.pop() {
        if let Some(path) = scenes::path(ERRORS) {
            let sigma = sigmas(&std::fs::read(path)?, room.len())?;
            inputs.push(("room300k, errors stated", vec![room.clone().with_sigma(sigma)?]));
        }
        inputs.push(("room300k, errors to be found", vec![room]));
    }
    inputs.push(("synth room, 300 000 points of 14 scans", synth(false)?));
    inputs.push(("synth room, errors to be found", synth(true)?));
    println!(
        "| input | CPU s without | CPU s with | ratio | the middle half of ratios | planes with a covariance |"
    );
    println!("|---|---|---|---|---|---|");
    for (name, scans) in &inputs {
        let mut times: Vec<[f64; 2]> = Vec::new();
        let mut told = (0, 0);
        for _ in 0..PAIRS {
            let (without, _) = run(scans, None)?;
            let (with, found) = run(scans, Some(Estimate::default()))?;
            times.push([without, with]);
            told = found;
        }
        let ratios = sorted(times.iter().map(|[without, with]| with / without));
        let [without, with] = [0, 1].map(|i| sorted(times.iter().map(|pair| pair[i]))[PAIRS / 2]);
        println!(
            "| {name} | {without:.4} | {with:.4} | {:.3} | {:.3} to {:.3} | {} of {} |",
            ratios[PAIRS / 2],
            ratios[PAIRS / 4],
            ratios[3 * PAIRS / 4],
            told.0,
            told.1
        );
    }
    Ok(())
}

/// CPU seconds, and how many of the planes have a covariance.
fn run(scans: &[Scan], estimate: Option<Estimate>) -> Outcome<(f64, (usize, usize))> {
    let begin = Usage::now()?;
    let mut mapper = Mapper::new(Params { estimate, ..Params::default() })?;
    for scan in scans {
        mapper.insert(scan)?;
    }
    let map = mapper.extract()?;
    let end = Usage::now()?;
    let told = map.planes.iter().filter(|plane| plane.estimate.is_some()).count();
    Ok((end.cpu - begin.cpu, (told, map.planes.len())))
}

fn synth(unstated: bool) -> Outcome<Vec<Scan>> {
    let made = terrace_synth::Scene::room().generate(&terrace_synth::Params::default())?;
    made.scans
        .into_iter()
        .map(|s| Ok(if unstated { s.scan.with_sigma(Sigma::Unknown)? } else { s.scan }))
        .collect()
}

/// One standard error per point.
fn sigmas(bytes: &[u8], points: usize) -> Outcome<Sigma> {
    let values: Vec<f32> = npyz::NpyFile::new(bytes)?.into_vec()?;
    if values.len() != points {
        return Err(format!("{} standard errors for {points} points", values.len()).into());
    }
    Ok(Sigma::PerPoint(values.into_iter().map(f64::from).collect()))
}

fn sorted(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values
}
