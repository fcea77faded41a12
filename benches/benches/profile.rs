//! Where the time of the default method goes, part by part, beside what it takes to only read the points.
//!
//! `cargo bench -p terrace-benches --bench profile [-- POINTS]`
//!
//! The parts are called as `Mapper` calls them, on one thread, each after the other, five times; CPU time is that of the fastest run of
//! each part: what others do on the machine only adds.

use std::error::Error;
use std::hint::black_box;
use std::num::NonZeroU32;

use terrace::choose_cell_size;
use terrace_benches::Usage;
use terrace_grid::{CellId, Motion, PointErrors, VoxelGrid};
use terrace_regions::{Cell, Field, Sample, Samples, Settings, find};
use terrace_synth::Scene;
use terrace_types::{Frame, Sigma};

type Outcome<T> = Result<T, Box<dyn Error + Send + Sync>>;

const RUNS: usize = 5;
const PARTS: [&str; 8] = [
    "read the points: sum of their coordinates",
    "choose the cell size",
    "to the world, cells and sums",
    "samples",
    "cells of the cell size",
    "regions as cells",
    "find regions",
    "label and measure points",
];

fn main() -> Outcome<()> {
    if !std::env::args().any(|a| a == "--bench") {
        println!("nothing is measured without `cargo bench`");
        return Ok(());
    }
    let asked = std::env::args().skip(1).find_map(|a| a.parse().ok());
    let points: usize = asked.unwrap_or(3_000_000);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    pool.install(|| profile(points))
}

fn profile(points: usize) -> Outcome<()> {
    let params = terrace_synth::Params { points: Some(points), ..Default::default() };
    let scene = Scene::room();
    let scans: Vec<_> = scene.chunks(&params, usize::MAX)?.map(|chunk| chunk.scan.scan).collect();
    let mut best = [f64::INFINITY; PARTS.len()];
    let (mut planes, mut occupied) = (0, 0);
    for _ in 0..RUNS {
        let mut clock = Usage::cpu_now()?;
        let mut part = 0;
        let mut done = |best: &mut [f64; PARTS.len()]| -> Outcome<()> {
            let now = Usage::cpu_now()?;
            best[part] = best[part].min(now - clock);
            part += 1;
            clock = now;
            Ok(())
        };
        let all = scans.iter().flat_map(terrace::Scan::points);
        black_box(all.fold([0.0; 3], |sum, p| [sum[0] + p[0], sum[1] + p[1], sum[2] + p[2]]));
        done(&mut best)?;
        let first = scans.first().ok_or("no scan")?;
        let size = choose_cell_size(first).ok_or("no cell size")?.cell_size;
        done(&mut best)?;
        let mut grid = VoxelGrid::of_halves(size)?;
        let mut kept = Vec::new();
        for scan in &scans {
            let points = scan.points();
            let (mut cells, mut places) =
                (Vec::with_capacity(points.len()), Vec::with_capacity(points.len()));
            let errors = match scan.sigma() {
                Sigma::PerPoint(all) => PointErrors::Each(all),
                _ => PointErrors::None,
            };
            let pose = match scan.frame() {
                Frame::Sensor { pose } => Some(pose),
                Frame::World { .. } => None,
            };
            let motion = pose.map(|pose| {
                move |from: &[[f64; 3]], to: &mut [[f64; 3]]| {
                    to.iter_mut().zip(from).for_each(|(to, from)| *to = pose.transform(*from));
                }
            });
            let motion = motion.as_ref().map(|motion| motion as &Motion<'_>);
            grid.insert_alone(points, motion, errors, &mut cells, Some(&mut places))?;
            kept.push((cells, places));
        }
        done(&mut best)?;
        let mut samples = Samples::new(grid.place_unit());
        let number = |cell: &Option<CellId>| cell.and_then(|cell| u32::try_from(cell.index()).ok());
        for (cells, places) in &kept {
            samples.push_all(|at| number(&cells[at]), places);
        }
        done(&mut best)?;
        black_box(grid.halved()?);
        done(&mut best)?;
        let fine: Vec<Cell> = grid
            .founded()
            .map(|cell| Cell { key: cell.key(), is_wide: false, stats: cell.stats() })
            .collect();
        done(&mut best)?;
        let found = find(
            Field::of(&fine, grid.cell_size())?,
            points as u64,
            |cell| u32::try_from(cell).map_or(Sample::EMPTY, |cell| samples.sample(cell)),
            &Settings::default(),
        )?;
        done(&mut best)?;
        let mut labels: Vec<Option<NonZeroU32>> = vec![None; points];
        let mut rest = &mut labels[..];
        #[allow(clippy::cast_possible_truncation, reason = "a power of two")]
        let unit = grid.place_unit() as f32;
        for (cells, places) in &kept {
            let (of_scan, others) = rest.split_at_mut(cells.len());
            rest = others;
            let points = cells.iter().zip(places).zip(of_scan);
            let points =
                points.map(|((cell, place), to)| (number(cell), place.map(|x| f32::from(x) * unit), to));
            let set = |to: &mut Option<NonZeroU32>, label: Option<u32>| {
                *to = label.and_then(|label| NonZeroU32::new(label + 1));
            };
            black_box(found.labeller.label_all(points, set));
        }
        black_box(&labels);
        done(&mut best)?;
        (planes, occupied) = (found.regions.len(), fine.len());
    }
    println!("{points} points, {occupied} cells, {planes} planes");
    println!("| part | ms | ns per point |\n|---|---|---|");
    for (part, seconds) in PARTS.iter().zip(best) {
        println!("| {part} | {:.1} | {:.2} |", 1e3 * seconds, 1e9 * seconds / points as f64);
    }
    let all: f64 = best[1..].iter().sum();
    println!("| all but reading | {:.1} | {:.2} |", 1e3 * all, 1e9 * all / points as f64);
    Ok(())
}
