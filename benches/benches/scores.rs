//! The scoreboard: what the default settings find on every labelled scene of the data folder.
//!
//! `cargo bench -p terrace-benches --bench scores [-- [--clusters] [--join] [--moved] [--ablation] [--planes] [--csv FILE] [--export DIR] [--pictures DIR] SCENE...]`
//!
//! * `SCENE`: part of the name of a scene or group; without any, all are run.
//! * `--clusters`: planes as clusters of cells, with labels of cells.
//! * `--join`: planes that do not touch are joined where they are the same within their covariances.
//! * `--moved`: each scene again, turned at random and moved by 5000 km along each axis, with how many planes match that
//!   did not before, and how many are the same planes.
//! * `--ablation`: each scene again without each step of the method, and how far F1@.8 and weighted cover fall (or rise).
//! * `--planes`: under each scene, what became of every true plane and which found planes are of none; `goes on in` are the points
//!   labelled as of no plane that a small true plane goes on through.
//! * `--csv FILE`: all measures of `terrace_eval`, and those of here, as a table.
//! * `--export DIR`: points, true and found labels of each scene as files; `benches/peers/run` gives them to other programs.
//! * `--pictures DIR`: each scene as a picture, coloured by true planes and beside it by found ones.
//!
//! Columns: `F1 joined` is what F1@.8 would be had the parts of split planes been joined; `np` the share of the points
//! of no plane that a plane claims; `angle` the median, in degrees, of planes that match above one half, and `offset` theirs
//! in millimetres; `cell` the cell size in metres; `CPU s` that of one run from the first scan to the planes, not a median.
//! The best of other programs is with the best setting for that very scene.

use std::error::Error;
use std::path::PathBuf;
use std::process::ExitCode;

use terrace::{Join, Params, Regions, Scan};
use terrace_benches::ablation::Ablation;
use terrace_benches::beyond::beyond;
use terrace_benches::labelled::{Entry, Labelled, Motion, entries};
use terrace_benches::overlap::{Overlaps, Part};
use terrace_benches::{Score, export, peers, pictures, value};
use terrace_eval::{Contingency, Evaluation, Measure};

type Outcome<T> = Result<T, Box<dyn Error + Send + Sync>>;

/// The seed of the rotation of `--moved`.
const TURN: u64 = 1;

/// Heading, measure and decimals of each column.
const COLUMNS: [(&str, &str, usize); 19] = [
    ("points", "points", 0),
    ("true", "true_planes", 1),
    ("found", "found_planes", 1),
    ("F1@.5", "f1_50", 3),
    ("F1@.8", "f1_80", 3),
    ("F1 joined", "joined_f1_80", 3),
    ("P@.8", "precision_80", 3),
    ("R@.8", "recall_80", 3),
    ("wcov", "weighted_cover", 3),
    ("mean IoU", "mean_iou", 3),
    ("over", "over", 1),
    ("under", "under", 1),
    ("missed", "missed", 1),
    ("noise", "noise", 1),
    ("np", "non_planar_claimed", 3),
    ("angle", "angle_degrees_median", 3),
    ("offset", "offset_millimetres_median", 2),
    ("cell", "cell_size", 4),
    ("CPU s", "cpu_seconds", 3),
];

/// Those beside each other before and after a motion.
const BOTH: [(&str, &str, usize); 5] = [
    ("F1@.5", "f1_50", 3),
    ("F1@.8", "f1_80", 3),
    ("wcov", "weighted_cover", 3),
    ("found", "found_planes", 1),
    ("matched@.8", "matched_80", 1),
];

// Options of a command line are independent of each other.
#[allow(clippy::struct_excessive_bools)]
#[derive(Default)]
struct Args {
    clusters: bool,
    join: bool,
    moved: bool,
    ablation: bool,
    planes: bool,
    csv: Option<PathBuf>,
    export: Option<PathBuf>,
    pictures: Option<PathBuf>,
    scenes: Vec<String>,
}

/// A line of the table.
struct Row {
    name: String,
    group: &'static str,
    measures: Vec<Measure>,
    moved: Option<Moved>,
}

/// The same scene elsewhere.
struct Moved {
    measures: Vec<Measure>,
    /// Found planes that are there before and after, by an IoU above 0.8.
    same: usize,
}

