//! Searches and known steps against brute force on random staircases.

// Results are exact here; a test has no caller to report to.
#![allow(clippy::float_cmp, clippy::unwrap_used)]

mod common;

use common::{AskedOnce, Staircase, Tells, around, staircase};
use proptest::prelude::*;
use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;
use rand::seq::SliceRandom;
use terrace_crs::{
    Bounds, ControlledRandomSearch, Evaluation, Minimum, Source, Step, Steps, StopReason, Stopping,
};

fn search() -> impl Strategy<Value = ControlledRandomSearch> {
    let spread = prop_oneof![Just(None), Just(Some(0.0)), (0.0..100.0_f64).prop_map(Some)];
    let population = prop_oneof![
        Just((None, None)),
        (2..30_usize).prop_flat_map(|n| (Just(Some(n)), (2..=n).prop_map(Some)))
    ];
    (population, 0..400_usize, spread).prop_map(|((population, subset), rounds, spread)| {
        let stopping = Stopping { rounds: Some(rounds), spread, ..Stopping::default() };
        ControlledRandomSearch { population, subset, stopping, ..ControlledRandomSearch::default() }
    })
}

fn run(search: &ControlledRandomSearch, staircase: &Staircase, seed: u64) -> Minimum {
    let mut cost = AskedOnce::new(staircase, false);
    search.minimise(&mut cost, &staircase.bounds(), &mut ChaCha8Rng::seed_from_u64(seed)).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn the_result_is_true_and_the_best_that_was_seen(s in staircase(), c in search(), seed: u64) {
        let minimum = run(&c, &s, seed);
        prop_assert!(s.bounds().contains(&minimum.x));
        prop_assert_eq!(minimum.value, s.value(&minimum.x));
        prop_assert!(minimum.value >= s.lowest());
        let first = minimum.trace.iter().find(|trial| trial.value <= minimum.value);
        prop_assert_eq!(first.map(|trial| &trial.x), Some(&minimum.x), "the earlier found wins");
        prop_assert!(minimum.trace.iter().all(|trial| trial.value >= minimum.value));
    }

    #[test]
    fn the_reported_step_holds_the_value_to_its_borders(s in staircase(), c in search(), seed: u64) {
        let minimum = run(&c, &s, seed);
        prop_assert!(minimum.step.contains(&minimum.x, &minimum.x));
        for place in around(&minimum.step, &minimum.x) {
            if minimum.step.contains(&minimum.x, &place) {
                prop_assert_eq!(s.value(&place), minimum.value);
            }
        }
    }

    #[test]
    fn the_trace_is_true_and_its_counts_add_up(s in staircase(), c in search(), seed: u64) {
        let minimum = run(&c, &s, seed);
        prop_assert_eq!(minimum.calls, minimum.trace.len());
        let evaluated = minimum.trace.iter().filter(|trial| trial.source == Source::Evaluated).count();
        prop_assert_eq!(minimum.evaluations, evaluated);
        prop_assert!(minimum.evaluations <= minimum.calls);
        if s.tells == Tells::All {
            prop_assert!(minimum.evaluations <= s.cells());
        }
        for trial in &minimum.trace {
            prop_assert!(s.bounds().contains(&trial.x));
            prop_assert_eq!(trial.value, s.value(&trial.x));
        }
    }

    #[test]
    fn the_trace_replays_the_rules(s in staircase(), c in search(), seed: u64) {
        let minimum = run(&c, &s, seed);
        let (first, later): (Vec<_>, Vec<_>) = minimum.trace.iter().partition(|trial| trial.round == 0);
        prop_assert!(first.iter().all(|trial| trial.accepted));
        prop_assert_eq!(first.len(), c.population.unwrap_or(10 * (s.cuts.len() + 3)));
        // The population in the order found, so that the last of the largest is the one to go.
        let mut population: Vec<(&[f64], f64)> = first.iter().map(|trial| (&*trial.x, trial.value)).collect();
        let largest = |p: &[(&[f64], f64)]| p.iter().map(|(_, value)| *value).fold(f64::MIN, f64::max);
        let mut round = 0;
        for trial in later {
            prop_assert!(trial.round > round && trial.round <= minimum.rounds);
            round = trial.round;
            let most = largest(&population);
            prop_assert_eq!(trial.accepted, trial.value < most);
            if trial.accepted {
                let worst = population.iter().rposition(|(_, value)| *value == most).unwrap();
                population.remove(worst);
                population.push((&trial.x, trial.value));
            }
        }
        let spread = largest(&population) - minimum.value;
        match minimum.stop {
            StopReason::Rounds => prop_assert_eq!(Some(minimum.rounds), c.stopping.rounds),
            StopReason::Spread => prop_assert!(Some(spread) <= c.stopping.spread),
            StopReason::OneStep => {
                prop_assert_eq!(spread, 0.0);
                // Members on one known step share a cell.
                let cell = s.cell(&minimum.x).0;
                prop_assert!(population.iter().all(|(x, _)| s.cell(x).0 == cell));
            }
            other => prop_assert!(false, "unexpected {other:?}"),
        }
    }

    #[test]
    fn the_same_seed_gives_the_same_trace(s in staircase(), c in search(), seed: u64) {
        prop_assert_eq!(run(&c, &s, seed), run(&c, &s, seed));
    }

    #[test]
    fn knowing_steps_changes_the_price_and_not_the_way(s in staircase(), c in search(), seed: u64) {
        let ignorant = Staircase { tells: Tells::Nothing, ..s.clone() };
        let (known, unknown) = (run(&c, &s, seed), run(&c, &ignorant, seed));
        prop_assert!(known.evaluations <= unknown.evaluations);
        // A population on one step ends the search early; up to there both ask the same.
        for (a, b) in known.trace.iter().zip(&unknown.trace) {
            prop_assert_eq!((&a.x, a.value, a.accepted), (&b.x, b.value, b.accepted));
        }
    }

    #[test]
    fn steps_know_what_was_inserted_and_nothing_else_in_any_order(
        s in staircase(),
        places in prop::collection::vec(prop::collection::vec(0.0..1.0_f64, 3), 1..30),
        order: u64,
    ) {
        let axes = s.cuts.len();
        let mut answers: Vec<(Vec<f64>, Evaluation)> =
            places.iter().map(|x| (x[..axes].to_vec(), s.answer(&x[..axes]))).collect();
        let fill = |answers: &[(Vec<f64>, Evaluation)]| {
            let mut steps = Steps::new(&s.bounds());
            for (x, answer) in answers {
                steps.insert(x, answer).unwrap();
            }
            steps
        };
        let steps = fill(&answers);
        let probes: Vec<Vec<f64>> =
            answers.iter().flat_map(|(x, answer)| around(&answer.step, x)).chain(places.iter().map(|x| x[..axes].iter().rev().copied().collect())).collect();
        let brute = |x: &[f64]| {
            answers.iter().find(|(origin, a)| a.step.contains(origin, x)).map(|(_, a)| a.value)
        };
        for x in &probes {
            prop_assert_eq!(steps.find(x), brute(x), "at {:?}", x);
            let at = steps.step_at(x);
            prop_assert_eq!(at.as_ref().map(|e| e.value), brute(x));
            prop_assert!(at.is_none_or(|e| e.step.contains(x, x)));
        }
        let known: Vec<Option<f64>> = probes.iter().map(|x| steps.find(x)).collect();
        answers.shuffle(&mut ChaCha8Rng::seed_from_u64(order));
        let shuffled = fill(&answers);
        prop_assert_eq!(probes.iter().map(|x| shuffled.find(x)).collect::<Vec<_>>(), known);
    }

    #[test]
    fn very_many_boxes_are_found_as_by_looking_at_each(
        side in 5..20_usize, axes in 2..4_usize, reach in 0.1..2.0_f64, points in 0..60_usize, order: u64,
    ) {
        // Cells of a raster, some of them told in part only, so that boxes overlap.
        let side = if axes == 2 { side } else { side / 2 + 1 };
        let cells = side.pow(u32::try_from(axes).unwrap());
        let mut answers: Vec<(Vec<f64>, Evaluation)> = (0..2 * cells + points)
            .map(|number| {
                let (mut cell, mut lo) = (number % cells, Vec::new());
                for _ in 0..axes {
                    lo.push((cell % side) as f64);
                    cell /= side;
                }
                let part = if number < cells { 0.5 } else { 0.25 };
                let x: Vec<f64> = lo.iter().map(|lo| lo + part).collect();
                let step = Step::Box {
                    lo: lo.iter().zip(&x).map(|(lo, x)| lo.max(x - reach)).collect(),
                    hi: lo.iter().zip(&x).map(|(lo, x)| (lo + 1.0).min(x + reach)).collect(),
                };
                let step = if number < 2 * cells { step } else { Step::Point };
                (x, Evaluation { value: (number % cells) as f64, step })
            })
            .collect();
        answers.shuffle(&mut ChaCha8Rng::seed_from_u64(order));
        let mut steps = Steps::new(&Bounds::new(vec![(0.0, side as f64); axes]).unwrap());
        for (number, (x, answer)) in answers.iter().enumerate() {
            steps.insert(x, answer).unwrap();
            if number % 7 != 0 {
                continue;
            }
            let known = &answers[..=number];
            for probe in around(&answer.step, x).into_iter().chain([answers[(number * 13) % answers.len()].0.clone()]) {
                let mut all = known.iter().filter(|(origin, a)| a.step.contains(origin, &probe));
                prop_assert_eq!(steps.find(&probe), all.next().map(|(_, a)| a.value));
                let boxed = known.iter().find(|(o, a)| a.step != Step::Point && a.step.contains(o, &probe));
                if let Some((_, first)) = boxed {
                    prop_assert_eq!(steps.step_at(&probe), Some(first.clone()), "the earliest answers");
                }
            }
            let wrong = Evaluation { value: -1.0, step: answer.step.clone() };
            prop_assert!(steps.insert(x, &wrong).is_err());
        }
    }

    #[test]
    fn the_highest_lower_bound_answers(
        bounds in prop::collection::vec((0..16_u8, 1..9_u8, 0..5_u8, 0..8_u8), 1..60), axes in 1..4_usize,
    ) {
        let mut steps = Steps::new(&Bounds::new(vec![(0.0, 25.0); axes]).unwrap());
        let mut told = Vec::new();
        for (lo, width, value, shift) in bounds {
            // Shifted along the first axis, so that boxes cross and do not only nest.
            let mut lo = vec![f64::from(lo); axes];
            lo[0] = (lo[0] + f64::from(shift)) % 17.0;
            let hi: Vec<f64> = lo.iter().map(|lo| lo + f64::from(width)).collect();
            let bound = Evaluation { value: f64::from(value), step: Step::Box { lo: lo.clone(), hi } };
            steps.insert_bound(&lo, &bound).unwrap();
            told.push((lo, bound));
            for at in 0..50 {
                let mut x = vec![f64::from(at) / 2.0; axes];
                x[0] = (x[0] + 3.0) % 25.0;
                let around = told.iter().filter(|(origin, bound)| bound.step.contains(origin, &x));
                let highest = around.map(|(_, bound)| bound.value).reduce(f64::max);
                let answer = steps.bound_at(&x);
                prop_assert_eq!(answer.as_ref().map(|bound| bound.value), highest);
                prop_assert!(answer.is_none_or(|bound| bound.step.contains(&x, &x)));
                prop_assert_eq!(steps.find(&x), None, "a bound is no value");
            }
        }
    }

    #[test]
    fn borders_are_exact(lo in -1e6..1e6_f64, width in 1e-6..1e6_f64, part in 0.0..1.0_f64, axes in 1..4_usize) {
        let hi = lo + width;
        let x = (lo + part * width).clamp(lo, hi.next_down());
        let mut steps = Steps::new(&Bounds::new(vec![(-1e9, 1e9); axes]).unwrap());
        let step = Step::Box { lo: vec![lo; axes], hi: vec![hi; axes] };
        steps.insert(&vec![x; axes], &Evaluation { value: 5.0, step }).unwrap();
        for axis in 0..axes {
            for (at, known) in [(lo, true), (lo.next_down(), false), (hi.next_down(), true), (hi, false)] {
                let mut place = vec![x; axes];
                place[axis] = at;
                prop_assert_eq!(steps.find(&place), known.then_some(5.0), "at {:?}", place);
            }
        }
    }

    #[test]
    fn a_single_point_knows_no_neighbour(x in prop::collection::vec(any::<f64>().prop_filter("finite", |x| x.is_finite()), 1..4)) {
        let mut steps = Steps::new(&Bounds::new(vec![(0.0, 1.0); x.len()]).unwrap());
        steps.insert(&x, &Evaluation::point(1.0)).unwrap();
        prop_assert_eq!(steps.find(&x), Some(1.0));
        prop_assert_eq!(steps.step_at(&x), Some(Evaluation::point(1.0)));
        for axis in 0..x.len() {
            for near in [x[axis].next_down(), x[axis].next_up()] {
                let mut place = x.clone();
                place[axis] = near;
                prop_assert_eq!(steps.find(&place), None);
            }
        }
    }
}
