//! All measures against their definitions on sets of points, and what must not matter.
#![allow(clippy::unwrap_used, clippy::float_cmp, reason = "tests")]

use std::collections::{BTreeMap, BTreeSet};

use proptest::prelude::*;
use terrace_eval::{Contingency, EvalError, Evaluation, Measure, PlaneAt, SegComp, Spread};
use terrace_types::{Plane, PlaneId};

type Points = BTreeSet<usize>;

fn labelings() -> impl Strategy<Value = (Vec<i32>, Vec<i32>)> {
    let pairs = prop_oneof![
        prop::collection::vec((-1_i32..5, -1_i32..5), 0..60),
        // Few labels that mostly agree, for splits, merges and correct planes.
        prop::collection::vec((0_i32..4, 0_i32..4, 0_u8..10), 0..60)
            .prop_map(|v| v.into_iter().map(|(t, f, odd)| (t, if odd == 0 { f } else { t / 2 })).collect()),
        prop::collection::vec((0_i32..4, 0_i32..4, 0_u8..10), 0..60)
            .prop_map(|v| v.into_iter().map(|(t, f, odd)| (if odd == 0 { f } else { t / 2 }, t)).collect()),
    ];
    pairs.prop_map(|pairs: Vec<(i32, i32)>| pairs.into_iter().unzip())
}

/// The planes as sets of points, of those whose truth is known.
fn planes(labels: &[i32], truth: &[i32]) -> BTreeMap<i32, Points> {
    let mut planes: BTreeMap<i32, Points> = BTreeMap::new();
    for (point, label) in labels.iter().enumerate().filter(|(point, label)| **label > 0 && truth[*point] >= 0)
    {
        planes.entry(*label).or_default().insert(point);
    }
    planes
}

fn shared(a: &Points, b: &Points) -> f64 {
    a.intersection(b).count() as f64
}

fn iou(a: &Points, b: &Points) -> f64 {
    shared(a, b) / a.union(b).count() as f64
}

fn of(truth: &[i32], found: &[i32]) -> Evaluation {
    Evaluation::of(&Contingency::of_numbers(truth, found).unwrap())
}

/// Hoover's classes by their words.
fn segcomp_by_sets(truth: &BTreeMap<i32, Points>, found: &BTreeMap<i32, Points>, share: f64) -> SegComp {
    let same = |t: &Points, p: &Points| {
        shared(t, p) / p.len() as f64 >= share && shared(t, p) / t.len() as f64 >= share
    };
    let left = |of: &BTreeMap<i32, Points>, other: &BTreeMap<i32, Points>| -> Vec<Points> {
        of.values().filter(|a| !other.values().any(|b| same(a, b))).cloned().collect()
    };
    let (true_left, found_left) = (left(truth, found), left(found, truth));
    // Planes of `wholes` that are made of several of `parts`, and the number of these.
    let composed = |wholes: &[Points], parts: &[Points]| {
        wholes.iter().fold((0, 0), |(count, all), whole| {
            let inside: Vec<&Points> =
                parts.iter().filter(|p| shared(p, whole) / p.len() as f64 >= share).collect();
            let covered: f64 = inside.iter().map(|p| shared(p, whole)).sum();
            if inside.len() >= 2 && covered >= share * whole.len() as f64 {
                (count + 1, all + inside.len())
            } else {
                (count, all)
            }
        })
    };
    let (over, over_found) = composed(&true_left, &found_left);
    let (under, under_true) = composed(&found_left, &true_left);
    SegComp {
        correct: truth.len() - true_left.len(),
        over,
        over_found,
        under,
        under_true,
        missed: true_left.len() - over - under_true,
        noise: found_left.len() - under - over_found,
    }
}

