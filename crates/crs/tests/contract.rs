//! Costs that break their contract, and parameters that do not fit, are errors that name the values.

// Results are exact here; a test has no caller to report to.
#![allow(clippy::float_cmp, clippy::unwrap_used)]

use std::num::NonZeroUsize;

use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;
use terrace_crs::{
    Answer, Axis, Bounds, CertifiedSearch, ControlledRandomSearch, Cost, CostError, Evaluation,
    LocalMutation, PatternSearch, SearchError, Step, Steps, Stopping, Sweep, from_fn, from_line, from_stairs,
};

fn rng() -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(1)
}

fn ten() -> Bounds {
    Bounds::interval(0.0, 10.0).unwrap()
}

/// Steps of width one; gives up with this bound whenever it may.
struct GivesUp(f64);

impl Cost for GivesUp {
    fn evaluate(&mut self, x: &[f64]) -> Evaluation {
        Evaluation::interval(10.0 - x[0].floor(), x[0].floor()..x[0].floor() + 1.0)
    }

    fn evaluate_below(&mut self, x: &[f64], _: f64) -> Answer {
        Answer::AtLeast(Evaluation { value: self.0, ..self.evaluate(x) })
    }
}

#[test]
fn giving_up_below_the_ceiling_is_an_error_that_names_x_and_both() {
    let error = Sweep::default().minimise(&mut GivesUp(9.5), &ten()).unwrap_err();
    assert_eq!(error.to_string(), "the cost at x = [1.0] gave up at 9.5, below the ceiling 10.0");
}

#[test]
fn giving_up_with_no_number_is_an_error_that_names_x() {
    for bound in [f64::NAN, f64::INFINITY] {
        let error = Sweep::default().minimise(&mut GivesUp(bound), &ten()).unwrap_err();
        assert!(matches!(error, SearchError::Cost(CostError::NotFinite { x, .. }) if x == [1.0]));
    }
}

#[test]
fn nan_is_an_error_of_every_method() {
    let mut nan = from_line(|_| f64::NAN);
    let cost: &mut dyn Cost = &mut nan;
    for error in [
        ControlledRandomSearch::default().minimise(cost, &ten(), &mut rng()).unwrap_err(),
        LocalMutation::default().minimise(cost, &ten(), &mut rng()).unwrap_err(),
        PatternSearch::default().minimise(cost, &ten(), &mut rng()).unwrap_err(),
        Sweep::default().minimise(cost, &ten()).unwrap_err(),
        CertifiedSearch::default().minimise(cost, &ten()).unwrap_err(),
    ] {
        assert!(matches!(error, SearchError::Cost(CostError::NotFinite { .. })), "{error}");
    }
}

#[test]
fn a_value_below_its_bound_is_an_error_whichever_comes_first() {
    for axes in [1, 2] {
        let bounds = Bounds::new(vec![(0.0, 10.0); axes]).unwrap();
        let on = |value, lo: f64, hi: f64| Evaluation {
            value,
            step: Step::Box { lo: vec![lo; axes], hi: vec![hi; axes] },
        };
        let mut steps = Steps::new(&bounds);
        steps.insert_bound(&vec![1.0; axes], &on(5.0, 0.0, 2.0)).unwrap();
        let error = steps.insert(&vec![1.5; axes], &on(4.0, 1.5, 3.0)).unwrap_err();
        assert!(matches!(error, CostError::BelowBound { .. }), "{error}");
        assert_eq!((steps.len(), steps.find(&vec![1.0; axes])), (0, None));
        steps.insert(&vec![2.0; axes], &on(4.0, 2.0, 3.0)).unwrap();
        let error = steps.insert_bound(&vec![1.0; axes], &on(4.5, 0.0, 2.5)).unwrap_err();
        assert!(matches!(error, CostError::BelowBound { .. }), "{error}");
        assert_eq!(steps.bound_at(&vec![2.2; axes]), None);
        steps.insert_bound(&vec![2.0; axes], &on(4.0, 2.0, 2.5)).unwrap();
        assert_eq!(steps.bound_at(&vec![2.2; axes]), Some(on(4.0, 2.0, 2.5)));
    }
}

