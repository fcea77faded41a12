//! Copies of known planes: right covariances are found right, wrong ones wrong, and the same on any number of threads.

#![allow(clippy::unwrap_used, reason = "tests")]

use std::num::NonZeroU32;
use std::sync::atomic::{AtomicU32, Ordering};

use terrace::{Params, ParamsError};
use terrace_noise::PoseNoise;
use terrace_synth::{LabelledScan, Scene, SynthError};
use terrace_trials::{KnownPlace, Outcome, PointNoise, TrialError, Trials};
use terrace_types::{Frame, PlaneId, Pose, Scan, Sigma};

fn trials(copies: u32) -> Trials {
    Trials { copies: NonZeroU32::new(copies).unwrap(), ..Trials::default() }
}

fn table() -> KnownPlace {
    KnownPlace::Built { scene: Box::new(Scene::table()), points: Some(10_000) }
}

fn run(trials: &Trials, place: &KnownPlace) -> Outcome {
    trials.run(place, || {}).unwrap()
}

/// A floor and a wall without noise, as one scan of a sensor.
fn corner() -> Vec<LabelledScan> {
    let mut points = Vec::new();
    let mut labels = Vec::new();
    for i in 0..80 {
        for j in 0..80 {
            let (u, v) = (0.02 * f64::from(i) + 0.004, 0.02 * f64::from(j) + 0.004);
            points.extend([[u, v, -1.0], [-0.5, u, v - 1.0]]);
            labels.extend([PlaneId::new(1), PlaneId::new(4)]);
        }
    }
    let frame = Frame::Sensor { pose: Pose::IDENTITY };
    vec![LabelledScan { scan: Scan::new(points, Sigma::Unknown, frame).unwrap(), labels }]
}

#[test]
fn white_noise_that_is_told_is_calibrated() {
    let done = AtomicU32::new(0);
    let outcome = trials(12)
        .run(&table(), || {
            done.fetch_add(1, Ordering::Relaxed);
        })
        .unwrap();
    assert_eq!((outcome.copies, done.into_inner()), (12, 12));
    for calibration in [&outcome.planes, &outcome.cells] {
        let ([low, high], nees) = (calibration.nees_band(0.999).unwrap(), calibration.nees().unwrap());
        assert!((low..high).contains(&nees), "{low} {nees} {high}");
    }
    let of_planes: usize = outcome.by_plane.iter().map(|(_, of)| of.count()).sum();
    assert_eq!(of_planes, outcome.planes.count());
}

#[test]
fn one_thread_gives_the_same_as_two() {
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| run(&trials(3), &table()))
    };
    assert_eq!(with(1), with(2));
}

#[test]
fn outcomes_are_added_in_any_order() {
    let parts: Vec<Outcome> =
        [1, 2, 3].map(|seed| run(&Trials { seed, cells: false, ..trials(1) }, &table())).to_vec();
    let merged = |order: [usize; 3]| {
        let mut all = parts[order[0]].clone();
        all.merge(&parts[order[1]]).unwrap();
        all.merge(&parts[order[2]]).unwrap();
        let mut values = all.planes.values().to_vec();
        values.sort_by(f64::total_cmp);
        (all.copies, values, all.unmatched, all.without, all.grown, all.plane_bounds)
    };
    assert_eq!(merged([0, 1, 2]), merged([2, 0, 1]));
    assert_eq!(merged([0, 1, 2]).0, 3);
}

#[test]
fn outcomes_of_different_places_are_not_added() {
    let one = Trials { cells: false, ..trials(1) };
    let mut outcome = run(&one, &table());
    let strip = KnownPlace::Built { scene: Box::new(Scene::strip()), points: Some(3_000) };
    let before = outcome.clone();
    assert!(matches!(outcome.merge(&run(&one, &strip)), Err(TrialError::Places { .. })));
    assert_eq!(outcome, before);
}

#[test]
fn poses_that_are_wrong_without_a_word_are_seen() {
    let place = KnownPlace::Built { scene: Box::new(Scene::room()), points: Some(60_000) };
    let pose = Some(PoseNoise::from_degrees(0.02, 0.3).unwrap());
    let told =
        Trials { pose, cells: false, noise: PointNoise::Model("kinect".parse().unwrap()), ..trials(2) };
    let untold = Trials { pose_told: false, ..told.clone() };
    let [told, untold] = [told, untold].map(|trials| run(&trials, &place).planes.nees().unwrap());
    assert!(untold > 4.0 * told && untold > 4.0, "{told} {untold}");
}

#[test]
fn errors_that_are_not_told_are_found_out() {
    let outcome = run(&Trials { told: false, cells: false, ..trials(4) }, &table());
    let nees = outcome.planes.nees().unwrap();
    assert!((0.3..3.0).contains(&nees), "{nees}");
}

#[test]
fn exact_scans_know_their_planes() {
    let place = KnownPlace::of_exact_scans(corner());
    let planes = place.planes();
    assert_eq!(planes.iter().map(|p| p.id.get()).collect::<Vec<_>>(), [1, 4]);
    assert!(planes[0].plane.signed_distance([0.3, 0.3, -1.0]).abs() < 1e-12);
    assert!(planes[1].plane.signed_distance([-0.5, 0.3, 0.0]).abs() < 1e-12);
    let noise = PointNoise::Model("uniform:0.005".parse().unwrap());
    let outcome = run(&Trials { noise, ..trials(10) }, &place);
    let [low, high] = outcome.planes.nees_band(0.999).unwrap();
    let nees = outcome.planes.nees().unwrap();
    assert!(outcome.planes.count() >= 10 && (low..high).contains(&nees), "{low} {nees} {high}");
}

#[test]
fn what_cannot_be_tried_is_refused() {
    let corner = KnownPlace::of_exact_scans(corner());
    assert!(matches!(trials(1).run(&corner, || {}), Err(TrialError::NoErrors)));

    let none = KnownPlace::Built { scene: Box::new(Scene::table()), points: Some(0) };
    assert!(matches!(trials(1).run(&none, || {}), Err(TrialError::Synth(SynthError::NoPoints))));

    let pose = Some(PoseNoise::from_degrees(0.01, 0.1).unwrap());
    let in_world = Trials { pose, ..trials(1) };
    assert!(matches!(in_world.run(&table(), || {}), Err(TrialError::Misplaced(_))));

    let params = Params { phi: 2.0, ..Params::default() };
    let refused = Trials { params, ..trials(1) }.run(&table(), || {});
    assert!(matches!(refused, Err(TrialError::Params(ParamsError { name: "phi", .. }))));
}