fn close(a: Option<f64>, b: Option<f64>) -> bool {
    match (a, b) {
        (Some(a), Some(b)) => (a - b).abs() < 1e-12,
        (a, b) => a.is_none() && b.is_none(),
    }
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

proptest! {
    #[test]
    fn measures_are_what_sets_give((truth, found) in labelings()) {
        let all = of(&truth, &found);
        let (t, f) = (planes(&truth, &truth), planes(&found, &truth));
        let best: Vec<f64> =
            t.values().map(|t| f.values().map(|f| iou(t, f)).fold(0.0, f64::max)).collect();
        let matched: Vec<(&Points, &Points)> = t
            .values()
            .flat_map(|t| f.values().map(move |f| (t, f)))
            .filter(|(t, f)| iou(t, f) > 0.5)
            .collect();
        let ious: Vec<f64> = matched.iter().map(|(t, f)| iou(t, f)).collect();
        let dice: Vec<f64> =
            matched.iter().map(|(t, f)| 2.0 * shared(t, f) / (t.len() + f.len()) as f64).collect();
        let points: f64 = t.values().map(|t| t.len() as f64).sum();
        let right: f64 = matched.iter().map(|(t, f)| shared(t, f)).sum();
        let outside: Vec<usize> = (0..truth.len()).filter(|i| truth[*i] == 0).collect();
        let claimed = outside.iter().filter(|i| found[**i] > 0).count();

        prop_assert_eq!(all.points, truth.iter().filter(|t| **t >= 0).count() as u64);
        prop_assert!(close(all.cover, mean(&best)));
        prop_assert!(close(all.mean_iou, mean(&ious)));
        prop_assert!(close(all.mean_dice, mean(&dice)));
        prop_assert!(close(all.mean_iou_all, mean(&best).map(|_| ious.iter().sum::<f64>() / t.len() as f64)));
        prop_assert!(close(all.point_accuracy, (points > 0.0).then(|| right / points)));
        let share = claimed as f64 / outside.len() as f64;
        prop_assert!(close(all.non_planar_claimed, (!outside.is_empty()).then_some(share)));
        let of_planes: Vec<f64> = all.planes.iter().map(|plane| plane.best_iou).collect();
        prop_assert_eq!(of_planes, best);
        prop_assert_eq!(all.planes.iter().filter(|plane| plane.found.is_some()).count(), matched.len());
    }

    #[test]
    fn planes_are_sorted_as_sets_are((truth, found) in labelings(), share in prop_oneof![Just(0.8), 0.51..1.0]) {
        let both = Contingency::of_numbers(&truth, &found).unwrap();
        let sorted = both.segcomp(share).unwrap();
        prop_assert_eq!(sorted, segcomp_by_sets(&planes(&truth, &truth), &planes(&found, &truth), share));
        prop_assert_eq!(sorted.correct + sorted.over + sorted.under_true + sorted.missed, both.true_planes());
        prop_assert_eq!(sorted.correct + sorted.over_found + sorted.under + sorted.noise, both.found_planes());
        prop_assert!(sorted.over_found >= 2 * sorted.over && sorted.under_true >= 2 * sorted.under);
    }

    #[test]
    fn exchanged_labelings_exchange_the_measures((truth, found) in labelings()) {
        let known = |labels: &[i32]| labels.iter().map(|label| (*label).max(0)).collect::<Vec<_>>();
        let (truth, found) = (known(&truth), known(&found));
        let (a, b) = (of(&truth, &found), of(&found, &truth));
        for (a, b) in [(a.half, b.half), (a.strict, b.strict)] {
            prop_assert_eq!((a.matched, a.precision(), a.recall()), (b.matched, b.recall(), b.precision()));
        }
        prop_assert!(close(a.mean_iou, b.mean_iou) && close(a.mean_dice, b.mean_dice));
        let (a, b) = (a.segcomp, b.segcomp);
        prop_assert_eq!((a.correct, a.over, a.over_found, a.missed), (b.correct, b.under, b.under_true, b.noise));
    }

    #[test]
    fn numbers_are_names_and_order_does_not_matter((truth, found) in labelings(), turn in 1_i32..1000) {
        let renamed = |labels: &[i32]| {
            labels.iter().rev().map(|l| if *l > 0 { turn + 7 * (9 - l) } else { *l }).collect::<Vec<_>>()
        };
        let (a, b) = (of(&truth, &found), of(&renamed(&truth), &renamed(&found)));
        for (a, b) in a.measures().into_iter().zip(b.measures()) {
            prop_assert_eq!((a.name, a.count), (b.name, b.count));
            prop_assert!(close(a.value, b.value), "{}", a.name);
        }
    }

    #[test]
    fn shares_are_from_0_to_1((truth, found) in labelings()) {
        for Measure { name, value, count } in of(&truth, &found).measures() {
            let in_range = |v: f64| if count { v >= 0.0 && v.fract() == 0.0 } else { (0.0..=1.0).contains(&v) };
            prop_assert!(value.is_none_or(in_range), "{} {:?}", name, value);
        }
    }

    #[test]
    fn the_truth_itself_is_perfect((truth, _) in labelings()) {
        let all = of(&truth, &truth);
        let planes = planes(&truth, &truth).len();
        let one = (planes > 0).then_some(1.0);
        let measures = [all.half.precision(), all.half.recall(), all.strict.f1(), all.mean_iou, all.mean_iou_all,
            all.mean_dice, all.cover, all.weighted_cover, all.point_accuracy];
        prop_assert!(measures.iter().all(|measure| *measure == one), "{:?}", measures);
        prop_assert!(all.non_planar_claimed.is_none_or(|claimed| claimed == 0.0));
        prop_assert_eq!(all.segcomp, SegComp { correct: planes, ..SegComp::default() });
    }
}

#[test]
fn without_planes_there_is_nothing_to_measure() {
    let nothing = of(&[0, 0, -1], &[0, 0, 3]);
    let counts = |m: &Measure| m.count && m.value == Some(0.0);
    for measure in nothing.measures().iter().filter(|m| !counts(m)) {
        let expected = (measure.name == "non_planar_claimed").then_some(0.0);
        assert_eq!(measure.value, expected, "{}", measure.name);
    }
    assert_eq!((nothing.points, nothing.planes), (2, vec![]));
    assert!(Measure::means(&[]).is_empty() && Spread::of([]).is_none());
}

#[test]
fn shares_that_are_not_one_to_one_are_an_error() {
    let both = Contingency::of_numbers(&[1], &[1]).unwrap();
    for share in [0.5, 1.01, -1.0, f64::INFINITY] {
        assert_eq!(both.segcomp(share), Err(EvalError::Share { share }));
    }
    assert!(both.segcomp(f64::NAN).is_err());
    assert_eq!(both.segcomp(1.0).unwrap().correct, 1);
    assert_eq!(Contingency::of_numbers(&[1, 2], &[1]), Err(EvalError::Length { truth: 2, found: 1 }));
}

#[test]
fn means_are_over_rows_with_a_value() {
    let rows =
        [Some(0.2), None, Some(0.6)].map(|value| vec![Measure::new("x", value), Measure::count("n", 3)]);
    let means = Measure::means(&rows);
    assert!(close(means[0].value, Some(0.4)));
    assert_eq!((means[1].value, means[1].count), (Some(3.0), false));
}

#[test]
fn angles_and_offsets_do_not_see_the_sign_of_a_normal() {
    let floor = Plane::through([0.0, 0.0, 1.0], [0.0, 0.0, 1.0]).unwrap();
    // Turned by 0.1 about the y axis through a point 2 cm above the floor at x = 3.
    let turned = Plane::through([3.0, 0.0, 1.02], [0.1_f64.sin(), 0.0, 0.1_f64.cos()]).unwrap();
    for plane in [turned, turned.flipped()] {
        // A centre off the plane counts where its foot is.
        let [a, b, c] = turned.normal();
        let centre = Some([3.0 + 0.5 * a, 0.5 * b, 1.02 + 0.5 * c]);
        for truth in [floor, floor.flipped()] {
            let (angle, offset) = PlaneAt { plane, centre }.against(&truth);
            assert!((angle - 0.1).abs() < 1e-12 && (offset.unwrap() - 0.02).abs() < 1e-12);
        }
    }
    let (right_angle, offset) =
        PlaneAt { plane: floor, centre: None }.against(&Plane::through([0.0; 3], [1.0, 0.0, 0.0]).unwrap());
    assert!((right_angle - std::f64::consts::FRAC_PI_2).abs() < 1e-15 && offset.is_none());
}

#[test]
fn deviations_are_of_matched_planes_with_both_planes_known() {
    let all = of(&[1, 1, 2, 2, 3, 3], &[4, 4, 5, 5, 6, 0]);
    let plane = Plane::through([0.0; 3], [0.0, 0.0, 1.0]).unwrap();
    let id = |number| PlaneId::new(number).unwrap();
    let truth = [1, 2, 3].map(|number| (id(number), plane)).into();
    let found = [5, 6].map(|number| (id(number), PlaneAt { plane, centre: None })).into();
    let deviations = all.deviations(&truth, &found);
    assert_eq!(deviations.iter().map(|d| (d.truth.get(), d.found.get())).collect::<Vec<_>>(), [(2, 5)]);
}

#[test]
fn spreads_have_the_median_of_even_and_odd_numbers() {
    let spread = |values: &[f64]| Spread::of(values.iter().copied()).unwrap();
    assert_eq!(spread(&[4.0, 1.0, 2.0]), Spread { median: 2.0, mean: 7.0 / 3.0, max: 4.0 });
    assert_eq!(spread(&[4.0, 1.0, 2.0, 3.0]).median, 2.5);
}
