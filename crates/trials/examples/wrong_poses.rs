//! Covariances of the planes of a room, with poses that are right, wrong and told so, and wrong without a word.

use std::num::NonZeroU32;

use terrace_calibration::table;
use terrace_noise::PoseNoise;
use terrace_synth::Scene;
use terrace_trials::{KnownPlace, Outcome, PointNoise, TrialError, Trials};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let place = KnownPlace::Built { scene: Box::new(Scene::room()), points: Some(60_000) };
    let right = Trials {
        copies: NonZeroU32::MIN.saturating_add(4),
        noise: PointNoise::Model("kinect".parse()?),
        cells: false,
        ..Trials::default()
    };
    let wrong = Trials { pose: Some(PoseNoise::from_degrees(0.01, 0.3)?), ..right.clone() };
    let untold = Trials { pose_told: false, ..wrong.clone() };
    let run = |trials: &Trials| -> Result<Outcome, TrialError> { trials.run(&place, || {}) };
    let [right, wrong, untold] = [run(&right)?, run(&wrong)?, run(&untold)?];
    print!(
        "{}",
        table(&[
            ("right", &right.planes),
            ("wrong by 1 cm and 0.3 deg, told", &wrong.planes),
            ("and untold", &untold.planes),
        ])
    );
    Ok(())
}
