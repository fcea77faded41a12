//! Every stopping rule ends every method that has it, for that reason.

// Results are exact here; a test has no caller to report to.
#![allow(clippy::float_cmp, clippy::unwrap_used)]

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;
use terrace_crs::{
    Bounds, CertifiedSearch, ControlledRandomSearch, Cost, Evaluation, LocalMutation, Minimum, PatternSearch,
    SearchError, Source, StopReason, Stopping, Sweep, from_fn, from_line, from_stairs,
};

fn bounds() -> Bounds {
    Bounds::interval(0.0, 1000.0).unwrap()
}

/// A valley at 700.
fn valley() -> impl Cost {
    from_stairs(|x| {
        let lo = x.floor();
        ((lo - 700.0).abs(), lo..lo + 1.0)
    })
}

/// Each method on one axis, by name.
fn all(cost: &mut dyn Cost, stopping: &Stopping) -> Vec<(&'static str, Result<Minimum, SearchError>)> {
    let (bounds, rng) = (bounds(), &mut ChaCha8Rng::seed_from_u64(5));
    let own = || stopping.clone();
    let controlled = ControlledRandomSearch { stopping: own(), ..ControlledRandomSearch::default() };
    let mutation = LocalMutation { stopping: own(), ..LocalMutation::default() };
    let pattern = PatternSearch { stopping: own(), ..PatternSearch::default() };
    let sweep = Sweep { stopping: own(), ..Sweep::default() };
    let certified = CertifiedSearch { stopping: own(), ..CertifiedSearch::default() };
    vec![
        ("controlled", controlled.minimise(cost, &bounds, rng)),
        ("mutation", mutation.minimise(cost, &bounds, rng)),
        ("pattern", pattern.minimise(cost, &bounds, rng)),
        ("sweep", sweep.minimise(cost, &bounds)),
        ("certified", certified.minimise(cost, &bounds)),
    ]
}

fn each(stopping: &Stopping, mut check: impl FnMut(&str, Minimum)) {
    for (method, result) in all(&mut valley(), stopping) {
        check(method, result.unwrap());
    }
}

#[test]
fn evaluations_end_all_methods() {
    for most in [1, 2, 7, 20] {
        each(&Stopping { evaluations: Some(most), ..Stopping::default() }, |method, minimum| {
            assert_eq!((minimum.evaluations, minimum.stop), (most, StopReason::Evaluations), "{method}");
        });
    }
}

#[test]
fn no_evaluations_are_an_error_when_nothing_is_known() {
    let stopping = Stopping { evaluations: Some(0), ..Stopping::default() };
    for (method, result) in all(&mut valley(), &stopping) {
        assert_eq!(result, Err(SearchError::NothingSeen { stop: StopReason::Evaluations }), "{method}");
    }
}

#[test]
fn rounds_end_all_methods() {
    each(&Stopping { rounds: Some(3), ..Stopping::default() }, |method, minimum| {
        assert_eq!((minimum.rounds, minimum.stop), (3, StopReason::Rounds), "{method}");
    });
}

#[test]
fn a_target_ends_all_methods_where_it_is_reached() {
    each(&Stopping { target: Some(100.0), ..Stopping::default() }, |method, minimum| {
        assert_eq!(minimum.stop, StopReason::Target, "{method}");
        let (last, before) = minimum.trace.split_last().unwrap();
        assert!(last.value <= 100.0 && before.iter().all(|trial| trial.value > 100.0), "{method}");
    });
}

#[test]
fn a_stall_ends_all_methods_after_so_many_evaluations_without_a_lower_value() {
    // Up and down all over, so that no method improves for ever.
    let mut rough = from_stairs(|x| {
        let lo = x.floor();
        (-(lo * 7.31).sin().abs(), lo..lo + 1.0)
    });
    let stopping = Stopping { stall: Some(9), ..Stopping::default() };
    for (method, result) in all(&mut rough, &stopping) {
        let minimum = result.unwrap();
        assert_eq!(minimum.stop, StopReason::Stall, "{method}");
        let asked: Vec<f64> =
            minimum.trace.iter().filter(|t| t.source == Source::Evaluated).map(|t| t.value).collect();
        let lowest = asked.iter().position(|value| *value == minimum.value).unwrap();
        assert_eq!(asked.len() - 1 - lowest, 9, "{method}");
    }
}

