//! Random parameters, random places.

// Results are exact here; a test has no caller to report to.
#![allow(clippy::float_cmp, clippy::unwrap_used)]

use proptest::collection::vec;
use proptest::prelude::*;
use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;
use terrace_crs::{ControlledRandomSearch, Cost, Step};
use terrace_staircases::{
    Ackley, DeJong, Item, Kind, Knapsack, Needle, RandomStaircase, Rastrigin, Staircase, TestCost,
};

fn kinds() -> impl Strategy<Value = Kind> {
    prop_oneof![Just(Kind::White), Just(Kind::Walk), Just(Kind::Trend)]
}

/// Borders of uneven widths anywhere, and values of which some are equal.
fn staircases() -> impl Strategy<Value = Staircase> {
    (-1e3..1e3, vec((1e-6..10.0, -20..20_i32), 1..60)).prop_map(|(start, steps)| {
        let mut borders: Vec<f64> = vec![start];
        borders.extend(steps.iter().scan(start, |at, (width, _)| {
            *at += width;
            Some(*at)
        }));
        Staircase::new(borders, steps.iter().map(|(_, value)| f64::from(*value)).collect()).unwrap()
    })
}

/// Cells along each axis, and the one of the optimum on each.
fn optima() -> impl Strategy<Value = (usize, Vec<usize>)> {
    (1..80_usize).prop_flat_map(|cells| (Just(cells), vec(0..cells, 1..4)))
}

fn items() -> impl Strategy<Value = Vec<Item>> {
    vec((0..30_u32, 1..20_u32, 0..4_u32), 1..5).prop_map(|items| {
        items.into_iter().map(|(value, weight, most)| Item { value, weight, most }).collect()
    })
}

/// Of any type; kept as parameters, so that a failing case shows them.
#[derive(Debug, Clone)]
enum Parameters {
    DeJong(usize),
    Rastrigin(usize, Vec<usize>),
    Ackley(usize, Vec<usize>),
    Needle(usize, f64, f64, f64, usize),
    Random(u64, usize, Kind),
    Knapsack(Vec<Item>, u32),
    Staircase(Staircase),
}

impl Parameters {
    fn cost(&self) -> Box<dyn TestCost> {
        match self.clone() {
            Self::DeJong(d) => Box::new(DeJong::new(d).unwrap()),
            Self::Rastrigin(n, best) => Box::new(Rastrigin::with_optimum(n, &best).unwrap()),
            Self::Ackley(n, best) => Box::new(Ackley::with_optimum(n, &best).unwrap()),
            Self::Needle(d, at, width, slope, n) => Box::new(Needle::sloped(d, at, width, slope, n).unwrap()),
            Self::Random(seed, n, kind) => Box::new(RandomStaircase::from_seed(seed, n, kind).unwrap()),
            Self::Knapsack(items, capacity) => Box::new(Knapsack::new(&items, capacity).unwrap()),
            Self::Staircase(staircase) => Box::new(staircase),
        }
    }
}

fn parameters() -> impl Strategy<Value = Parameters> {
    prop_oneof![
        (1..4_usize).prop_map(Parameters::DeJong),
        optima().prop_map(|(n, best)| Parameters::Rastrigin(n, best)),
        optima().prop_map(|(n, best)| Parameters::Ackley(n, best)),
        (1..4_usize, 0.0..0.9, 0.001..0.1, 0.0..5.0, 1..30_usize)
            .prop_map(|(d, at, width, slope, n)| Parameters::Needle(d, at, width, slope, n)),
        (any::<u64>(), 1..200_usize, kinds()).prop_map(|(seed, n, kind)| Parameters::Random(seed, n, kind)),
        (items(), 0..60_u32).prop_map(|(items, capacity)| Parameters::Knapsack(items, capacity)),
        staircases().prop_map(Parameters::Staircase),
    ]
}

/// A place in the bounds, `shares` of the way along each axis.
fn place(cost: &dyn TestCost, shares: &[f64]) -> Vec<f64> {
    let bounds = cost.bounds();
    bounds
        .axes()
        .iter()
        .zip(shares.iter().cycle())
        .map(|(axis, u)| (axis.lo() + u * (axis.hi() - axis.lo())).min(axis.hi()))
        .collect()
}

