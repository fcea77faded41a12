//! Prints how well the covariances of the planes of a table are calibrated.

use std::num::NonZeroU32;

use terrace_calibration::table;
use terrace_noise::PoseNoise;
use terrace_synth::Scene;
use terrace_trials::{KnownPlace, PointNoise, Trials};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let args: Vec<String> = std::env::args().collect();
    let scene = Scene::new(args[1].parse()?);
    let copies = NonZeroU32::new(args[2].parse()?).ok_or("no copies")?;
    let noise = match args.get(3).map(String::as_str) {
        None | Some("own") => PointNoise::Own,
        Some(model) => PointNoise::Model(model.parse()?),
    };
    let place =
        KnownPlace::Built { scene: Box::new(scene), points: args.get(4).map(|n| n.parse()).transpose()? };
    let flag = |name: &str| args.iter().any(|a| a == name);
    let trials = Trials {
        copies,
        noise,
        told: !flag("unknown"),
        pose: if flag("pose") { Some(PoseNoise::from_degrees(0.01, 0.3)?) } else { None },
        pose_told: !flag("untold"),
        ..Trials::default()
    };
    let outcome = trials.run(&place, || {})?;
    let mut rows = vec![("planes", &outcome.planes), ("mixed", &outcome.mixed), ("cells", &outcome.cells)];
    rows.extend(outcome.by_plane.iter().map(|(name, of)| (name.as_str(), of)));
    print!("{}", table(&rows));
    let share = |e: &terrace_calibration::Exceedance| e.share().map(|s| (s.hits(), s.of(), s.value()));
    println!(
        "min-max exceeded: planes {:?} cells {:?}",
        share(&outcome.plane_bounds),
        share(&outcome.cell_bounds)
    );
    println!("unmatched {} without {} grown {}", outcome.unmatched, outcome.without, outcome.grown);
    Ok(())
}
