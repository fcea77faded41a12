//! Tuning: the steps the cost tells are true, the costs are their formulas, and the best is the best seen.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use proptest::prelude::*;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use terrace::tune::{
    Objective, Quality, Settings, TrueLabel, TuneAxis, TuneError, TuneSearch, TuneSpace, TuneStep, Tuner,
};
use terrace::{Mapper, Params, PlaneMap, Scan, StopReason};
use terrace_crs::{Cost, Step};
use terrace_eval::Contingency;
use terrace_synth::Scene;

use crate::common::{CLUSTERED, bits};

/// A small table and the true label of each of its points.
fn table(points: usize) -> (Vec<Scan>, Vec<TrueLabel>) {
    let params = terrace_synth::Params { points: Some(points), sigma: Some(0.01), seed: 4 };
    let scene = Scene::table().generate(&params).unwrap();
    let labelled = scene.scans.into_iter().next().unwrap();
    let truth = labelled.labels.iter().map(|l| l.map_or(TrueLabel::NoPlane, TrueLabel::Plane)).collect();
    (vec![labelled.scan], truth)
}

fn objectives(truth: &[TrueLabel]) -> [Objective; 3] {
    let by = |quality| Objective::Labels { truth: truth.to_vec(), quality };
    [Objective::default(), by(Quality::Cover), by(Quality::F1 { at_iou: 0.8 })]
}

fn tuner(params: Params, objective: Objective) -> Tuner {
    let (scans, _) = table(3000);
    Tuner::new(params, scans, objective).unwrap()
}

/// The map of an extraction with these settings.
fn extracted(params: &Params, settings: &Settings, scans: &[Scan]) -> PlaneMap {
    let mut mapper = Mapper::new(settings.in_params(params)).unwrap();
    for scan in scans {
        mapper.insert(scan).unwrap();
    }
    mapper.extract().unwrap()
}

/// Settings anywhere in a wide space.
fn anywhere(size: f64, rng: &mut ChaCha8Rng) -> Settings {
    Settings {
        cell_size: size * [0.5, 1.0, 2.0][rng.random_range(0..3)],
        depth: rng.random_range(1..=2),
        tau: rng.random_range(1..60),
        omega: rng.random_range(0.02..1.5),
        phi: rng.random_range(0.0_f64..1.0).powi(2),
    }
}

/// Settings anywhere on a step, its ends among them.
fn on(step: &TuneStep, at: &Settings, rng: &mut ChaCha8Rng) -> Settings {
    let mut between = |lo: f64, hi: f64| match rng.random_range(0..4) {
        0 => lo,
        1 => hi.next_down(),
        _ => (lo + rng.random::<f64>() * (hi - lo)).min(hi.next_down()),
    };
    let omega = between(step.omega.0, step.omega.1.min(3.0));
    let phi = between(step.phi.lo, step.phi.hi.unwrap_or(1.5).min(1.5));
    let tau = rng.random_range(step.tau.0.max(1)..=step.tau.1.unwrap_or(step.tau.0 + 1000));
    // φ above 1 decides as well, but is no parameter.
    Settings { tau, omega, phi: phi.min(1.0).max(step.phi.lo), ..*at }
}

#[test]
fn the_value_holds_on_the_whole_step() {
    let (scans, truth) = table(3000);
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    for preset in CLUSTERED {
        for objective in objectives(&truth) {
            let tuner = Tuner::new(preset(), scans.clone(), objective).unwrap();
            let size = tuner.in_use().cell_size;
            let mut cost = tuner.cost(&tuner.space()).unwrap();
            for _ in 0..12 {
                let at = anywhere(size, &mut rng);
                let step = cost.at(&at).unwrap();
                for _ in 0..6 {
                    let other = on(&step, &at, &mut rng);
                    // A cost of its own has no normals to use again.
                    let fresh = tuner.cost(&tuner.space()).unwrap().at(&other).unwrap();
                    assert_eq!(fresh, step, "{at:?} and {other:?}");
                    assert_eq!(cost.at(&other).unwrap(), step, "{at:?} and {other:?}");
                }
            }
        }
    }
}

