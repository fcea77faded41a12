//! The search for φ on the uncertain clusters of real scans: that it is exact, and what it costs.
//!
//! For each scene: the certified search with no limit against the whole staircase, against a scan of evenly spaced φ, each a
//! clustering from nothing, and against a walk of the steps by such clusterings; and the CPU time of the search as
//! `extract` makes it beside that of building the grid and the normals. `--staircases DIR` writes the costs as JSON,
//! for the comparison with other optimisers.
//!
//! `cargo bench -p terrace-benches --bench phi [-- --staircases DIR]`

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use serde_json::json;
use terrace::{BetaStep, Mapper, Params, Scan, Search, UncertainCluster};
use terrace_benches::{Usage, scenes};
use terrace_cluster::{ClusterError, Grower};

/// How many φ the scan looks at, per cluster.
const DENSE: usize = 2000;
/// Longer staircases are not walked by clusterings from nothing: that takes minutes.
const NAIVE: usize = 8000;
/// Shorter staircases are found at once by any method, and are not written for the comparison.
const WORTH: usize = 20;
/// Sums in another order, relative.
const ROUNDING: f64 = 4e-9;

type Outcome<T> = Result<T, Box<dyn Error + Send + Sync>>;

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    if !args.iter().any(|a| a == "--bench") {
        println!("nothing is measured without `cargo bench`");
        return ExitCode::SUCCESS;
    }
    let folder =
        args.iter().position(|a| a == "--staircases").and_then(|at| args.get(at + 1)).map(PathBuf::from);
    table(folder.as_deref()).map_or_else(
        |error| {
            eprintln!("{error}");
            ExitCode::FAILURE
        },
        |()| ExitCode::SUCCESS,
    )
}

fn table(folder: Option<&Path>) -> Outcome<()> {
    // The search runs clusters in parallel; here its price is told of one thread.
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    println!(
        "| scene | clusters | most cells | steps | exact | grid s | normals s | search s | search / grid and normals | proven | \
         evaluations | all proven s | walk s | naive walk s |"
    );
    println!("|{}", "---|".repeat(14));
    for (name, params, scans) in [
        ("scenes/table", Params::clusters(), scenes::npy("scenes/table/points.npy")?),
        ("scenes/room300k", Params::clusters(), scenes::npy("scenes/room300k/points.npy")?),
        ("sevenscenes, frame 0", Params::clusters(), scenes::sevenscenes(0..1)?),
        ("sevenscenes, frame 500", Params::clusters(), scenes::sevenscenes(50..51)?),
        ("sevenscenes, 100 frames, paper", paper(), scenes::sevenscenes(0..100)?),
    ] {
        if scans.is_empty() {
            println!("| {name} | left out: not in the data folder, set TERRACE_DATA |");
            continue;
        }
        one.install(|| row(name, params, &scans, folder))?;
    }
    Ok(())
}

/// Settings of the paper's preset with which `reproduce` looks at the sequence.
fn paper() -> Params {
    Params { cell_size: Some(0.06), tau: Some(20), omega: 0.2, phi: 0.3, ..Params::paper() }
}

