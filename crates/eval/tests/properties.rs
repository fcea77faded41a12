//! Against sets of points, and what must not matter.
#![allow(clippy::unwrap_used, clippy::float_cmp, reason = "tests")]

use std::collections::BTreeSet;

use proptest::prelude::*;
use terrace_eval::{Contingency, EvalError};
use terrace_types::PlaneId;

type Labels = Vec<Option<PlaneId>>;

fn labelings() -> impl Strategy<Value = (Labels, Labels)> {
    prop::collection::vec((0_u32..5, 0_u32..5), 0..60)
        .prop_map(|pairs| pairs.into_iter().map(|(t, f)| (PlaneId::new(t), PlaneId::new(f))).unzip())
}

/// The planes as sets of points.
fn planes(labels: &Labels) -> Vec<(PlaneId, BTreeSet<usize>)> {
    let ids: BTreeSet<PlaneId> = labels.iter().flatten().copied().collect();
    let points = |id| (0..labels.len()).filter(|i| labels[*i] == Some(id)).collect();
    ids.into_iter().map(|id| (id, points(id))).collect()
}

fn iou(a: &BTreeSet<usize>, b: &BTreeSet<usize>) -> f64 {
    a.intersection(b).count() as f64 / a.union(b).count() as f64
}

/// The definitions word for word: weighted cover, and the number of matches.
fn by_sets(truth: &Labels, found: &Labels, at: f64) -> (Option<f64>, usize) {
    let (truth, found) = (planes(truth), planes(found));
    let best = |t: &BTreeSet<usize>| found.iter().map(|(_, p)| iou(p, t)).fold(0.0, f64::max);
    let size: f64 = truth.iter().map(|(_, t)| t.len() as f64).sum();
    let cover: f64 = truth.iter().map(|(_, t)| t.len() as f64 * best(t)).sum();
    let matched = truth.iter().flat_map(|(_, t)| found.iter().filter(move |(_, p)| iou(p, t) > at)).count();
    (if truth.is_empty() { None } else { Some(cover / size) }, matched)
}

proptest! {
    #[test]
    fn counts_give_what_sets_give((truth, found) in labelings(), at in 0.5..1.0) {
        let both = Contingency::new(&truth, &found).unwrap();
        let (cover, matched) = by_sets(&truth, &found, at);
        prop_assert_eq!(both.weighted_cover().is_some(), cover.is_some());
        let difference = both.weighted_cover().unwrap_or(0.0) - cover.unwrap_or(0.0);
        prop_assert!(difference.abs() < 1e-12);
        let matches = both.matches(at).unwrap();
        prop_assert_eq!(matches.matched, matched);
        prop_assert_eq!((matches.true_planes, matches.found_planes), (planes(&truth).len(), planes(&found).len()));
        for (t, of_t) in planes(&truth) {
            for (p, of_p) in planes(&found) {
                prop_assert_eq!(both.iou(t, p), Some(iou(&of_p, &of_t)));
            }
        }
    }

    #[test]
    fn measures_are_shares((truth, found) in labelings()) {
        let both = Contingency::new(&truth, &found).unwrap();
        let matches = both.matches(0.5).unwrap();
        for share in [both.weighted_cover(), matches.precision(), matches.recall(), matches.f1()] {
            prop_assert!(share.is_none_or(|share| (0.0..=1.0).contains(&share)));
        }
        if let (Some(p), Some(r), Some(f1)) = (matches.precision(), matches.recall(), matches.f1()) {
            let harmonic = if matches.matched == 0 { 0.0 } else { 2.0 * p * r / (p + r) };
            prop_assert!((f1 - harmonic).abs() < 1e-12);
        }
    }

    #[test]
    fn numbers_of_planes_are_names((truth, found) in labelings(), turn in 1_u32..1000) {
        let renamed: Labels =
            found.iter().map(|p| p.and_then(|p| PlaneId::new(turn + 7 * (9 - p.get())))).collect();
        let (a, b) = (Contingency::new(&truth, &found).unwrap(), Contingency::new(&truth, &renamed).unwrap());
        prop_assert_eq!(a.weighted_cover(), b.weighted_cover());
        prop_assert_eq!(a.matches(0.5), b.matches(0.5));
    }

    #[test]
    fn order_and_grouping_do_not_matter((truth, found) in labelings()) {
        let one_by_one = Contingency::new(&truth, &found).unwrap();
        let mut pairs: Vec<_> = truth.into_iter().zip(found).collect();
        pairs.sort_unstable();
        let twice = Contingency::of_counts(pairs.iter().chain(&pairs).map(|(t, p)| (*t, *p, 1)));
        let at_once = Contingency::of_counts(pairs.iter().map(|(t, p)| (*t, *p, 2)));
        prop_assert_eq!(&twice, &at_once);
        prop_assert_eq!(one_by_one.weighted_cover(), at_once.weighted_cover());
    }

    #[test]
    fn identical_labelings_agree_in_full((truth, _) in labelings()) {
        let both = Contingency::new(&truth, &truth).unwrap();
        let some = truth.iter().any(Option::is_some);
        prop_assert_eq!(both.weighted_cover(), some.then_some(1.0));
        prop_assert_eq!(both.matches(0.99).unwrap().f1(), some.then_some(1.0));
    }
}

fn labels(numbers: &[u32]) -> Labels {
    numbers.iter().map(|n| PlaneId::new(*n)).collect()
}

#[test]
fn lengths_that_differ_are_an_error_with_both() {
    let error = Contingency::new(&labels(&[1, 2, 0]), &labels(&[1])).unwrap_err();
    assert_eq!(error, EvalError::Length { truth: 3, found: 1 });
    assert_eq!(error.to_string(), "3 true labels and 1 found ones are not of the same points");
}

#[test]
fn thresholds_without_one_to_one_matches_are_an_error() {
    let both = Contingency::new(&[], &[]).unwrap();
    for at_iou in [0.49, 1.0, -1.0, f64::INFINITY] {
        assert_eq!(both.matches(at_iou), Err(EvalError::Threshold { at_iou }));
    }
    assert!(both.matches(f64::NAN).is_err());
}

#[test]
fn without_planes_there_is_nothing_to_measure() {
    let nothing = Contingency::new(&[], &[]).unwrap();
    let matches = nothing.matches(0.5).unwrap();
    assert_eq!((nothing.weighted_cover(), matches.precision(), matches.recall()), (None, None, None));
    assert_eq!(matches.f1(), None);

    let only_found = Contingency::new(&labels(&[0, 0]), &labels(&[1, 1])).unwrap();
    let matches = only_found.matches(0.5).unwrap();
    assert_eq!((only_found.weighted_cover(), matches.precision(), matches.f1()), (None, Some(0.0), None));

    let only_true = Contingency::new(&labels(&[1, 1]), &labels(&[0, 0])).unwrap();
    let matches = only_true.matches(0.5).unwrap();
    assert_eq!((only_true.weighted_cover(), matches.precision(), matches.f1()), (Some(0.0), None, Some(0.0)));
}

#[test]
fn an_iou_at_the_threshold_is_no_match() {
    let both = Contingency::new(&labels(&[1, 1, 1, 1, 2]), &labels(&[1, 1, 0, 0, 2])).unwrap();
    assert_eq!(both.matches(0.5).unwrap().matched, 1);
}