#[test]
fn steps_begin_and_end_where_decisions_change() {
    let params = Params::clusters();
    let tuner = tuner(params, Objective::default());
    let (scans, _) = table(3000);
    let mut cost = tuner.cost(&tuner.space()).unwrap();
    let at = Settings { omega: 0.1, tau: 12, ..tuner.in_use() };
    let step = cost.at(&at).unwrap();
    let counts = |settings: &Settings| extracted(&params, settings, &scans).cell_counts;

    let (last, first) = (step.tau.1.unwrap(), step.tau.0);
    let dense = |tau| counts(&Settings { tau, ..at }).dense;
    assert!(first <= 12 && 12 <= last && first > 1);
    assert_eq!((dense(first), dense(last)), (dense(12), dense(12)));
    assert!(dense(first - 1) > dense(12) && dense(last + 1) < dense(12));

    let clustered = |omega| counts(&Settings { omega, ..at }).clustered;
    let (from, to) = step.omega;
    assert!(from <= 0.1 && 0.1 < to);
    assert_eq!((clustered(from), clustered(to.next_down())), (clustered(0.1), clustered(0.1)));
    assert!(clustered(from.next_down()) < clustered(0.1) && clustered(to) > clustered(0.1));

    // As a search sees it: half-open, and this cell size alone.
    let place = [at.cell_size, 1.0, 12.0, 0.1, at.phi];
    let Step::Box { lo, hi } = cost.evaluate(&place).step else { panic!("a box") };
    assert_eq!((lo[0], hi[0]), (at.cell_size, at.cell_size.next_up()));
    assert_eq!((lo[1], hi[1]), (1.0, 2.0));
    assert_eq!((lo[2], hi[2]), (first as f64, last as f64 + 1.0));
    assert_eq!((lo[3], hi[3]), (from, to));
    assert_eq!((lo[4], Some(hi[4])), (step.phi.lo, step.phi.hi));
}

#[test]
fn beyond_all_cells_steps_have_no_end() {
    let tuner = tuner(Params::clusters(), Objective::default());
    let mut cost = tuner.cost(&tuner.space()).unwrap();
    let sparse = cost.at(&Settings { tau: 1 << 40, ..tuner.in_use() }).unwrap();
    assert_eq!((sparse.tau.1, sparse.omega.1), (None, f64::INFINITY));
    // No plane: every point is left over.
    assert!((sparse.value - 3.0_f64.sqrt()).abs() < 1e-8);
    let all = cost.at(&Settings { tau: 1, omega: 1e300, ..tuner.in_use() }).unwrap();
    assert_eq!((all.tau.0, all.omega.1), (0, f64::INFINITY));
    let none = cost.at(&Settings { omega: 1e-12, ..tuner.in_use() }).unwrap();
    assert!(none.omega.0 > 0.0 && none.omega.0 < 1e-300);
}

#[test]
fn costs_are_their_formulas_of_an_extraction() {
    let (scans, truth) = table(3000);
    let true_labels: Vec<_> =
        truth.iter().map(|l| if let TrueLabel::Plane(plane) = l { Some(*plane) } else { None }).collect();
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    for preset in CLUSTERED {
        let params = preset();
        for (number, objective) in objectives(&truth).into_iter().enumerate() {
            let tuner = Tuner::new(params, scans.clone(), objective).unwrap();
            let mut cost = tuner.cost(&tuner.space()).unwrap();
            for _ in 0..6 {
                let at = anywhere(tuner.in_use().cell_size, &mut rng);
                let map = extracted(&params, &at, &scans);
                let both = Contingency::new(&true_labels, &map.labels).unwrap();
                let expected = match number {
                    0 => {
                        let all = map.labels.len() as f64;
                        let free = map.labels.iter().filter(|l| l.is_none()).count() as f64;
                        let shares = map.planes.iter().map(|p| {
                            p.points as f64 / all * p.normal_uncertainty.unwrap().iter().sum::<f64>()
                        });
                        shares.sum::<f64>() + free / all * 3.0_f64.sqrt() + 0.001 * map.planes.len() as f64
                    }
                    1 => 1.0 - both.weighted_cover().unwrap(),
                    _ => 1.0 - both.matches(0.8).unwrap().f1().unwrap(),
                };
                assert!((cost.at(&at).unwrap().value - expected).abs() < 1e-7, "{number}, {at:?}");
            }
        }
    }
}

