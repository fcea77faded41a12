//! Input at the edge of what has a meaning: defined results, or errors that name the values.

// Results are exact here; a test has no caller to report to.
#![allow(clippy::float_cmp, clippy::unwrap_used)]

use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;
use terrace_crs::{
    Bounds, ControlledRandomSearch, Cost, CostError, Evaluation, Minimum, SearchError, Source, Step, Steps,
    StopReason, Stopping, from_fn, from_line, from_stairs,
};

fn rng() -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(11)
}

fn unit() -> Bounds {
    Bounds::interval(0.0, 1.0).unwrap()
}

fn run(search: &ControlledRandomSearch, cost: &mut impl Cost) -> Result<Minimum, SearchError> {
    search.minimise(cost, &unit(), &mut rng())
}

fn rounds(rounds: usize) -> Stopping {
    Stopping { rounds: Some(rounds), ..Stopping::default() }
}

/// Eight steps; an eighth is exact, and so are their borders.
fn eighths() -> impl Cost {
    from_stairs(|x| {
        let step = (x * 8.0).floor();
        ((step - 3.0).abs(), step / 8.0..(step + 1.0) / 8.0)
    })
}

#[test]
fn a_population_of_one_is_its_own_result() {
    let search = ControlledRandomSearch { population: Some(1), ..ControlledRandomSearch::default() };
    let minimum = run(&search, &mut from_line(|x| x)).unwrap();
    assert_eq!((minimum.calls, minimum.evaluations, minimum.rounds), (1, 1, 0));
    assert_eq!(minimum.stop, StopReason::OneStep);
    assert_eq!(minimum.step, Step::Point);
}

#[test]
fn a_population_of_one_holds_the_start() {
    let search = ControlledRandomSearch {
        population: Some(1),
        start: vec![vec![0.25]],
        ..ControlledRandomSearch::default()
    };
    assert_eq!(run(&search, &mut from_line(|x| x)).unwrap().x, [0.25]);
}

#[test]
fn a_population_of_zero_is_an_error() {
    let search = ControlledRandomSearch { population: Some(0), ..ControlledRandomSearch::default() };
    assert_eq!(run(&search, &mut from_line(|x| x)), Err(SearchError::EmptyPopulation));
}

#[test]
fn a_population_smaller_than_a_simplex_reflects_what_it_has() {
    let bounds = Bounds::new([(0.0, 1.0); 5]).unwrap();
    let search = ControlledRandomSearch {
        population: Some(2),
        stopping: rounds(50),
        ..ControlledRandomSearch::default()
    };
    let minimum = search.minimise(&mut from_fn(|x| x.iter().sum()), &bounds, &mut rng()).unwrap();
    assert!(bounds.contains(&minimum.x));
}

#[test]
fn a_subset_above_the_population_is_an_error() {
    for (subset, population) in [(5, 4), (2, 1)] {
        let search = ControlledRandomSearch {
            population: Some(population),
            subset: Some(subset),
            ..ControlledRandomSearch::default()
        };
        let error = run(&search, &mut from_line(|x| x)).unwrap_err();
        assert_eq!(error, SearchError::SubsetTooLarge { subset, population });
    }
}

#[test]
fn a_subset_below_two_is_an_error() {
    for subset in [0, 1] {
        let search = ControlledRandomSearch { subset: Some(subset), ..ControlledRandomSearch::default() };
        let error = run(&search, &mut from_line(|x| x)).unwrap_err();
        assert_eq!(error, SearchError::SubsetTooSmall { subset });
    }
}

#[test]
fn a_subset_of_the_whole_population_works() {
    let search = ControlledRandomSearch {
        population: Some(6),
        subset: Some(6),
        stopping: rounds(30),
        ..ControlledRandomSearch::default()
    };
    assert_eq!(run(&search, &mut from_line(|x| x)).unwrap().rounds, 30);
}

#[test]
fn zero_rounds_give_the_best_of_the_first_population() {
    let search = ControlledRandomSearch { stopping: rounds(0), ..ControlledRandomSearch::default() };
    let minimum = run(&search, &mut from_line(|x| x)).unwrap();
    assert_eq!((minimum.stop, minimum.rounds), (StopReason::Rounds, 0));
    let lowest = minimum.trace.iter().map(|trial| trial.value).fold(f64::INFINITY, f64::min);
    assert_eq!(minimum.value, lowest);
    assert!(minimum.trace.iter().all(|trial| trial.accepted && trial.round == 0));
}

