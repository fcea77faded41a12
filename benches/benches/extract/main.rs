//! Points per CPU second and peak memory of a whole extraction, stage by stage.
//!
//! Every case runs in a process of its own, so that its peak of memory is its own: this program starts itself again with
//! the case as its argument, three times, and prints the run of median CPU time.
//!
//! The stages are those of the first extraction of its process, for which the system hands out all memory anew, page by page. Then the same
//! scans are extracted again, as a program does that goes on: the last of three is printed beside, as a whole.
//!
//! `cargo bench -p terrace-benches --bench extract`
//!
//! With `--growth` the place grows with the points instead: [`growth`].

mod growth;

use std::error::Error;
use std::process::{Command, ExitCode, Stdio};
use std::time::Instant;

use rayon::ThreadPool;
use terrace::{Mapper, Params, Scan, Stage};
use terrace_benches::{Usage, scenes};
use terrace_synth::{Scene, SceneKind};

const RUNS: usize = 3;
/// Extractions in a process.
const TIMES: usize = 3;
const ROOM: &str = "scenes/room300k/points.npy";
const INPUTS: [&str; 3] = ["room300k", "synth:300000", "synth:3000000"];
const PRESETS: [&str; 2] = ["default", "clusters"];
const STAGES: [&str; 6] = ["load", "grid", "normals", "grow or cluster", "optimise", "label"];

type Outcome<T> = Result<T, Box<dyn Error + Send + Sync>>;

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let outcome = match args.iter().position(|a| a == "--case") {
        Some(at) => case(&args[at + 1..]),
        None if args.iter().any(|a| a == "--bench") => match args.iter().position(|a| a == "--growth") {
            Some(at) => growth::table(args.get(at + 1).map(String::as_str)),
            None => table(),
        },
        None => {
            println!("nothing is measured without `cargo bench`");
            Ok(())
        }
    };
    outcome.map_or_else(
        |error| {
            eprintln!("{error}");
            ExitCode::FAILURE
        },
        |()| ExitCode::SUCCESS,
    )
}

/// Seconds of CPU per stage, the load first, then points, planes, MiB held as input and at the peak, and seconds by the clock of all but
/// the load; of the last extraction seconds of CPU and by the clock; seconds that the system worked in the first.
type Row = [f64; STAGES.len() + 8];

fn table() -> Outcome<()> {
    println!(
        "| input | preset | points | threads | {} | all but load | by the clock | points per CPU second | again, CPU | by the clock | points per CPU second | input MiB | peak MiB | planes |",
        STAGES.join(" | ")
    );
    println!("|{}", "---|".repeat(STAGES.len() + 13));
    for input in INPUTS {
        if input == "room300k" && scenes::path(ROOM).is_none() {
            println!();
            println!("{input} is left out: no such file in the data folder, set TERRACE_DATA");
            continue;
        }
        for (preset, threads) in PRESETS.into_iter().flat_map(|preset| [(preset, "1"), (preset, "2")]) {
            let mut rows = (0..RUNS).map(|_| run(input, preset, threads)).collect::<Outcome<Vec<Row>>>()?;
            rows.sort_by(|a, b| work(a).total_cmp(&work(b)));
            print_row(input, preset, threads, &rows[RUNS / 2]);
        }
    }
    Ok(())
}

/// CPU seconds of everything but the load.
fn work(row: &Row) -> f64 {
    row[1..STAGES.len()].iter().sum()
}

fn print_row(input: &str, preset: &str, threads: &str, row: &Row) {
    let [points, planes, held, peak, clock, again, again_clock, _] =
        std::array::from_fn(|i| row[STAGES.len() + i]);
    let stages: Vec<String> = row[..STAGES.len()].iter().map(|s| format!("{s:.3}")).collect();
    println!(
        "| {input} | {preset} | {points} | {threads} | {} | {:.3} | {clock:.3} | {:.2e} | {again:.3} | {again_clock:.3} | {:.2e} | {held:.0} | {peak:.0} | {planes} |",
        stages.join(" | "),
        work(row),
        points / work(row),
        points / again
    );
}