#[test]
fn points_whose_truth_is_unknown_do_not_count() {
    let (scans, mut truth) = table(3000);
    let in_use = |truth: &[TrueLabel]| {
        let objective = Objective::Labels { truth: truth.to_vec(), quality: Quality::Cover };
        let tuner = Tuner::new(Params::clusters(), scans.clone(), objective).unwrap();
        tuner.cost(&tuner.space()).unwrap().at(&tuner.in_use()).unwrap().value
    };
    let all = in_use(&truth);
    let (first, second) = (truth[0], truth.iter().copied().find(|l| *l != truth[0]).unwrap());
    // A wrong truth for a tenth of the points costs; left out, it costs next to nothing.
    for label in truth.iter_mut().step_by(10) {
        *label = if *label == first { second } else { first };
    }
    let wrong = in_use(&truth);
    for label in truth.iter_mut().step_by(10) {
        *label = TrueLabel::from(-1);
    }
    let unknown = in_use(&truth);
    assert!((unknown - all).abs() < 0.02 && wrong > all + 0.05, "{all} {wrong} {unknown}");
    assert_eq!([TrueLabel::from(0), TrueLabel::from(i32::MIN)], [TrueLabel::NoPlane, TrueLabel::Unknown]);
}

#[test]
fn the_best_is_the_best_seen_and_no_worse_than_before() {
    let (scans, truth) = table(3000);
    for objective in objectives(&truth) {
        let tuner = Tuner::new(Params::clusters(), scans.clone(), objective).unwrap();
        let mut cost = tuner.cost(&tuner.space()).unwrap();
        let (mut heard, mut lowest) = (0, f64::INFINITY);
        let search = TuneSearch { evaluations: 60, cancel: None };
        let tuned = cost
            .tune(&search, |now| {
                assert_eq!(now.evaluations, heard + 1);
                assert!(now.best <= lowest);
                (heard, lowest) = (now.evaluations, now.best);
            })
            .unwrap();
        assert!(tuned.step.value <= tuned.before.value);
        assert_eq!(tuned.before_settings, tuner.in_use());
        assert_eq!(tuned.step.value, lowest, "the readable settings are on the step of the best");
        assert!(tuned.trials.iter().all(|trial| trial.value >= lowest));
        assert_eq!(tuned.trials.iter().filter(|trial| trial.evaluated).count(), tuned.evaluations);
        assert!(heard == tuned.evaluations && heard <= 60);
        assert!(tuned.certified > 0.0 && tuned.certified < 1.0);
        assert!(tuned.best.omega.to_string().len() < 12 && tuned.best.phi.to_string().len() < 12);
        assert_eq!(tuned.params.optimise, None);

        let again = tuner.cost(&tuner.space()).unwrap().tune(&search, |_| {}).unwrap();
        assert_eq!(again, tuned);
    }
}

#[test]
fn what_was_tuned_is_what_is_extracted_though_regions_were_asked_for() {
    let (scans, _) = table(3000);
    let search = TuneSearch { evaluations: 20, cancel: None };
    let tuned = |params| {
        let tuner = Tuner::new(params, scans.clone(), Objective::default()).unwrap();
        tuner.cost(&tuner.space()).unwrap().tune(&search, |_| {}).unwrap()
    };
    let (regions, clusters) = (tuned(Params::default()), tuned(Params::clusters()));
    assert_eq!(regions, clusters);
    assert!(clusters.params.regions.is_none());
    let extracted = |params| bits(&crate::common::map(params, &scans.iter().collect::<Vec<_>>()));
    assert_eq!(extracted(regions.params), extracted(clusters.params));
}

