//! All methods against brute force on random staircases, of real and of mixed axes.

// Results are exact here; a test has no caller to report to.
#![allow(clippy::float_cmp, clippy::unwrap_used)]

mod common;

use std::num::NonZeroUsize;

use common::{Answered, AskedOnce, Staircase, Tells, mixed, staircase};
use proptest::prelude::*;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use terrace_crs::{
    Answer, Axis, Bounds, CertifiedSearch, ControlledRandomSearch, Cost, Evaluation, LocalMutation, Minimum,
    PatternSearch, SearchError, Step, Steps, StopReason, Stopping, Sweep, from_line, from_stairs,
    in_parallel,
};

const METHODS: [&str; 5] = ["controlled", "mutation", "pattern", "sweep", "certified"];

fn minimise(
    method: &str,
    cost: &mut dyn Cost,
    staircase: &Staircase,
    stopping: &Stopping,
    seed: u64,
) -> Result<Minimum, SearchError> {
    let stopping = stopping.clone();
    let bounds = staircase.bounds();
    let rng = &mut ChaCha8Rng::seed_from_u64(seed);
    match method {
        "controlled" => ControlledRandomSearch { stopping, ..ControlledRandomSearch::default() }
            .minimise(cost, &bounds, rng),
        "mutation" => LocalMutation { stopping, ..LocalMutation::default() }.minimise(cost, &bounds, rng),
        "pattern" => PatternSearch { stopping, ..PatternSearch::default() }.minimise(cost, &bounds, rng),
        "sweep" => Sweep { stopping, ..Sweep::default() }.minimise(cost, &bounds),
        _ => CertifiedSearch { stopping, ..CertifiedSearch::default() }.minimise(cost, &bounds),
    }
}

fn evaluations(most: usize) -> Stopping {
    Stopping { evaluations: Some(most), ..Stopping::default() }
}

/// Whether a sweep has to refuse the staircase.
fn cannot_be_swept(error: &SearchError) -> bool {
    matches!(error, SearchError::NoStep { .. } | SearchError::NotOneAxis { .. })
}