fn main() -> ExitCode {
    if !std::env::args().any(|a| a == "--bench") {
        println!("nothing is measured without `cargo bench`");
        return ExitCode::SUCCESS;
    }
    match arguments().and_then(|args| board(&args)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn arguments() -> Outcome<Args> {
    let mut args = Args::default();
    let mut given = std::env::args().skip(1);
    while let Some(word) = given.next() {
        match word.as_str() {
            "--bench" => {}
            "--clusters" => args.clusters = true,
            "--join" => args.join = true,
            "--moved" => args.moved = true,
            "--ablation" => args.ablation = true,
            "--planes" => args.planes = true,
            "--csv" => args.csv = Some(given.next().ok_or("--csv FILE")?.into()),
            "--export" => args.export = Some(given.next().ok_or("--export DIR")?.into()),
            "--pictures" => args.pictures = Some(given.next().ok_or("--pictures DIR")?.into()),
            option if option.starts_with('-') => return Err(format!("unknown option {option}").into()),
            _ => args.scenes.push(word),
        }
    }
    Ok(args)
}

fn board(args: &Args) -> Outcome<()> {
    if args.ablation {
        return ablation(args);
    }
    let mut rows: Vec<Row> = Vec::new();
    let mut absent = Vec::new();
    for entry in entries()?.into_iter().filter(|entry| entry.is_meant(&args.scenes)) {
        let Some(scene) = entry.load()? else {
            absent.push(entry.name);
            continue;
        };
        rows.push(row(entry, &scene, args)?);
    }
    let rows = with_means(rows);
    println!();
    print_scores(&rows);
    if args.moved {
        println!();
        print_moved(&rows);
    }
    for name in absent {
        println!("\n{name} is left out: not in the data folder, set TERRACE_DATA");
    }
    if let Some(path) = &args.csv {
        std::fs::write(path, csv(&rows))?;
    }
    Ok(())
}

/// Groups of several scenes are shown by their mean.
fn ablation(args: &Args) -> Outcome<()> {
    let mut rows: Vec<(String, &'static str, Ablation)> = Vec::new();
    for entry in entries()?.into_iter().filter(|entry| entry.is_meant(&args.scenes)) {
        let Some(scene) = entry.load()? else { continue };
        eprintln!("{} ...", entry.name);
        rows.push((entry.name, entry.group, Ablation::of(&scene)?));
    }
    println!("{}", Ablation::heading());
    for group in rows.chunk_by(|a, b| !a.1.is_empty() && a.1 == b.1) {
        let of: Vec<&Ablation> = group.iter().map(|(_, _, of)| of).collect();
        match group {
            [(name, _, only)] => println!("{}", only.row(name)),
            [(_, group, _), ..] => {
                println!("{}", Ablation::mean(&of).row(&format!("{group}, mean of {}", of.len())));
            }
            [] => {}
        }
    }
    Ok(())
}

fn params(args: &Args) -> Params {
    match (args.clusters, args.join) {
        (true, _) => Params::clusters(),
        (false, true) => Params {
            regions: Some(Regions { join: Join::Coplanar, ..Regions::default() }),
            ..Params::default()
        },
        (false, false) => Params::default(),
    }
}

fn row(entry: Entry, scene: &Labelled, args: &Args) -> Outcome<Row> {
    eprintln!("{} ...", entry.name);
    let params = params(args);
    let score = Score::of(scene, params)?;
    if let Some(folder) = &args.export {
        export::write(folder, &entry, scene, &score)?;
    }
    if let Some(folder) = &args.pictures {
        pictures::write(folder, &entry, scene, &score)?;
    }
    if args.planes {
        print_planes(&entry.name, scene, &score);
    }
    let moved = if args.moved {
        let after = Score::of(&Motion::seeded(TURN)?.of(scene)?, params)?;
        let same = Contingency::of_numbers(&score.found, &after.found)?.matches(Evaluation::STRICT)?.matched;
        Some(Moved { measures: after.measures, same })
    } else {
        None
    };
    Ok(Row { name: entry.name, group: entry.group, measures: score.measures, moved })
}

/// After the scenes of each group of several, their mean.
fn with_means(rows: Vec<Row>) -> Vec<Row> {
    let mut all: Vec<Row> = Vec::new();
    let mut rows = rows.into_iter().peekable();
    while let Some(first) = rows.next() {
        let group = first.group;
        let begin = all.len();
        all.push(first);
        while let Some(next) = rows.next_if(|row| !group.is_empty() && row.group == group) {
            all.push(next);
        }
        let members = all.get(begin..).unwrap_or_default();
        if let [_, _, ..] = members {
            let of = |rows: Vec<Vec<Measure>>| Measure::means(&rows);
            let moved: Vec<&Moved> = members.iter().filter_map(|row| row.moved.as_ref()).collect();
            let mean = Row {
                name: format!("**{group}, mean of {}**", members.len()),
                group,
                measures: of(members.iter().map(|row| row.measures.clone()).collect()),
                moved: (!moved.is_empty()).then(|| Moved {
                    measures: of(moved.iter().map(|moved| moved.measures.clone()).collect()),
                    same: moved.iter().map(|moved| moved.same).sum::<usize>() / moved.len(),
                }),
            };
            all.push(mean);
        }
    }
    all
}

fn print_scores(rows: &[Row]) {
    let headings: Vec<&str> = COLUMNS.iter().map(|(heading, ..)| *heading).collect();
    println!("| scene | {} | best other: F1@.8 | wcov | program |", headings.join(" | "));
    println!("|---|{}---|---|---|", "---|".repeat(COLUMNS.len()));
    for row in rows {
        let other = peers::of(&row.name).or_else(|| peers::of(row.group)).map_or_else(
            || " |  | ".to_owned(),
            |p| format!("{:.3} | {} | {}", p.f1_80, number(p.weighted_cover, 3), p.program),
        );
        println!("| {} | {} | {other} |", row.name, cells(&row.measures, &COLUMNS));
    }
}

fn print_moved(rows: &[Row]) {
    let of = |when: &str| BOTH.map(|(heading, ..)| format!("{heading} {when}")).join(" | ");
    println!("| scene | {} | {} | more matched@.8 | same planes |", of("here"), of("moved"));
    println!("|---|{}---|---|", "---|".repeat(2 * BOTH.len()));
    for row in rows {
        let Some(moved) = &row.moved else { continue };
        let matched = |measures| value(measures, "matched_80").unwrap_or(f64::NAN);
        println!(
            "| {} | {} | {} | {:+.1} | {} |",
            row.name,
            cells(&row.measures, &BOTH),
            cells(&moved.measures, &BOTH),
            matched(&moved.measures) - matched(&row.measures),
            moved.same
        );
    }
}

fn cells(measures: &[Measure], columns: &[(&str, &str, usize)]) -> String {
    let cell = |(_, name, decimals): &(&str, &str, usize)| {
        let measure = measures.iter().find(|m| m.name == *name);
        let decimals = if measure.is_some_and(|m| m.count) { 0 } else { *decimals };
        number(measure.and_then(|m| m.value), decimals)
    };
    columns.iter().map(cell).collect::<Vec<_>>().join(" | ")
}

/// Empty when there is no value.
fn number(value: Option<f64>, decimals: usize) -> String {
    value.map(|v| format!("{v:.decimals$}")).unwrap_or_default()
}

fn csv(rows: &[Row]) -> String {
    let Some(first) = rows.first() else { return String::new() };
    let names = first.measures.iter().map(|m| m.name).collect::<Vec<_>>().join(",");
    let mut text = format!("scene,moved,{names}\n");
    for row in rows {
        let name = row.name.replace(['*', ','], "");
        let moved = row.moved.iter().map(|moved| (1, &moved.measures));
        for (after, measures) in std::iter::once((0, &row.measures)).chain(moved) {
            let values: Vec<String> =
                measures.iter().map(|m| m.value.map_or_else(String::new, |v| v.to_string())).collect();
            text.push_str(&format!("{name},{after},{}\n", values.join(",")));
        }
    }
    text
}

/// What became of each true plane, the worst first, and the found planes that are of none.
fn print_planes(name: &str, scene: &Labelled, score: &Score) {
    let overlaps = &score.overlaps;
    println!("\n{name}: true planes, the worst first\n");
    println!("| true | points | goes on in | best IoU | found: shared points of all its points |");
    println!("|---|---|---|---|---|");
    let mut planes: Vec<(f64, i32, u64)> = overlaps
        .truth()
        .filter(|(label, _)| *label > 0)
        .map(|(label, points)| (best(&overlaps.in_truth(label)), label, points))
        .collect();
    planes.sort_by(|a, b| a.0.total_cmp(&b.0));
    let all: Vec<Option<[f64; 3]>> =
        scene.scans.iter().flat_map(Scan::world_points).map(|p| p.map(|p| p.position)).collect();
    for (iou, label, points) in planes {
        let called = scene.planes.iter().find(|(id, _)| id.get().cast_signed() == label);
        let called = called.map(|(_, known)| known.name.as_str()).unwrap_or_default();
        let more = beyond(&scene.truth, &all, label).map(|more| more.to_string()).unwrap_or_default();
        let found = parts(&overlaps.in_truth(label));
        println!("| {label} {called} | {points} | {more} | {iou:.3} | {found} |");
    }
    print_found(name, score, overlaps);
}

fn print_found(name: &str, score: &Score, overlaps: &Overlaps) {
    println!("\n{name}: found planes that match none above 0.8\n");
    println!("| found | points | cells | rms mm | tilt | best IoU | true: shared points of all its points |");
    println!("|---|---|---|---|---|---|---|");
    for (label, points) in overlaps.found().filter(|(label, _)| *label > 0) {
        let truth = overlaps.in_found(label);
        let Some(plane) = score.planes.iter().find(|p| p.id.get().cast_signed() == label) else { continue };
        if best(&truth) <= Evaluation::STRICT {
            println!(
                "| {label} | {points} | {} | {:.1} | {} | {:.3} | {} |",
                plane.cells,
                1000.0 * plane.rms,
                number(plane.estimate.map(|estimate| estimate.largest_tilt()), 4),
                best(&truth),
                parts(&truth)
            );
        }
    }
}

/// The best IoU with a plane.
fn best(parts: &[Part]) -> f64 {
    parts.iter().filter(|part| part.label > 0).map(|part| part.iou).fold(0.0, f64::max)
}

fn parts(parts: &[Part]) -> String {
    let shown = |part: &Part| format!("{}: {} of {}", part.label, part.shared, part.points);
    parts.iter().take(8).map(shown).collect::<Vec<_>>().join(", ")
}
