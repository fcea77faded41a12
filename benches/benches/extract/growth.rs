//! What a point costs as a place grows, a building of rooms that are all alike: a method that is linear takes the same for each.
//!
//! `cargo bench -p terrace-benches --bench extract -- --growth [POINTS]`, from 10⁵ points to ten times as many and so on, up to 10⁷ or
//! POINTS; on one thread, with all points in memory. Of a large place much of the time is the system handing out memory for the first time:
//! how much is told where it takes so long that the system's count of hundredths of a second tells it, and by the last of three
//! extractions.

use crate::{Outcome, RUNS, Row, STAGES, run, work};

const FEWEST: usize = 100_000;
const MOST: usize = 10_000_000;
/// Seconds from which on the system's part of them is told.
const LONG: f64 = 1.0;

/// Prints a row for each number of points, and how far rows are apart.
pub(crate) fn table(most: Option<&str>) -> Outcome<()> {
    // Cargo adds its own argument after those that are given to it.
    let most = most.filter(|most| *most != "--bench").map(str::parse).transpose()?.unwrap_or(MOST);
    println!("CPU nanoseconds a point, the run of {RUNS} that takes least");
    println!(
        "| points | {} | all but load | by the system | again, the last of three | bytes a point at the peak | peak MiB | planes |",
        STAGES.join(" | ")
    );
    println!("|{}", "---|".repeat(STAGES.len() + 7));
    let (mut all, mut again) = (Vec::new(), Vec::new());
    let sizes = std::iter::successors(Some(FEWEST), |points| points.checked_mul(10));
    for points in sizes.take_while(|points| *points <= most) {
        let input = format!("building:{points}");
        let runs = (0..RUNS).map(|_| run(&input, "default", "1")).collect::<Outcome<Vec<Row>>>()?;
        let Some(row) = runs.iter().min_by(|a, b| work(a).total_cmp(&work(b))) else { continue };
        let (first, last) = print_row(row);
        all.push(first);
        again.push(last);
    }
    println!();
    println!(
        "the most for a point is {:.2} times the least, and {:.2} times where the process has had the memory before",
        spread(&all),
        spread(&again)
    );
    Ok(())
}

/// The largest in units of the least.
fn spread(all: &[f64]) -> f64 {
    let (low, high) = all.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), x| (low.min(*x), high.max(*x)));
    high / low
}

/// What a point costs without the load, the first time and the last.
fn print_row(row: &Row) -> (f64, f64) {
    let [points, planes, _, peak, _, again, _, system] = std::array::from_fn(|i| row[STAGES.len() + i]);
    let a_point = |seconds: f64| 1e9 * seconds / points;
    let stages: Vec<String> = row[..STAGES.len()].iter().map(|s| format!("{:.0}", a_point(*s))).collect();
    let (all, again) = (a_point(work(row)), a_point(again));
    let system = if work(row) >= LONG { format!("{:.0}", a_point(system)) } else { String::new() };
    let bytes = peak * 1_048_576.0 / points;
    let stages = stages.join(" | ");
    println!(
        "| {points} | {stages} | {all:.0} | {system} | {again:.0} | {bytes:.0} | {peak:.0} | {planes} |"
    );
    (all, again)
}