/// The share of the domain where the answers prove that the cost is not below `value`, by looking at very many places;
/// and by how much that may be wrong.
fn scanned(staircase: &Staircase, answers: &[Answered], value: f64) -> (f64, f64) {
    let per_axis = [4001, 101, 31][staircase.domain.len() - 1];
    let along = |axis: &Axis| -> Vec<f64> {
        match axis {
            Axis::Integer { lo, hi } => (*lo..=*hi).map(|i| i as f64).collect(),
            Axis::List(values) => values.clone(),
            real if real.lo() == real.hi() => vec![real.lo()],
            real => {
                // Middles of equal parts.
                let part = (real.hi() - real.lo()) / f64::from(per_axis);
                (0..per_axis).map(|i| real.lo() + (f64::from(i) + 0.5) * part).collect()
            }
        }
    };
    let axes: Vec<Vec<f64>> = staircase.domain.iter().map(along).collect();
    let total: usize = axes.iter().map(Vec::len).product();
    let mut proven = 0_usize;
    for mut number in 0..total {
        let mut x = Vec::new();
        for values in &axes {
            x.push(values[number % values.len()]);
            number /= values.len();
        }
        let proves = |a: &Answered| a.number >= value && a.step.contains(&a.x, &x);
        proven += usize::from(answers.iter().any(proves));
    }
    // Each border of a box may be off by half a part of the axis.
    let borders = 2.0 * answers.len().min(60) as f64;
    let real = staircase.domain.iter().filter(|axis| axis.count().is_none()).count();
    (proven as f64 / total as f64, borders * real as f64 * 0.5 / f64::from(per_axis) + 1e-9)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(200) })]

    #[test]
    fn what_a_method_reports_is_true_and_the_lowest_it_saw(
        s in prop_oneof![staircase(), mixed()], early: bool, most in 1..200_usize, seed: u64,
    ) {
        for method in METHODS {
            let mut cost = AskedOnce::new(&s, early);
            let minimum = match minimise(method, &mut cost, &s, &evaluations(most), seed) {
                Err(error) if cannot_be_swept(&error) => continue,
                other => other.unwrap(),
            };
            prop_assert!(s.bounds().contains(&minimum.x), "{}", method);
            prop_assert_eq!(minimum.value, s.value(&minimum.x), "{}", method);
            prop_assert!(minimum.value >= s.lowest());
            let seen = || minimum.trace.iter().filter(|trial| !trial.source.is_bound());
            let first = seen().find(|trial| trial.value <= minimum.value);
            prop_assert_eq!(first.map(|trial| &trial.x), Some(&minimum.x), "the earlier found wins: {}", method);
            for trial in &minimum.trace {
                let value = s.value(&trial.x);
                let is_true = if trial.source.is_bound() { trial.value <= value } else { trial.value == value };
                prop_assert!(is_true);
                prop_assert!(trial.value >= minimum.value);
            }
            prop_assert!(minimum.evaluations <= most);
            prop_assert_eq!(minimum.evaluations, cost.answers.len());
            let asked = minimum.trace.iter().filter(|trial| trial.source.is_evaluation()).count();
            prop_assert_eq!(minimum.evaluations, asked);
            prop_assert_eq!(minimum.calls, minimum.trace.len());
            if s.tells == Tells::All {
                prop_assert!(minimum.evaluations <= s.cells(), "{}", method);
            }
            let mut again = AskedOnce::new(&s, early);
            prop_assert_eq!(&minimise(method, &mut again, &s, &evaluations(most), seed).unwrap(), &minimum);
        }
    }

    #[test]
    fn the_certified_share_is_that_of_a_dense_scan(
        s in prop_oneof![staircase(), mixed()], early: bool, most in 1..60_usize, seed: u64,
    ) {
        for method in METHODS {
            let mut cost = AskedOnce::new(&s, early);
            let stopping = Stopping { rounds: Some(2000), ..evaluations(most) };
            let Ok(minimum) = minimise(method, &mut cost, &s, &stopping, seed) else { continue };
            let Some(certified) = minimum.certified else {
                prop_assert!(s.domain.len() > 1 && method != "certified");
                continue;
            };
            let (share, tolerance) = scanned(&s, &cost.answers, minimum.value);
            prop_assert!((certified - share).abs() <= tolerance, "{}: {} scanned {}", method, certified, share);
            // Proven means at every place, the ends of all axes included.
            let all = s.places().into_iter().chain([s.domain.iter().map(Axis::hi).collect()]);
            let proves = |x: &Vec<f64>| cost.answers.iter().any(|a| a.number >= minimum.value && a.step.contains(&a.x, x));
            if certified == 1.0 {
                prop_assert!(minimum.is_proven() && all.clone().all(|x| proves(&x)), "{}", method);
                prop_assert_eq!(minimum.value, s.lowest());
            } else if s.domain.iter().all(|axis| axis.count().is_some()) {
                prop_assert!(!all.clone().all(|x| proves(&x)), "{}", method);
            }
            if minimum.stop == StopReason::Certified {
                prop_assert_eq!(certified, 1.0, "{}", method);
            }
        }
    }

    #[test]
    fn a_sweep_walks_up_every_staircase_and_finds_its_lowest_step(
        s in prop_oneof![staircase(), mixed()], early: bool, stop_early: bool,
    ) {
        let mut cost = AskedOnce::new(&s, early);
        let result = Sweep { stop_early, ..Sweep::default() }.minimise(&mut cost, &s.bounds());
        let minimum = match result {
            Err(SearchError::NotOneAxis { axes }) => {
                prop_assert_eq!(axes, s.domain.len());
                return Ok(());
            }
            Err(SearchError::NoStep { x }) => {
                prop_assert_eq!(s.answer(&[x]).step, Step::Point);
                prop_assert_eq!(s.domain[0].count(), None);
                return Ok(());
            }
            other => other.unwrap(),
        };
        prop_assert_eq!((minimum.value, minimum.stop, minimum.is_proven()), (s.lowest(), StopReason::Certified, true));
        prop_assert!(minimum.trace.windows(2).all(|pair| pair[0].x[0] < pair[1].x[0]));
        prop_assert!(stop_early && early || minimum.trace.iter().all(|trial| !trial.source.is_bound()));
        if s.tells == Tells::All {
            prop_assert!(minimum.evaluations <= s.cells());
        }
    }

    #[test]
    fn a_certified_search_with_budget_enough_is_brute_force(
        mut s in prop_oneof![staircase(), mixed()], early: bool, batch in 1..5_usize,
        start in prop::collection::vec(prop::collection::vec(-1.0..6.0_f64, 3), 0..3),
    ) {
        let counted = s.domain.iter().all(|axis| axis.count().is_some());
        if !counted && s.tells != Tells::All {
            s.tells = Tells::Near(0.4);
        }
        let bounds = s.bounds();
        let search = CertifiedSearch {
            start: start.iter().map(|x| bounds.nearest(x)).collect(),
            batch: NonZeroUsize::new(batch),
            ..CertifiedSearch::default()
        };
        let mut alone = AskedOnce::new(&s, early);
        let mut grouped = |x: &[f64]| s.answer(x);
        let minimum = if batch == 1 {
            search.minimise(&mut alone, &bounds)
        } else {
            search.minimise(&mut Answering(&mut grouped), &bounds)
        }.unwrap();
        prop_assert_eq!((minimum.value, minimum.stop), (s.lowest(), StopReason::Certified));
        prop_assert!(minimum.is_proven());
        let starts = minimum.trace.iter().take_while(|trial| trial.round == 0).map(|trial| &trial.x);
        prop_assert_eq!(starts.collect::<Vec<_>>(), search.start.iter().collect::<Vec<_>>());
    }

    #[test]
    fn a_group_gives_the_same_result_on_any_number_of_threads(
        s in prop_oneof![staircase(), mixed()], batch in 2..9_usize, threads in 2..5_usize, seed: u64,
    ) {
        let batch = NonZeroUsize::new(batch);
        let bounds = s.bounds();
        let run = |threads: usize| {
            let mut cost = in_parallel(|x| s.answer(x), NonZeroUsize::new(threads).unwrap());
            let rng = || ChaCha8Rng::seed_from_u64(seed);
            let stopping = evaluations(100);
            let controlled = ControlledRandomSearch { batch, stopping: stopping.clone(), ..ControlledRandomSearch::default() };
            let mutation = LocalMutation { batch, stopping: stopping.clone(), ..LocalMutation::default() };
            let certified = CertifiedSearch { batch, stopping, ..CertifiedSearch::default() };
            [
                controlled.minimise(&mut cost, &bounds, &mut rng()),
                mutation.minimise(&mut cost, &bounds, &mut rng()),
                certified.minimise(&mut cost, &bounds),
            ]
        };
        let one = run(1);
        prop_assert!(one.iter().all(|result| result.as_ref().is_ok_and(|minimum| minimum.evaluations <= 100)));
        prop_assert_eq!(one, run(threads));
    }

    #[test]
    fn what_earlier_searches_learnt_is_not_evaluated_again(
        s in prop_oneof![staircase(), mixed()], first in 0..5_usize, second in 0..5_usize, seed: u64,
    ) {
        let bounds = s.bounds();
        let mut steps = Steps::new(&bounds);
        let mut cost = AskedOnce::new(&s, false);
        let rng = &mut ChaCha8Rng::seed_from_u64(seed);
        let mut lowest = f64::INFINITY;
        for method in [first, second] {
            let stopping = evaluations(80);
            let result = match METHODS[method] {
                "controlled" => ControlledRandomSearch { stopping, ..ControlledRandomSearch::default() }
                    .minimise_with(&mut cost, &bounds, &mut steps, rng),
                "mutation" => LocalMutation { stopping, ..LocalMutation::default() }
                    .minimise_with(&mut cost, &bounds, &mut steps, rng),
                "pattern" => PatternSearch { stopping, ..PatternSearch::default() }
                    .minimise_with(&mut cost, &bounds, &mut steps, rng),
                "sweep" => Sweep { stopping, ..Sweep::default() }.minimise_with(&mut cost, &bounds, &mut steps),
                _ => CertifiedSearch { stopping, ..CertifiedSearch::default() }.minimise_with(&mut cost, &bounds, &mut steps),
            };
            let Ok(minimum) = result else { continue };
            lowest = lowest.min(minimum.value);
            if minimum.is_proven() {
                prop_assert_eq!(lowest, s.lowest());
            }
        }
    }

    #[test]
    fn on_small_domains_all_methods_agree_with_brute_force(mut s in mixed(), seed: u64) {
        for axis in s.domain.iter_mut().filter(|axis| axis.count().is_none()) {
            *axis = Axis::Integer { lo: 0, hi: 5 };
        }
        for method in ["sweep", "certified"] {
            let mut cost = AskedOnce::new(&s, false);
            if let Ok(minimum) = minimise(method, &mut cost, &s, &Stopping::default(), seed) {
                prop_assert_eq!(minimum.value, s.lowest(), "{}", method);
                prop_assert!(minimum.is_proven());
            }
        }
        // The others are heuristics: with a start at every place they see them all.
        let start = s.places();
        let rng = &mut ChaCha8Rng::seed_from_u64(seed);
        let bounds = s.bounds();
        let controlled = ControlledRandomSearch { start: start.clone(), ..ControlledRandomSearch::default() };
        let mutation = LocalMutation { start: start.clone(), ..LocalMutation::default() };
        let pattern = PatternSearch { start, ..PatternSearch::default() };
        for result in [
            controlled.minimise(&mut AskedOnce::new(&s, false), &bounds, rng),
            mutation.minimise(&mut AskedOnce::new(&s, false), &bounds, rng),
            pattern.minimise(&mut AskedOnce::new(&s, false), &bounds, rng),
        ] {
            prop_assert_eq!(result.unwrap().value, s.lowest());
        }
    }
}