struct Miscounts;

impl Cost for Miscounts {
    fn evaluate(&mut self, x: &[f64]) -> Evaluation {
        Evaluation::point(x[0])
    }

    fn evaluate_many(&mut self, _: &[Vec<f64>]) -> Vec<Evaluation> {
        vec![Evaluation::point(1.0)]
    }
}

#[test]
fn another_number_of_answers_is_an_error() {
    let batch = NonZeroUsize::new(3);
    let search = ControlledRandomSearch { batch, ..ControlledRandomSearch::default() };
    let error = search.minimise(&mut Miscounts, &ten(), &mut rng()).unwrap_err();
    assert_eq!(error, SearchError::Cost(CostError::Answers { asked: 3, answered: 1 }));
}

#[test]
fn a_sweep_refuses_several_axes_and_places_without_steps() {
    let plane = Bounds::new([(0.0, 1.0); 2]).unwrap();
    let error = Sweep::default().minimise(&mut Miscounts, &plane).unwrap_err();
    assert_eq!(error, SearchError::NotOneAxis { axes: 2 });
    let error = Sweep::default().minimise(&mut from_line(|x| x), &ten()).unwrap_err();
    assert_eq!(error.to_string(), "the cost tells no step at x = 0.0: it cannot be swept on a real axis");
    // Where there is a next value, or only one, single places are enough.
    for axis in [Axis::Integer { lo: -3, hi: 3 }, Axis::List(vec![0.5, 2.0]), Axis::Real { lo: 2.0, hi: 2.0 }]
    {
        let bounds = Bounds::of([axis.clone()]).unwrap();
        let minimum = Sweep::default().minimise(&mut from_line(|x| -x), &bounds).unwrap();
        assert_eq!((minimum.value, minimum.evaluations as u64), (-axis.hi(), axis.count().unwrap()));
        assert!(minimum.is_proven());
    }
}

#[test]
fn a_start_beside_the_allowed_values_is_an_error_that_names_it() {
    let bounds = Bounds::of([Axis::Integer { lo: 0, hi: 9 }]).unwrap();
    let start = vec![vec![0.5]];
    let expected = SearchError::StartNotAllowed { index: 0, axis: 0, value: 0.5 };
    let mut cost = from_line(|x| x);
    for error in [
        ControlledRandomSearch { start: start.clone(), ..ControlledRandomSearch::default() }.minimise(
            &mut cost,
            &bounds,
            &mut rng(),
        ),
        LocalMutation { start: start.clone(), ..LocalMutation::default() }.minimise(
            &mut cost,
            &bounds,
            &mut rng(),
        ),
        PatternSearch { start: start.clone(), ..PatternSearch::default() }.minimise(
            &mut cost,
            &bounds,
            &mut rng(),
        ),
        CertifiedSearch { start, ..CertifiedSearch::default() }.minimise(&mut cost, &bounds),
    ] {
        assert_eq!(error.unwrap_err(), expected);
    }
}

#[test]
fn parameters_of_a_pattern_search_that_do_not_fit_are_errors() {
    let run = |search: PatternSearch| search.minimise(&mut from_line(|x| x), &ten(), &mut rng()).unwrap_err();
    assert_eq!(
        run(PatternSearch { starts: Some(0), ..PatternSearch::default() }),
        SearchError::EmptyPopulation
    );
    let start = vec![vec![1.0]; 3];
    assert_eq!(
        run(PatternSearch { start, starts: Some(2), ..PatternSearch::default() }),
        SearchError::TooManyStarts { starts: 3, population: 2 }
    );
    for finest in [0.0, -1.0, f64::NAN] {
        let error = run(PatternSearch { finest: Some(finest), ..PatternSearch::default() });
        assert!(matches!(error, SearchError::Mesh { .. }), "{error}");
    }
}