fn row(name: &str, params: Params, scans: &[Scan], folder: Option<&Path>) -> Outcome<()> {
    let start = Usage::cpu_now()?;
    let mut mapper = Mapper::new(params)?;
    for scan in scans {
        mapper.insert(scan)?;
    }
    let grid = Usage::cpu_now()?;
    let uncertain = mapper.uncertain_clusters()?;
    let clusters: Vec<UncertainCluster<'_>> = uncertain.iter().collect();
    let normals = Usage::cpu_now()?;
    let found = each(&clusters, |cluster| cluster.search(Search::default()))?;
    let searched = Usage::cpu_now()?;
    let proofs = each(&clusters, |cluster| cluster.search(Search::Certified { evaluations: None }))?;
    let proven = Usage::cpu_now()?;
    let staircases = each(&clusters, |cluster| cluster.staircase(usize::MAX))?;
    let walked = Usage::cpu_now()?;
    let naive = if staircases.iter().all(|s| s.len() <= NAIVE) {
        for (cluster, staircase) in clusters.iter().zip(&staircases) {
            walk_from_nothing(cluster, staircase)?;
        }
        format!("{:.3}", Usage::cpu_now()? - walked)
    } else {
        "-".into()
    };

    let mut exact = 0;
    for (index, ((cluster, proof), staircase)) in clusters.iter().zip(&proofs).zip(&staircases).enumerate() {
        let least = staircase.iter().map(|s| s.beta).fold(f64::INFINITY, f64::min);
        let same = (proof.value - least).abs() <= 0.0;
        exact += usize::from(proof.is_proven() && same && nothing_is_below(cluster, least)?);
        if let Some(folder) = folder.filter(|_| staircase.len() >= WORTH) {
            write(folder, &format!("{name}, cluster {index}"), staircase)?;
        }
    }
    let built = normals - start;
    println!(
        "| {name} | {} | {} | {} | {exact} of {} | {:.3} | {:.3} | {:.3} | {:.2} | {} | {} | {:.3} | {:.3} | {naive} |",
        clusters.len(),
        clusters.iter().map(UncertainCluster::cells).max().unwrap_or(0),
        staircases.iter().map(Vec::len).sum::<usize>(),
        clusters.len(),
        grid - start,
        normals - grid,
        searched - normals,
        (searched - normals) / built,
        found.iter().filter(|m| m.is_proven()).count(),
        found.iter().map(|m| m.evaluations).sum::<usize>(),
        proven - searched,
        walked - proven,
    );
    Ok(())
}

fn each<'m, T, E>(
    clusters: &[UncertainCluster<'m>],
    work: impl Fn(&UncertainCluster<'m>) -> Result<T, E>,
) -> Result<Vec<T>, E> {
    clusters.iter().map(work).collect()
}

/// The steps by a clustering from nothing for each: an error when one differs.
fn walk_from_nothing(cluster: &UncertainCluster<'_>, staircase: &[BetaStep]) -> Outcome<()> {
    let mut grower = grower(cluster)?;
    let mut phi = 0.0;
    for step in staircase {
        let run = grower.grow(phi)?;
        let beta = cluster.beta().of(&run.stair(), cluster.cells());
        if run.interval() != step.interval || (beta - step.beta).abs() > ROUNDING * beta {
            return Err(format!("at {phi}: {beta} on {:?}, not {step:?}", run.interval()).into());
        }
        phi = step.interval.hi.unwrap_or(1.0);
    }
    Ok(())
}

/// Whether no φ of an even scan of \[0, 1\] has a lower cost, by clusterings from nothing.
fn nothing_is_below(cluster: &UncertainCluster<'_>, least: f64) -> Outcome<bool> {
    let mut grower = grower(cluster)?;
    for place in 0..=DENSE {
        let run = grower.grow(place as f64 / DENSE as f64)?;
        if cluster.beta().of(&run.stair(), cluster.cells()) < least * (1.0 - ROUNDING) {
            return Ok(false);
        }
    }
    Ok(true)
}

fn grower<'c>(
    cluster: &'c UncertainCluster<'_>,
) -> Result<Grower<'c, impl Fn(usize) -> &'c [u32] + use<'c>>, ClusterError> {
    Grower::new(cluster.normals(), |cell| cluster.neighbours(cell), f64::INFINITY, cluster.seeds())
}

/// `value[i]` holds from `borders[i]` to `borders[i + 1]`.
fn write(folder: &Path, name: &str, staircase: &[BetaStep]) -> Outcome<()> {
    let mut borders: Vec<f64> = staircase.iter().map(|s| s.interval.lo).collect();
    borders.push(1.0);
    let values: Vec<f64> = staircase.iter().map(|s| s.beta).collect();
    let text =
        json!({ "name": name, "lo": 0.0, "hi": 1.0, "borders": borders, "values": values }).to_string();
    let file: String = name.chars().map(|c| if c.is_alphanumeric() { c } else { '-' }).collect();
    std::fs::create_dir_all(folder)?;
    std::fs::write(folder.join(file).with_extension("json"), text)?;
    Ok(())
}