/// A cost that may be asked again: places of a group do not know of each other.
struct Answering<'a>(&'a mut dyn FnMut(&[f64]) -> Evaluation);

impl Cost for Answering<'_> {
    fn evaluate(&mut self, x: &[f64]) -> Evaluation {
        (self.0)(x)
    }
}

/// Tells of a value that is too high only that it is.
struct Blunt<C>(C);

impl<C: Cost> Cost for Blunt<C> {
    fn evaluate(&mut self, x: &[f64]) -> Evaluation {
        self.0.evaluate(x)
    }

    fn evaluate_below(&mut self, x: &[f64], ceiling: f64) -> Answer {
        let exact = self.0.evaluate(x);
        if exact.value < ceiling {
            Answer::Exact(exact)
        } else {
            Answer::AtLeast(Evaluation { value: ceiling, ..exact })
        }
    }
}

#[test]
fn bounds_that_tell_no_more_than_they_must_do_not_lead_astray() {
    let mut needed: Vec<usize> = (0..60)
        .map(|seed| {
            let (cost, lowest) = valley(seed);
            let stopping = Stopping { target: Some(lowest + 0.015), ..Stopping::default() };
            let search = CertifiedSearch { stopping, ..CertifiedSearch::default() };
            search.minimise(&mut Blunt(cost), &Bounds::interval(0.0, 0.9995).unwrap()).unwrap().evaluations
        })
        .collect();
    needed.sort_unstable();
    assert!(needed[30] <= 28 && needed[54] <= 80, "{} and {} evaluations", needed[30], needed[54]);
}

