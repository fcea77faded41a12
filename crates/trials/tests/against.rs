//! Scans of a room against each other: the ratio of errors is near 1 where all is told, above it where poses are wrong.

#![allow(clippy::unwrap_used, reason = "tests")]

use terrace::{Estimate, Mapper, Params, PoseNoise};
use terrace_synth::{LabelledScan, Scene, misplaced, perturbed};
use terrace_trials::{Agreement, Look, Ratio, Reference, Scatter, TrialError, scans_against_each_other};
use terrace_types::{Frame, Pose, Scan, Sigma};

const VIEWS: usize = 3;

/// The views of a room with white noise, without the ball, the pillar and other things that are not flat.
fn room(seed: u64) -> Vec<(Scan, Option<PoseNoise>)> {
    let params = terrace_synth::Params { points: Some(200_000), sigma: Some(0.0), seed };
    let views = Scene::room().generate(&params).unwrap().scans;
    let flat = views.into_iter().zip(0..).map(|(LabelledScan { scan, labels }, stream)| {
        let points = scan.points().iter().zip(labels);
        let points = points.map(|(point, label)| label.map_or([f64::NAN; 3], |_| *point)).collect();
        let scan = Scan::new(points, Sigma::Uniform(0.005), scan.frame()).unwrap();
        (perturbed(&scan, seed, stream), None)
    });
    flat.collect()
}

fn params(floor: f64) -> Params {
    Params { cell_size: Some(0.1), estimate: Some(Estimate { floor }), ..Params::default() }
}

fn agreement(scans: &[(Scan, Option<PoseNoise>)], floor: f64) -> Agreement {
    scans_against_each_other(scans, params(floor), VIEWS, |_| {}).unwrap()
}

/// Poses with an error, and the same scans told of it.
fn wrong(scans: &[(Scan, Option<PoseNoise>)]) -> [Vec<(Scan, Option<PoseNoise>)>; 2] {
    let noise = PoseNoise::from_degrees(0.01, 0.3).unwrap();
    [None, Some(noise)].map(|told| {
        let numbered = scans.iter().zip(0..);
        numbered.map(|((scan, _), stream)| (misplaced(scan, &noise, 7, stream).unwrap(), told)).collect()
    })
}

#[test]
fn ratios_tell_right_from_wrong() {
    let scans = room(3);
    let right = agreement(&scans, 0.0);
    assert!(right.planes.len() >= 5 && right.all.count() >= 20, "{}", right.all.count());
    let ratio = Ratio::of(&right.all).unwrap();
    assert!((0.8..1.25).contains(&ratio.median), "{ratio:?}");
    assert!((0.8..1.25).contains(&ratio.rms), "{ratio:?}");

    let [untold, told] = wrong(&scans);
    let untold_ratio = Ratio::of(&agreement(&untold, 0.0).all).unwrap();
    assert!(untold_ratio.median > 2.0 && untold_ratio.rms > 2.0, "{untold_ratio:?}");
    let told = Ratio::of(&agreement(&told, 0.0).all).unwrap();
    assert!((0.6..1.5).contains(&told.median), "{told:?}");
    // A floor as large as the errors of poses covers most of them, and all of what there is without them.
    let floored = Ratio::of(&agreement(&untold, 0.02).all).unwrap();
    assert!(floored.median < untold_ratio.median / 2.0 && floored.median < 1.5, "{floored:?}");
    let too_much = Ratio::of(&agreement(&scans, 0.02).all).unwrap();
    assert!(too_much.median < 0.5, "{too_much:?}");
}

#[test]
fn the_result_does_not_depend_on_threads_or_on_how_scans_are_read() {
    let scans = room(4);
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| agreement(&scans, 0.0))
    };
    let one = with(1);
    assert_eq!(one, with(2));

    let mut mapper = Mapper::new(params(0.0)).unwrap();
    let mut firsts = Vec::new();
    for (scan, _) in &scans {
        firsts.push(mapper.len());
        mapper.insert(scan).unwrap();
    }
    let reference = Reference::new(mapper.extract().unwrap());
    let looks: Vec<Look> = scans
        .iter()
        .zip(firsts)
        .map(|((scan, _), first)| reference.look(scan, None, first, 0.0).unwrap())
        .collect();
    assert_eq!(one, reference.compare(&looks, VIEWS).unwrap());
    // A plane that more scans must see is seen by them all the same.
    let strict = reference.compare(&looks, VIEWS + 3).unwrap();
    assert!(strict.planes.len() < one.planes.len() && strict.seldom > one.seldom);
    assert!(strict.planes.iter().all(|plane| one.planes.contains(plane)));
}

#[test]
fn a_moved_world_gives_the_same_squares() {
    let turn = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
    let pose = Pose::new(turn, [400.0, -200.0, 30.0]).unwrap();
    let params = terrace_synth::Params { points: Some(150_000), sigma: Some(0.005), seed: 5 };
    let scene = Scene::room();
    let [here, there] = [scene.clone(), scene.transformed(&pose).unwrap()].map(|scene| {
        let scans: Vec<_> =
            scene.generate(&params).unwrap().scans.into_iter().map(|view| (view.scan, None)).collect();
        agreement(&scans, 0.0)
    });
    // Cells of other corners hold other points: the same planes, not the same bits.
    let [here, there] = [here, there].map(|agreement| Ratio::of(&agreement.all).unwrap().median);
    assert!((here / there).ln().abs() < 0.35, "{here} {there}");
}

#[test]
fn scans_without_planes_or_points_have_an_empty_look() {
    let scans = room(6);
    let mut mapper = Mapper::new(params(0.0)).unwrap();
    mapper.insert(&scans[0].0).unwrap();
    let count = mapper.len();
    let reference = Reference::new(mapper.extract().unwrap());
    let frame = Frame::World { sensor: None };
    let absent = Scan::new(vec![[f64::NAN; 3]; 4], Sigma::Uniform(0.01), frame).unwrap();
    assert_eq!(reference.look(&absent, None, 0, 0.0).unwrap(), Look::default());

    let beyond = reference.look(&absent, None, count - 3, 0.0);
    assert!(matches!(beyond, Err(TrialError::Unlabelled { .. })), "{beyond:?}");
    assert!(matches!(reference.look(&absent, None, usize::MAX, 0.0), Err(TrialError::Unlabelled { .. })));
    let floor = reference.look(&absent, None, 0, -1.0);
    assert!(matches!(floor, Err(TrialError::Params(_))), "{floor:?}");

    let nothing = reference.compare(&[], VIEWS).unwrap();
    assert_eq!((nothing.all.count(), nothing.scatter), (0, Scatter::default()));
    assert_eq!(
        (Ratio::of(&nothing.all), nothing.scatter.reduced(), nothing.scatter.band(0.95)),
        (None, None, None)
    );
}