#[test]
fn bounds_of_zero_width_take_one_evaluation() {
    let bounds = Bounds::new([(0.1, 0.1), (-3.0, -3.0)]).unwrap();
    let minimum = ControlledRandomSearch::default()
        .minimise(&mut from_fn(|x| x[0] * x[1]), &bounds, &mut rng())
        .unwrap();
    assert_eq!(minimum.x, [0.1, -3.0]);
    assert_eq!((minimum.evaluations, minimum.rounds, minimum.stop), (1, 0, StopReason::OneStep));
}

#[test]
fn one_axis_of_zero_width_does_not_stop_the_others() {
    let bounds = Bounds::new([(0.1, 0.1), (0.0, 1.0)]).unwrap();
    let minimum =
        ControlledRandomSearch::default().minimise(&mut from_fn(|x| x[1]), &bounds, &mut rng()).unwrap();
    assert_eq!(minimum.x[0], 0.1);
    assert!(minimum.value < 1e-3, "{minimum:?}");
}

#[test]
fn a_constant_cost_is_one_step_and_one_evaluation() {
    let everywhere = f64::NEG_INFINITY..f64::INFINITY;
    let minimum =
        run(&ControlledRandomSearch::default(), &mut from_stairs(|_| (4.0, everywhere.clone()))).unwrap();
    assert_eq!((minimum.value, minimum.evaluations, minimum.stop), (4.0, 1, StopReason::OneStep));
    assert_eq!(minimum.step, Step::interval(everywhere));
    assert_eq!(minimum.x, minimum.trace[0].x, "of equal values the earlier found wins");
}

#[test]
fn a_constant_cost_without_steps_ends_by_rounds_or_by_spread() {
    let minimum = run(&ControlledRandomSearch::default(), &mut from_line(|_| 4.0)).unwrap();
    assert_eq!(minimum.stop, StopReason::Rounds);
    assert!(minimum.trace.iter().skip(40).all(|trial| !trial.accepted));
    let stopping = Stopping { spread: Some(0.0), ..Stopping::default() };
    let search = ControlledRandomSearch { stopping, ..ControlledRandomSearch::default() };
    let minimum = run(&search, &mut from_line(|_| 4.0)).unwrap();
    assert_eq!((minimum.stop, minimum.rounds), (StopReason::Spread, 0));
}

#[test]
fn costs_from_end_to_end_of_the_numbers_do_not_overflow_into_convergence() {
    let stopping = Stopping { spread: Some(1.0), rounds: Some(5), ..Stopping::default() };
    let search = ControlledRandomSearch { stopping, ..ControlledRandomSearch::default() };
    let minimum = run(&search, &mut from_line(|x| if x < 0.5 { -f64::MAX } else { f64::MAX })).unwrap();
    assert_eq!((minimum.stop, minimum.value), (StopReason::Rounds, -f64::MAX));
}

#[test]
fn bounds_as_wide_as_numbers_allow_do_not_panic() {
    let bounds = Bounds::new([(-f64::MAX / 2.0, f64::MAX / 2.0), (0.0, f64::MAX)]).unwrap();
    let minimum = ControlledRandomSearch::default()
        .minimise(&mut from_fn(|x| x[0].signum()), &bounds, &mut rng())
        .unwrap();
    assert_eq!(minimum.value, -1.0);
}

#[test]
fn a_spread_that_is_no_tolerance_is_an_error() {
    for spread in [-1.0, f64::NAN] {
        let stopping = Stopping { spread: Some(spread), ..Stopping::default() };
        let search = ControlledRandomSearch { stopping, ..ControlledRandomSearch::default() };
        let error = run(&search, &mut from_line(|x| x)).unwrap_err();
        assert!(matches!(error, SearchError::Spread { .. }), "{error}");
    }
}

#[test]
fn nan_and_infinite_costs_are_errors_that_name_x() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let search = ControlledRandomSearch { start: vec![vec![0.75]], ..ControlledRandomSearch::default() };
        let error = run(&search, &mut from_line(|x| if x == 0.75 { bad } else { x })).unwrap_err();
        assert!(
            matches!(&error, SearchError::Cost(CostError::NotFinite { x, .. }) if x == &[0.75]),
            "{error}"
        );
        assert_eq!(error.to_string(), format!("the cost at x = [0.75] is {bad:?}, not a finite number"));
    }
}