#[test]
fn steps_of_the_start_places_count_before_anything_else_is_asked() {
    struct Halves;
    impl Cost for Halves {
        fn evaluate(&mut self, x: &[f64]) -> Evaluation {
            let inf = f64::INFINITY;
            let (value, lo, hi) = if x[0] < 0.25 { (1.0, -inf, 0.25) } else { (2.0, 0.25, inf) };
            Evaluation { value, step: Step::Box { lo: vec![lo, -inf], hi: vec![hi, inf] } }
        }
    }
    let bounds = Bounds::new([(0.0, 1.0); 2]).unwrap();
    for (start, expected) in [(vec![[0.1, 0.5]], 0.25), (vec![[0.5, 0.5], [0.1, 0.5]], 1.0)] {
        let search = CertifiedSearch {
            start: start.into_iter().map(Vec::from).collect(),
            stopping: Stopping { rounds: Some(0), ..Stopping::default() },
            ..CertifiedSearch::default()
        };
        let minimum = search.minimise(&mut Halves, &bounds).unwrap();
        assert_eq!((minimum.value, minimum.certified, minimum.rounds), (1.0, Some(expected), 0));
    }
}

#[test]
fn a_local_mutation_replays_its_rules() {
    for seed in 0..20 {
        let bounds = Bounds::interval(0.0, 1.0).unwrap();
        let search = LocalMutation {
            population: Some(8),
            stopping: Stopping { rounds: Some(30), ..Stopping::default() },
            ..LocalMutation::default()
        };
        let mut cost = from_line(|x| (7.0 * x).sin() + (40.0 * x).cos() / 3.0);
        let minimum = search.minimise(&mut cost, &bounds, &mut ChaCha8Rng::seed_from_u64(seed)).unwrap();
        let (first, later) = minimum.trace.split_at(8);
        let mut population: Vec<(f64, f64)> = first.iter().map(|trial| (trial.x[0], trial.value)).collect();
        for round in later.chunk_by(|a, b| a.round == b.round) {
            let best = population.iter().copied().min_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
            let worst = (0..8).max_by(|a, b| population[*a].1.total_cmp(&population[*b].1)).unwrap();
            let largest = population[worst].1;
            let reflected = round[0].x[0];
            assert!(
                population.iter().any(|member| *member != best && best.0 + (best.0 - member.0) == reflected)
            );
            // A reflection that is not lower is mutated, beyond the best as seen from it.
            assert_eq!(round.len(), if round[0].value < largest { 1 } else { 2 });
            if let [_, mutated] = round {
                let farthest = (2.0 * best.0 - reflected).clamp(0.0, 1.0);
                let (lo, hi) = (best.0.min(farthest), best.0.max(farthest));
                assert!(lo <= mutated.x[0] && mutated.x[0] <= hi);
            }
            let last = &round[round.len() - 1];
            assert_eq!(last.accepted, last.value < largest);
            if last.accepted {
                population[worst] = (last.x[0], last.value);
            }
        }
        assert!(later.iter().any(|trial| trial.accepted));
    }
}