proptest! {
    #[test]
    fn no_place_is_below_the_minimum(of in parameters(), shares in vec(0.0..=1.0, 3)) {
        let mut cost = of.cost();
        let x = place(&*cost, &shares);
        prop_assert!(cost.evaluate(&x).value >= cost.minimum());
    }

    #[test]
    fn the_value_and_the_step_are_the_same_all_over_a_step(
        of in parameters(),
        shares in vec(0.0..=1.0, 3),
        within in vec(0.0..1.0, 3),
    ) {
        let mut cost = of.cost();
        let x = place(&*cost, &shares);
        let answer = cost.evaluate(&x);
        prop_assert!(answer.step.contains(&x, &x));
        let Step::Box { lo, hi } = &answer.step else { panic!("no box") };
        let other: Vec<f64> = lo.iter().zip(hi).zip(within.iter().cycle()).zip(cost.bounds().axes()).map(|(((lo, hi), u), axis)| {
            let (lo, hi) = (lo.max(axis.lo()), hi.min(axis.hi()));
            (lo + u * (hi - lo)).clamp(lo, hi.next_down().max(lo))
        }).collect();
        prop_assert_eq!(cost.evaluate(&other), answer);
    }

    #[test]
    fn a_staircase_is_what_its_lists_say(mut cost in staircases(), share in 0.0..=1.0_f64) {
        let x = place(&cost, &[share])[0];
        let step = (0..cost.values().len()).rfind(|&i| cost.borders()[i] <= x).unwrap();
        prop_assert_eq!(cost.evaluate(&[x]).value, cost.values()[step]);
        let lowest = cost.values().iter().copied().fold(f64::INFINITY, f64::min);
        prop_assert_eq!(cost.minimum(), lowest);
        // Of equal lowest steps the first.
        prop_assert_eq!(cost.minimiser()[0], cost.borders()[cost.values().iter().position(|&v| v == lowest).unwrap()]);
    }

    #[test]
    fn the_packing_is_the_best_of_all_that_fit(items in items(), capacity in 0..60_u32) {
        let mut cost = Knapsack::new(&items, capacity).unwrap();
        let packings = items.iter().fold(vec![vec![]], |all: Vec<Vec<u32>>, item| {
            all.iter().flat_map(|p| (0..=item.most).map(move |k| [&p[..], &[k]].concat())).collect()
        });
        let total = |p: &[u32], of: fn(&Item) -> u32| p.iter().zip(&items).map(|(k, item)| k * of(item)).sum::<u32>();
        let fitting = packings.iter().filter(|p| total(p, |item| item.weight) <= capacity);
        let best = fitting.map(|p| total(p, |item| item.value)).max().unwrap();
        prop_assert_eq!(cost.minimum(), -f64::from(best));
        prop_assert!(total(cost.best(), |item| item.weight) <= capacity);
        for p in &packings {
            let x: Vec<f64> = p.iter().map(|&k| f64::from(k) + 0.5).collect();
            let value = cost.evaluate(&x).value;
            let heavy = total(p, |item| item.weight) > capacity;
            let right = if heavy { value > cost.minimum() } else { value == -f64::from(total(p, |item| item.value)) };
            prop_assert!(right, "{:?} costs {}", p, value);
        }
    }

    #[test]
    fn a_search_meets_no_contradiction_and_is_the_same_without_steps(cost in staircases(), seed in any::<u64>()) {
        let search = ControlledRandomSearch::default();
        let (bounds, rng) = (cost.bounds(), || ChaCha8Rng::seed_from_u64(seed));
        let with = search.minimise(&mut cost.clone(), &bounds, &mut rng()).unwrap();
        let without = search.minimise(&mut cost.clone().without_steps(), &bounds, &mut rng()).unwrap();
        prop_assert!(with.evaluations as u128 <= cost.step_count());
        // Known steps end a search earlier, when all members stand on one; up to there it is the same.
        prop_assert!(with.trace.len() <= without.trace.len() && with.value >= without.value);
        for (a, b) in with.trace.iter().zip(&without.trace) {
            prop_assert_eq!((&a.x, a.value), (&b.x, b.value));
        }
    }
}