#[test]
fn the_caller_cancels_all_methods() {
    let flag = Arc::new(AtomicBool::new(false));
    let stopping = Stopping { cancel: Some(flag.clone()), ..Stopping::default() };
    for number in 0..5 {
        flag.store(false, Ordering::Relaxed);
        let mut asked = 0;
        let mut cost = from_stairs(|x| {
            asked += 1;
            flag.store(asked >= 4, Ordering::Relaxed);
            ((x.floor() - 700.0).abs(), x.floor()..x.floor() + 1.0)
        });
        let (bounds, rng) = (bounds(), &mut ChaCha8Rng::seed_from_u64(5));
        let stopping = stopping.clone();
        let minimum = match number {
            0 => ControlledRandomSearch { stopping, ..ControlledRandomSearch::default() }
                .minimise(&mut cost, &bounds, rng),
            1 => LocalMutation { stopping, ..LocalMutation::default() }.minimise(&mut cost, &bounds, rng),
            2 => PatternSearch { stopping, ..PatternSearch::default() }.minimise(&mut cost, &bounds, rng),
            3 => Sweep { stopping, ..Sweep::default() }.minimise(&mut cost, &bounds),
            _ => CertifiedSearch { stopping, ..CertifiedSearch::default() }.minimise(&mut cost, &bounds),
        }
        .unwrap();
        assert_eq!((minimum.evaluations, minimum.stop), (4, StopReason::Cancelled), "method {number}");
    }
    flag.store(true, Ordering::Relaxed);
    for (method, result) in all(&mut valley(), &stopping) {
        assert_eq!(result, Err(SearchError::NothingSeen { stop: StopReason::Cancelled }), "{method}");
    }
}

#[test]
fn a_spread_ends_the_methods_with_a_population() {
    let stopping = Stopping { spread: Some(50.0), ..Stopping::default() };
    for (method, result) in all(&mut valley(), &stopping) {
        let expected = match method {
            "controlled" | "mutation" => StopReason::Spread,
            "pattern" => StopReason::Converged,
            _ => StopReason::Certified,
        };
        assert_eq!(result.unwrap().stop, expected, "{method}");
    }
}

#[test]
fn one_step_ends_the_methods_with_a_population() {
    let everywhere = f64::NEG_INFINITY..f64::INFINITY;
    for (method, result) in all(&mut from_stairs(|_| (4.0, everywhere.clone())), &Stopping::default()) {
        let minimum = result.unwrap();
        let expected = match method {
            "controlled" | "mutation" => StopReason::OneStep,
            "pattern" => StopReason::Converged,
            _ => StopReason::Certified,
        };
        assert_eq!((minimum.evaluations, minimum.stop), (1, expected), "{method}");
        assert!(minimum.is_proven(), "{method}");
    }
}

#[test]
fn without_rules_each_method_comes_to_its_own_end() {
    each(&Stopping::default(), |method, minimum| {
        let expected = match method {
            "controlled" | "mutation" => &[StopReason::OneStep, StopReason::Rounds][..],
            "pattern" => &[StopReason::Converged],
            _ => &[StopReason::Certified],
        };
        assert!(expected.contains(&minimum.stop), "{method}: {:?}", minimum.stop);
        assert_eq!(minimum.value, 0.0, "{method}");
    });
}

#[test]
fn a_cost_without_steps_ends_a_certified_search_unless_there_is_a_limit() {
    let minimum = CertifiedSearch::default().minimise(&mut from_line(|x| x), &bounds()).unwrap();
    assert_eq!((minimum.stop, minimum.evaluations), (StopReason::NoSteps, 1000));
    assert!(minimum.certified < Some(1e-6));
    let plane = Bounds::new([(0.0, 1.0); 2]).unwrap();
    let minimum = CertifiedSearch::default().minimise(&mut from_fn(|x| x[0] + x[1]), &plane).unwrap();
    assert_eq!(minimum.stop, StopReason::NoSteps);
    let stopping = Stopping { evaluations: Some(1500), ..Stopping::default() };
    let search = CertifiedSearch { stopping, ..CertifiedSearch::default() };
    assert_eq!(search.minimise(&mut from_line(|x| x), &bounds()).unwrap().stop, StopReason::Evaluations);
}

#[test]
fn a_target_that_is_no_number_is_an_error() {
    let stopping = Stopping { target: Some(f64::NAN), ..Stopping::default() };
    for (method, result) in all(&mut valley(), &stopping) {
        assert!(matches!(result, Err(SearchError::Target { .. })), "{method}");
    }
}

#[test]
fn what_is_known_costs_no_evaluation_and_is_enough_for_a_result() {
    let mut steps = terrace_crs::Steps::new(&bounds());
    steps.insert(&[5.0], &Evaluation::interval(2.0, f64::NEG_INFINITY..f64::INFINITY)).unwrap();
    let minimum = CertifiedSearch::default().minimise_with(&mut valley(), &bounds(), &mut steps).unwrap();
    assert_eq!((minimum.value, minimum.evaluations, minimum.stop), (2.0, 0, StopReason::Certified));
}

#[test]
fn a_pattern_search_refines_no_mesh_that_changes_no_move() {
    // Four steps; each move from one goes to its neighbours whatever the mesh, once that is no longer than a step.
    let mut cost = from_stairs(|x| {
        ((x / 250.0).floor(), (x / 250.0).floor() * 250.0..((x / 250.0).floor() + 1.0) * 250.0)
    });
    let search = PatternSearch { start: vec![vec![600.0]], starts: Some(1), ..PatternSearch::default() };
    let minimum = search.minimise(&mut cost, &bounds(), &mut ChaCha8Rng::seed_from_u64(5)).unwrap();
    assert_eq!((minimum.value, minimum.stop), (0.0, StopReason::Converged));
    assert!(minimum.rounds <= 8, "{} rounds", minimum.rounds);
}