#[test]
fn a_fixed_setting_stays_and_a_small_space_is_certified() {
    let tuner = tuner(Params::clusters(), Objective::default());
    let in_use = tuner.in_use();
    let space = TuneSpace {
        cell_size: vec![in_use.cell_size],
        depth: (2, 2),
        tau: vec![5, 4],
        omega: (0.3, 0.3),
        phi: (0.2, 0.25),
    };
    let mut cost = tuner.cost(&space).unwrap();
    let search = TuneSearch { evaluations: 5000, cancel: None };
    let tuned = cost.tune(&search, |_| {}).unwrap();
    assert_eq!((tuned.certified, tuned.stop), (1.0, StopReason::Certified));
    let Settings { cell_size, depth, omega, .. } = tuned.best;
    assert_eq!((cell_size, depth, omega), (in_use.cell_size, 2, 0.3));
    assert!(tuned.trials.iter().all(|t| t.settings.depth == 2 && t.settings.omega == 0.3));
    assert_eq!(tuned.before_settings.phi, 0.2, "the nearest to what was in use");

    // The proof is right: nowhere along φ is it lower.
    for tau in [4, 5] {
        let through = Settings { tau, ..tuned.best };
        let slice = cost.slice(&through, TuneAxis::Phi, usize::MAX).unwrap();
        assert!(slice.iter().all(|step| step.value >= tuned.step.value));
    }
    let one = TuneSpace { tau: vec![4], phi: (0.2, 0.2), ..space };
    let tuned = tuner.cost(&one).unwrap().tune(&search, |_| {}).unwrap();
    assert_eq!((tuned.certified, tuned.evaluations), (1.0, 1));
}

#[test]
fn slices_cover_their_setting() {
    let tuner = tuner(Params::clusters(), Objective::default());
    let mut cost = tuner.cost(&tuner.space()).unwrap();
    let through = tuner.in_use();
    for (axis, values) in [(TuneAxis::CellSize, 5), (TuneAxis::Depth, 2)] {
        let slice = cost.slice(&through, axis, 64).unwrap();
        assert_eq!(slice.len(), values);
        for step in &slice {
            assert_eq!(step.lo, step.hi);
            assert_eq!(cost.at(&through.with(axis, step.lo)).unwrap().value, step.value);
        }
    }
    for axis in [TuneAxis::Omega, TuneAxis::Phi] {
        let all = cost.slice(&through, axis, usize::MAX).unwrap();
        let range = if axis == TuneAxis::Phi { (0.0, 1.0) } else { (0.05, 1.0) };
        assert_eq!((all[0].lo, all[all.len() - 1].hi), range);
        assert!(all.windows(2).all(|pair| pair[0].hi == pair[1].lo), "no gaps");
        let few = cost.slice(&through, axis, 7).unwrap();
        assert!(few.len() <= 7 && few.iter().all(|step| all.contains(step)));
        assert!(few[few.len() - 1].hi > 0.5, "spread over the range");
        assert!(cost.slice(&through, axis, 0).unwrap().is_empty());
    }
}

#[test]
fn a_search_can_be_cancelled() {
    let tuner = tuner(Params::clusters(), Objective::default());
    let flag = Arc::new(AtomicBool::new(false));
    let search = TuneSearch { evaluations: 200, cancel: Some(flag.clone()) };
    let mut cost = tuner.cost(&tuner.space()).unwrap();
    let tuned = cost.tune(&search, |now| flag.store(now.evaluations == 7, Ordering::Relaxed)).unwrap();
    assert_eq!((tuned.evaluations, tuned.stop, tuned.certified), (7, StopReason::Cancelled, 0.0));
    assert!(tuned.step.value <= tuned.before.value);
    flag.store(true, Ordering::Relaxed);
    assert!(matches!(cost.tune(&search, |_| {}), Err(TuneError::Search(_))));
}