/// A valley of this width in a plain of height 0.8, on 1024 steps that jump by about 2 %.
fn valley(seed: u64) -> (impl Cost, f64) {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let (middle, width): (f64, f64) = (rng.random_range(0.0..1.0), rng.random_range(0.05..0.3));
    let mut value = |i: i32| {
        let x = (f64::from(i) + 0.5) / 1024.0;
        let jitter =
            rng.random_range(-0.02..0.02) + if i % 17 == 0 { rng.random_range(0.0..0.3) } else { 0.0 };
        0.8 - 0.5 * (1.0 - ((x - middle) / width).abs()).max(0.0) + jitter
    };
    let values: Vec<f64> = (0..1024).map(&mut value).collect();
    let lowest = values.iter().copied().fold(f64::INFINITY, f64::min);
    let cost = from_stairs(move |x| {
        let i = (x * 1024.0).floor();
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "in 0..1024")]
        (values[(i as usize).min(1023)], i / 1024.0..(i + 1.0) / 1024.0)
    });
    (cost, lowest)
}

#[test]
fn a_certified_search_finds_low_values_early() {
    // Within 3 % of the range of the lowest: a search that only halves gaps needs about as many as the valley is narrow,
    // and then luck.
    let needed = |batch: usize| {
        let mut needed: Vec<usize> = (0..60)
            .map(|seed| {
                let (mut cost, lowest) = valley(seed);
                let search = CertifiedSearch {
                    batch: NonZeroUsize::new(batch),
                    stopping: Stopping { target: Some(lowest + 0.015), ..Stopping::default() },
                    ..CertifiedSearch::default()
                };
                search.minimise(&mut cost, &Bounds::interval(0.0, 0.9995).unwrap()).unwrap().evaluations
            })
            .collect();
        needed.sort_unstable();
        (needed[30], needed[54])
    };
    let (half, most) = needed(1);
    assert!(half <= 26 && most <= 70, "{half} and {most} evaluations");
    let (half, most) = needed(4);
    assert!(half <= 32 && most <= 75, "{half} and {most} evaluations");
}