#[test]
fn a_population_of_one_mutates_nothing() {
    let search = LocalMutation { population: Some(1), ..LocalMutation::default() };
    let minimum = search.minimise(&mut from_line(|x| x), &ten(), &mut rng()).unwrap();
    assert_eq!((minimum.calls, minimum.rounds), (1, 0));
}

#[test]
fn values_from_end_to_end_of_the_numbers_break_no_method() {
    let mut cost = from_stairs(|x| {
        let lo = x.floor();
        (if lo % 3.0 == 0.0 { -f64::MAX } else { f64::MAX }, lo..lo + 1.0)
    });
    let minimum = CertifiedSearch::default().minimise(&mut cost, &ten()).unwrap();
    assert_eq!((minimum.value, minimum.evaluations), (-f64::MAX, 11));
    let wide = Bounds::interval(-f64::MAX / 2.0, f64::MAX / 2.0).unwrap();
    let mut cost =
        from_stairs(|x| if x < 0.0 { (1.0, f64::NEG_INFINITY..0.0) } else { (0.0, 0.0..f64::INFINITY) });
    let minimum = CertifiedSearch::default().minimise(&mut cost, &wide).unwrap();
    assert_eq!((minimum.value, minimum.evaluations, minimum.certified), (0.0, 2, Some(1.0)));
}

#[test]
fn a_single_missing_place_is_not_certified() {
    // The step ends at the upper bound, which belongs to the bounds and is not on it.
    let mut steps = Steps::new(&ten());
    steps.insert(&[0.0], &Evaluation::interval(1.0, 0.0..10.0)).unwrap();
    let stopping = Stopping { rounds: Some(1), ..Stopping::default() };
    let sweep = Sweep { stopping, ..Sweep::default() };
    let minimum = sweep.minimise_with(&mut from_line(|_| 2.0), &ten(), &mut steps).unwrap();
    assert_eq!(minimum.certified, Some(1.0_f64.next_down()));
    assert!(!minimum.is_proven());
}

#[test]
fn a_missing_edge_is_not_certified_either() {
    let bounds = Bounds::new([(0.0, 10.0); 2]).unwrap();
    let mut steps = Steps::new(&bounds);
    let step = Step::Box { lo: vec![0.0; 2], hi: vec![10.0, f64::INFINITY] };
    steps.insert(&[0.0, 0.0], &Evaluation { value: 1.0, step }).unwrap();
    let search = CertifiedSearch {
        start: vec![vec![5.0, 5.0]],
        stopping: Stopping { rounds: Some(0), ..Stopping::default() },
        ..CertifiedSearch::default()
    };
    let minimum = search.minimise_with(&mut from_fn(|_| 2.0), &bounds, &mut steps).unwrap();
    assert_eq!((minimum.evaluations, minimum.certified), (0, Some(1.0_f64.next_down())));
}

#[test]
fn a_bound_that_is_too_low_to_prove_anything_spares_no_evaluation() {
    let mut steps = Steps::new(&ten());
    let everywhere = Evaluation::interval(-5.0, f64::NEG_INFINITY..f64::INFINITY);
    steps.insert_bound(&[0.0], &everywhere).unwrap();
    let mut cost = from_stairs(|x| (10.0 - x.floor(), x.floor()..x.floor() + 1.0));
    for minimum in [
        Sweep::default().minimise_with(&mut cost, &ten(), &mut steps.clone()).unwrap(),
        CertifiedSearch::default().minimise_with(&mut cost, &ten(), &mut steps.clone()).unwrap(),
    ] {
        assert_eq!((minimum.value, minimum.evaluations, minimum.is_proven()), (0.0, 11, true));
    }
    // One that is high enough spares all but one.
    let high = Evaluation::interval(3.0, f64::NEG_INFINITY..f64::INFINITY);
    steps.insert_bound(&[0.0], &high).unwrap();
    let mut flat = from_stairs(|x| (3.0, x.floor()..x.floor() + 1.0));
    let minimum = Sweep::default().minimise_with(&mut flat, &ten(), &mut steps).unwrap();
    assert_eq!((minimum.evaluations, minimum.is_proven()), (1, true));
}