#[test]
fn what_cannot_be_tuned_is_told() {
    let (scans, truth) = table(3000);
    let labels = |truth: Vec<TrueLabel>, quality| {
        Tuner::new(Params::clusters(), scans.clone(), Objective::Labels { truth, quality }).err()
    };
    let short = labels(truth[..10].to_vec(), Quality::Cover);
    assert_eq!(short, Some(TuneError::Labels { labels: 10, points: 3000 }));
    assert_eq!(short.unwrap().to_string(), "10 labels do not fit 3000 points");
    let none = labels(vec![TrueLabel::NoPlane; 3000], Quality::Cover);
    assert_eq!(none, Some(TuneError::NoTruePlanes { labels: 3000 }));
    assert!(matches!(labels(truth, Quality::F1 { at_iou: 0.3 }), Some(TuneError::Eval(_))));
    let weighed = |weight_clusters| {
        let objective = Objective::Uncertainty { weight_uncertainty: 1.0, weight_clusters };
        Tuner::new(Params::clusters(), scans.clone(), objective).err().map(|e| e.to_string())
    };
    assert!(weighed(f64::NAN).unwrap().contains("weight_clusters is NaN"));
    assert!(weighed(-1.0).unwrap().contains("weight_clusters is -1"));
    let nothing = Tuner::new(Params::clusters(), vec![], Objective::default()).err();
    assert!(matches!(nothing, Some(TuneError::Extract(_))));
    let params = Params { phi: 2.0, ..Params::clusters() };
    let wrong = Tuner::new(params, scans.clone(), Objective::default()).err();
    assert!(matches!(wrong, Some(TuneError::Params(_))));

    let tuner = Tuner::new(Params::clusters(), scans, Objective::default()).unwrap();
    let mut cost = tuner.cost(&tuner.space()).unwrap();
    let search = TuneSearch { evaluations: 1, cancel: None };
    assert_eq!(cost.tune(&search, |_| {}).err(), Some(TuneError::Evaluations { evaluations: 1 }));
    // A cell size whose indices do not reach the points: the reason, and not that there is no number.
    let tiny = TuneSpace { cell_size: vec![1e-300], ..tuner.space() };
    let refused = tuner.cost(&tiny).and_then(|mut cost| cost.tune(&TuneSearch::default(), |_| {}));
    assert!(!matches!(refused, Ok(_) | Err(TuneError::Search(_))), "{refused:?}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn any_space_of_any_cloud_gives_an_answer(
        points in prop::collection::vec(prop::array::uniform3(-3.0..3.0_f64), 0..200),
        size in 0.05..2.0_f64,
        tau in 1_u64..5,
        omega in 0.01..2.0_f64,
        seed in 0_u64..10,
    ) {
        let scan = crate::common::unknown(&points);
        let params = Params { cell_size: Some(size), tau: Some(tau), min_cells: 1, seed, ..Params::clusters() };
        match Tuner::new(params, vec![scan], Objective::default()) {
            Ok(tuner) => {
                let space = TuneSpace { omega: (omega / 2.0, omega), ..tuner.space() };
                let search = TuneSearch { evaluations: 25, cancel: None };
                match tuner.cost(&space).unwrap().tune(&search, |_| {}) {
                    Ok(tuned) => {
                        prop_assert!(tuned.step.value <= tuned.before.value);
                        let better = tuned.step.value < tuned.before.value;
                        prop_assert!(better || tuned.best == tuned.before_settings);
                    }
                    Err(error) => {
                        prop_assert!(points.is_empty() && matches!(error, TuneError::Extract(_)), "{error}");
                    }
                }
            }
            Err(error) => prop_assert!(points.is_empty(), "{}", error),
        }
    }
}
