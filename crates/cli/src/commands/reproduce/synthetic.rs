//! Section VI-A: three planes in a table-like structure.

use terrace::{Params, PlaneId, PlaneMap, Scan};
use terrace_draw::{Bounds, CloudPicture, Image, Sample, Staircase, Step, View, label_colour};
use terrace_io::write_atomically;
use terrace_synth::{LabelledScan, Params as SynthParams, Scene};

use super::runs::{Runs, insert, row, run as run_all};
use crate::args::ReproduceArgs;
use crate::error::CliError;
use crate::picture::write_png;

/// What Table I of the paper prints.
const PAPER: &str = "  paper, without optimisation          0.34   0.18   0.34\n  paper, with optimisation             0.09   0.13   0.15\n";

/// The staircase of the figure is walked no further.
const MOST_STEPS: usize = 20_000;

/// Runs the seeds and prints Table I for each; the figures are of the first.
pub fn run(args: &ReproduceArgs) -> Result<(), CliError> {
    outln!("Section VI-A: three planes in a table-like structure, initial phi 0.97\n");
    let mut held = 0;
    for seed in args.seed..args.seed.saturating_add(args.seeds) {
        let truth =
            Scene::desk().generate(&SynthParams { points: Some(70_000), sigma: Some(0.008), seed })?.merged();
        let runs = run_all(params(seed), |mapper| insert(mapper, &truth.scan))?;
        held += u64::from(report(seed, &truth, &runs));
        if seed == args.seed {
            figures(args, &truth.scan, &runs)?;
        }
    }
    outln!("the pattern of Table I holds for {held} of {} seeds", args.seeds);
    outln!("figures: {}/fig1.png, staircase.png, staircase.svg\n", args.out.display());
    Ok(())
}

fn params(seed: u64) -> Params {
    Params {
        cell_size: Some(0.03),
        omega: 0.4,
        phi: 0.97,
        // 'More than 5 cells'.
        min_cells: 6,
        seed,
        ..Params::paper()
    }
}

/// Prints the table of one seed, and answers whether the paper's pattern is there: planes merged before; after, exactly
/// three clusters, each at least 98 % from one plane, and less uncertainty on every axis on which it was above 0.3.
fn report(seed: u64, truth: &LabelledScan, runs: &Runs) -> bool {
    let (before, after) = (purity(&runs.without, truth), purity(&runs.share, truth));
    outln!("Table I, seed {seed}                       s_x    s_y    s_z  clusters");
    out!("{PAPER}");
    out!("{}", row("without optimisation", &runs.without));
    out!("{}", row("with optimisation, share", &runs.share));
    out!("{}", row("with optimisation, sum as printed", &runs.sum));
    let phis: Vec<String> = runs
        .share
        .optimised
        .iter()
        .map(|o| {
            format!(
                "{:.2} ({} evaluations of {} samples)",
                o.minimum.x[0], o.minimum.evaluations, o.minimum.calls
            )
        })
        .collect();
    outln!("  best phi {}; least pure cluster {before:.3} before, {after:.3} after", phis.join(", "));
    let merged = before < 0.98;
    let pure = runs.share.planes.len() == 3 && after >= 0.98;
    let mean = |map: &PlaneMap| map.summary().normal_uncertainty_mean;
    let falls = match (mean(&runs.without), mean(&runs.share)) {
        (Some(before), Some(after)) => (0..3).all(|axis| before[axis] <= 0.3 || after[axis] < before[axis]),
        _ => false,
    };
    let verdict = |holds: bool| if holds { "yes" } else { "NO" };
    outln!(
        "  planes merged before: {}; three pure clusters after: {}; uncertainty falls: {}\n",
        verdict(merged),
        verdict(pure),
        verdict(falls)
    );
    merged && pure && falls
}

/// The share of points from one true plane in the least pure cluster; 0 without clusters.
fn purity(map: &PlaneMap, truth: &LabelledScan) -> f64 {
    let planes = truth.labels.iter().flatten().map(|id| id.get() as usize).max().unwrap_or(0);
    let mut counts = vec![vec![0_usize; planes + 1]; map.planes.len()];
    for (found, real) in map.labels.iter().zip(&truth.labels) {
        if let Some(found) = found {
            counts[found.index()][real.map_or(0, |id| id.get() as usize)] += 1;
        }
    }
    let share = |of: &Vec<usize>| {
        let (all, most) = (of.iter().sum::<usize>(), of.iter().skip(1).max().copied().unwrap_or(0));
        most as f64 / all.max(1) as f64
    };
    counts.iter().map(share).reduce(f64::min).unwrap_or(0.0)
}

fn figures(args: &ReproduceArgs, scan: &Scan, runs: &Runs) -> Result<(), CliError> {
    let points: Vec<[f64; 3]> = scan.world_points().flatten().map(|p| p.position).collect();
    let Some(bounds) = Bounds::of(points.iter().copied()) else { return Ok(()) };
    let view = |title: &str, labels: &[Option<PlaneId>]| -> Result<Image, CliError> {
        let mut picture =
            CloudPicture::new(900, 700, View::from_degrees(-115.0, 25.0)?, bounds)?.with_title(title);
        for (point, label) in points.iter().zip(labels) {
            picture.add(*point, label_colour(*label));
        }
        Ok(picture.image())
    };
    let before = view("(a) phi = 0.97", &runs.without.labels)?;
    let best = runs.share.optimised.first().map_or(f64::NAN, |o| o.minimum.x[0]);
    let after = view(&format!("(b) after optimisation, phi = {best:.2}"), &runs.share.labels)?;
    write_png(&args.out.join("fig1.png"), &Image::beside(&before, &after)?.png()?)?;

    let Some(optimised) = runs.share.optimised.first() else { return Ok(()) };
    let clusters = runs.mapper.uncertain_clusters()?;
    let Some(merged) = clusters.get(0) else { return Ok(()) };
    let steps = merged.staircase(MOST_STEPS)?;
    // Near 0 every cell is a cluster of its own and the cost many times higher: the interesting part would be flat.
    let top = 2.0 * steps.last().map_or(f64::INFINITY, |s| s.beta);
    let chart = Staircase {
        title: "cost of the merged cluster, steep start cut off".into(),
        steps: steps
            .iter()
            .filter(|s| s.beta <= top)
            .map(|s| Step { low: s.interval.lo, high: s.interval.hi.unwrap_or(1.0).min(1.0), value: s.beta })
            .collect(),
        samples: optimised
            .minimum
            .trace
            .iter()
            .filter(|t| t.value <= top)
            .map(|t| Sample { x: t.x[0], value: t.value, evaluated: t.source == terrace::Source::Evaluated })
            .collect(),
        best: Some([optimised.minimum.x[0], optimised.minimum.value]),
        ..Staircase::new("φ", "β", [0.0, 1.0])
    };
    write_png(&args.out.join("staircase.png"), &chart.png(1600, 960)?)?;
    let svg = chart.svg(800, 480)?;
    write_atomically(&args.out.join("staircase.svg"), |out| Ok(out.write_all(svg.as_bytes())?))?;
    let least = steps.iter().map(|s| s.beta).reduce(f64::min).unwrap_or(f64::NAN);
    outln!(
        "  staircase of the merged cluster: {} steps, least cost {least:.4}; the random search found {:.4}\n",
        steps.len(),
        optimised.minimum.value
    );
    Ok(())
}