fn run(input: &str, preset: &str, threads: &str) -> Outcome<Row> {
    let child = Command::new(std::env::current_exe()?)
        .args(["--case", input, preset, threads])
        .stderr(Stdio::inherit())
        .output()?;
    let text = String::from_utf8(child.stdout)?;
    let numbers = text.split_whitespace().map(str::parse).collect::<Result<Vec<f64>, _>>()?;
    Row::try_from(numbers)
        .map_err(|_| format!("the case {input}, {preset}, on {threads} threads failed").into())
}

/// One case, in a process of its own: prints its row as numbers.
fn case(args: &[String]) -> Outcome<()> {
    let [input, preset, threads] = args else { return Err("--case INPUT PRESET THREADS".into()) };
    let params = if preset == "clusters" { Params::clusters() } else { Params::default() };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.parse()?).build()?;
    // By the threads that work on them, so that the system has placed these on its processors before the clock begins.
    let scans = pool.install(|| load(input))?;
    let loaded = Usage::now()?;
    let first = Extraction::of(&scans, params, &pool)?;
    let mut last = first;
    for _ in 1..TIMES {
        last = Extraction::of(&scans, params, &pool)?;
    }
    let mut row = first.stages.to_vec();
    row[0] = loaded.cpu;
    row.extend([first.points as f64, first.planes as f64, loaded.resident, first.peak, first.clock]);
    row.extend([last.stages.iter().sum(), last.clock, first.system]);
    println!("{}", row.iter().map(f64::to_string).collect::<Vec<_>>().join(" "));
    Ok(())
}

/// What an extraction took.
#[derive(Clone, Copy)]
struct Extraction {
    /// Seconds of CPU per stage; none for the load.
    stages: [f64; STAGES.len()],
    /// Seconds by the clock.
    clock: f64,
    /// Seconds that the system worked.
    system: f64,
    /// MiB at the peak, so far.
    peak: f64,
    points: usize,
    planes: usize,
}

impl Extraction {
    fn of(scans: &[Scan], params: Params, pool: &ThreadPool) -> Outcome<Self> {
        let system = Usage::system_now()?;
        let (before, began) = (Usage::cpu_now()?, Instant::now());
        let mut mapper = Mapper::new(params)?;
        mapper.reserve(scans.iter().map(Scan::len).sum());
        pool.install(|| scans.iter().try_for_each(|scan| mapper.insert(scan).map(drop)))?;
        let gridded = Usage::cpu_now()?;
        // From the last scan to the first stage nothing but the threads is made ready.
        let mut begun = vec![(1, before), (2, gridded)];
        let mut failed = None;
        let inserted = mapper.len();
        let map = pool.install(|| {
            mapper.into_planes(|stage| match Usage::cpu_now() {
                Ok(now) => begun.push((column(stage), now)),
                Err(error) => failed = Some(error),
            })
        })?;
        if let Some(error) = failed {
            return Err(error.into());
        }
        let (end, clock) = (Usage::now()?, began.elapsed().as_secs_f64());
        let system = Usage::system_now()? - system;
        begun.push((STAGES.len(), end.cpu));
        let mut stages = [0.0; STAGES.len()];
        for pair in begun.windows(2) {
            stages[pair[0].0] += pair[1].1 - pair[0].1;
        }
        Ok(Self { stages, clock, system, peak: end.peak, points: inserted, planes: map.planes.len() })
    }
}

/// The place of a stage among [`STAGES`].
fn column(stage: Stage) -> usize {
    match stage {
        Stage::Normals { .. } => 2,
        Stage::Grow { .. } | Stage::Cluster { .. } => 3,
        Stage::Optimise { .. } => 4,
        Stage::Label { .. } => 5,
    }
}

fn load(input: &str) -> Outcome<Vec<Scan>> {
    let scenes = [("synth:", SceneKind::Room), ("building:", SceneKind::Building)];
    if let Some((points, kind)) =
        scenes.into_iter().find_map(|(prefix, kind)| Some((input.strip_prefix(prefix)?, kind)))
    {
        let points = points.parse()?;
        let params = terrace_synth::Params { points: Some(points), ..Default::default() };
        let scene = Scene::sized(kind, points);
        // A view at a time, so that labels, which are not needed here, do not raise the peak.
        return Ok(scene.chunks(&params, usize::MAX)?.map(|chunk| chunk.scan.scan).collect());
    }
    scenes::npy(ROOM)
}