#[test]
fn a_step_without_x_is_an_error_that_names_both() {
    let search = ControlledRandomSearch { start: vec![vec![0.75]], ..ControlledRandomSearch::default() };
    for step in [0.0..0.75, 0.8..0.9, 0.9..0.1, f64::NAN..1.0] {
        let error = run(&search, &mut from_stairs(|_| (1.0, step.clone()))).unwrap_err();
        let text = format!(
            "the step of the cost at x = [0.75] does not contain x: [{:?}, {:?})",
            step.start, step.end
        );
        assert_eq!(error.to_string(), text);
    }
}

struct Flat;

impl Cost for Flat {
    fn evaluate(&mut self, _: &[f64]) -> Evaluation {
        Evaluation::interval(0.0, 0.0..2.0)
    }
}

#[test]
fn a_step_of_another_dimension_is_an_error() {
    let bounds = Bounds::new([(0.0, 1.0); 2]).unwrap();
    let error = ControlledRandomSearch::default().minimise(&mut Flat, &bounds, &mut rng()).unwrap_err();
    assert!(matches!(error, SearchError::Cost(CostError::StepWithoutX { .. })), "{error}");
}

#[test]
fn steps_that_overlap_with_other_values_are_an_error() {
    // The cost claims a step of 0.4 on either side, which is too much.
    let error =
        run(&ControlledRandomSearch::default(), &mut from_stairs(|x| (x, x - 0.4..x + 0.4))).unwrap_err();
    assert!(matches!(error, SearchError::Cost(CostError::Disagreement { .. })), "{error}");
}

#[test]
fn starts_come_first_and_are_kept_in_order() {
    let search =
        ControlledRandomSearch { start: vec![vec![0.9], vec![0.1]], ..ControlledRandomSearch::default() };
    let minimum = run(&search, &mut eighths()).unwrap();
    assert_eq!(minimum.trace[0].x, [0.9]);
    assert_eq!(minimum.trace[1].x, [0.1]);
}

#[test]
fn a_start_outside_the_bounds_is_an_error_that_names_axis_and_value() {
    for value in [1.5, f64::NAN, f64::NEG_INFINITY] {
        let search = ControlledRandomSearch {
            start: vec![vec![0.5], vec![value]],
            ..ControlledRandomSearch::default()
        };
        let error = run(&search, &mut from_line(|x| x)).unwrap_err();
        assert_eq!(
            error.to_string(),
            format!("start place 1 is outside the bounds on axis 0: {value:?} is not in [0.0, 1.0]")
        );
    }
}

#[test]
fn a_start_of_another_dimension_is_an_error() {
    let search = ControlledRandomSearch { start: vec![vec![0.5, 0.5]], ..ControlledRandomSearch::default() };
    let error = run(&search, &mut from_line(|x| x)).unwrap_err();
    assert_eq!(error, SearchError::StartDimension { index: 0, axes: 2, dimension: 1 });
}

#[test]
fn more_starts_than_members_are_an_error_only_if_the_population_was_chosen() {
    let start = vec![vec![0.5]; 100];
    let search = ControlledRandomSearch { start, ..ControlledRandomSearch::default() };
    assert!(run(&search, &mut eighths()).is_ok());
    let search = ControlledRandomSearch { population: Some(99), ..search };
    let error = run(&search, &mut eighths()).unwrap_err();
    assert_eq!(error, SearchError::TooManyStarts { starts: 100, population: 99 });
}

#[test]
fn a_cost_or_steps_of_another_dimension_are_errors() {
    let bounds = Bounds::new([(0.0, 1.0); 2]).unwrap();
    let search = ControlledRandomSearch::default();
    let error = search.minimise(&mut eighths(), &bounds, &mut rng()).unwrap_err();
    assert_eq!(error, SearchError::CostDimension { cost: 1, bounds: 2 });
    let mut steps = Steps::new(&unit());
    let error = search.minimise_with(&mut from_fn(|x| x[0]), &bounds, &mut steps, &mut rng()).unwrap_err();
    assert_eq!(error, SearchError::StepsDimension { steps: 1, bounds: 2 });
}

#[test]
fn a_trial_outside_the_bounds_counts_as_a_round_and_asks_nothing() {
    // Reflections of two members at the ends leave the bounds nearly always.
    let search = ControlledRandomSearch {
        population: Some(2),
        start: vec![vec![0.0], vec![1.0]],
        stopping: rounds(100),
        ..ControlledRandomSearch::default()
    };
    let minimum = run(&search, &mut from_line(|x| x)).unwrap();
    assert_eq!((minimum.rounds, minimum.calls), (100, 2));
}

