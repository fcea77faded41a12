//! The exact methods on ten thousand random staircases, against a dense scan.

// The values are compared as the staircase gives them; a test has no caller to report to.
#![allow(clippy::float_cmp, clippy::unwrap_used)]

use terrace_crs::{Answer, CertifiedSearch, Cost, Evaluation, StopReason, Sweep};
use terrace_staircases::{Kind, RandomStaircase, TestCost};

const STAIRCASES: u64 = 10_000;

/// Places of the scan for each step.
const DENSE: usize = 4;

/// Gives up whenever it may, with a bound half way between the ceiling and its value.
struct GivesUp(RandomStaircase);

impl Cost for GivesUp {
    fn evaluate(&mut self, x: &[f64]) -> Evaluation {
        self.0.evaluate(x)
    }

    fn evaluate_below(&mut self, x: &[f64], ceiling: f64) -> Answer {
        let exact = self.0.evaluate(x);
        if exact.value < ceiling {
            return Answer::Exact(exact);
        }
        Answer::AtLeast(Evaluation { value: f64::midpoint(exact.value, ceiling), step: exact.step })
    }
}

#[test]
fn certified_search_and_sweep_prove_the_minimum_of_ten_thousand_random_staircases() {
    let mut evaluations = 0;
    for seed in 0..STAIRCASES {
        let kind = [Kind::White, Kind::Walk, Kind::Trend][(seed % 3) as usize];
        let steps = 1 + (seed * 7919 % 97) as usize;
        let cost = RandomStaircase::from_seed(seed, steps, kind).unwrap();
        let bounds = cost.bounds();
        let (lo, hi) = (bounds.axes()[0].lo(), bounds.axes()[0].hi());
        let places = DENSE * steps;
        let scanned = (0..=places)
            .map(|i| cost.clone().evaluate(&[(lo + (hi - lo) * i as f64 / places as f64).min(hi)]).value)
            .fold(f64::INFINITY, f64::min);

        let search = CertifiedSearch::default();
        let found = [
            search.minimise(&mut cost.clone(), &bounds).unwrap(),
            search.minimise(&mut GivesUp(cost.clone()), &bounds).unwrap(),
            Sweep::default().minimise(&mut GivesUp(cost.clone()), &bounds).unwrap(),
        ];
        for minimum in found {
            assert_eq!(minimum.stop, StopReason::Certified, "seed {seed}");
            assert!(minimum.is_proven(), "seed {seed}");
            assert_eq!(minimum.value, cost.minimum(), "seed {seed}");
            assert!(minimum.value <= scanned, "seed {seed}: {scanned} was scanned");
            assert_eq!(cost.clone().evaluate(&minimum.x).value, minimum.value, "seed {seed}");
            assert!(minimum.evaluations <= steps, "seed {seed}: {} of {steps}", minimum.evaluations);
            evaluations += minimum.evaluations;
        }
    }
    println!("{STAIRCASES} random staircases: all proven, {evaluations} evaluations");
}