#[test]
fn steps_refuse_what_is_no_place() {
    let mut steps = Steps::new(&unit());
    for x in [vec![], vec![f64::NAN], vec![f64::INFINITY], vec![0.0, 0.0]] {
        assert!(matches!(steps.insert(&x, &Evaluation::point(0.0)), Err(CostError::NoPlace { .. })));
        assert_eq!(steps.find(&x), None);
    }
    assert!(steps.is_empty());
}

#[test]
fn zero_and_negative_zero_are_one_place() {
    for axes in [1, 2] {
        let mut steps = Steps::new(&Bounds::new(vec![(-1.0, 1.0); axes]).unwrap());
        steps.insert(&vec![-0.0; axes], &Evaluation::point(3.0)).unwrap();
        assert_eq!(steps.find(&vec![0.0; axes]), Some(3.0));
        assert_eq!(steps.find(&vec![f64::from_bits(1); axes]), None);
        assert_eq!(steps.step_at(&vec![0.0; axes]), Some(Evaluation::point(3.0)));
    }
}

#[test]
fn a_disagreement_leaves_the_steps_as_they_were() {
    let mut steps = Steps::new(&unit());
    steps.insert(&[0.1], &Evaluation::interval(1.0, 0.0..0.2)).unwrap();
    steps.insert(&[0.5], &Evaluation::point(2.0)).unwrap();
    let error = steps.insert(&[0.3], &Evaluation::interval(1.0, 0.1..0.6)).unwrap_err();
    assert_eq!(
        error.to_string(),
        format!("the cost at x = [0.3] is 1 on [0.1, 0.6), but was 2 on [0.5, {:?})", 0.5_f64.next_up())
    );
    assert_eq!((steps.len(), steps.find(&[0.3]), steps.find(&[0.1])), (2, None, Some(1.0)));
}

#[test]
fn a_disagreement_in_the_plane_is_found_with_boxes_and_with_points() {
    let square =
        |value, lo: f64, hi: f64| Evaluation { value, step: Step::Box { lo: vec![lo; 2], hi: vec![hi; 2] } };
    let mut steps = Steps::new(&Bounds::new([(0.0, 1.0); 2]).unwrap());
    steps.insert(&[0.1, 0.1], &square(1.0, 0.0, 0.2)).unwrap();
    steps.insert(&[0.8, 0.8], &Evaluation::point(2.0)).unwrap();
    for (x, new) in [
        ([0.3, 0.3], square(2.0, 0.1, 0.4)),
        ([0.7, 0.7], square(1.0, 0.6, 0.9)),
        ([0.1, 0.0], Evaluation::point(2.0)),
        ([0.8, 0.8], Evaluation::point(1.0)),
    ] {
        let error = steps.insert(&x, &new).unwrap_err();
        assert!(matches!(error, CostError::Disagreement { .. }), "{error}");
    }
    assert_eq!((steps.len(), steps.find(&[0.3, 0.3]), steps.find(&[0.7, 0.7])), (2, None, None));
    // Touching is not overlapping, and the same again is nothing new.
    steps.insert(&[0.2, 0.2], &square(3.0, 0.2, 0.4)).unwrap();
    steps.insert(&[0.3, 0.3], &square(3.0, 0.2, 0.4)).unwrap();
    assert_eq!(steps.len(), 3);
}

#[test]
fn a_step_answers_for_the_points_it_covers() {
    for axes in [1, 2] {
        let mut steps = Steps::new(&Bounds::new(vec![(0.0, 1.0); axes]).unwrap());
        steps.insert(&vec![0.5; axes], &Evaluation::point(2.0)).unwrap();
        let step = Step::Box { lo: vec![0.0; axes], hi: vec![1.0; axes] };
        let evaluation = Evaluation { value: 2.0, step };
        steps.insert(&vec![0.1; axes], &evaluation).unwrap();
        assert_eq!(steps.step_at(&vec![0.5; axes]), Some(evaluation));
    }
}

#[test]
fn a_later_search_of_the_same_cost_pays_nothing_for_what_is_known() {
    let mut steps = Steps::new(&unit());
    let search = ControlledRandomSearch { stopping: rounds(50), ..ControlledRandomSearch::default() };
    let first = search.minimise_with(&mut eighths(), &unit(), &mut steps, &mut rng()).unwrap();
    let second = search.minimise_with(&mut eighths(), &unit(), &mut steps, &mut rng()).unwrap();
    assert!(first.evaluations > 0);
    assert_eq!(second.evaluations, 0);
    assert!(second.trace.iter().all(|trial| trial.source == Source::Known));
    assert_eq!((first.x, first.value), (second.x, second.value));
}
