//! What the functions say of themselves, against every step of them.

// Results are exact here; a test has no caller to report to.
#![allow(clippy::float_cmp, clippy::panic, clippy::unwrap_used)]

use std::f64::consts::{E, TAU};

use terrace_crs::Step;
use terrace_staircases::{
    Ackley, DeJong, Item, Kind, Knapsack, Needle, RandomStaircase, Rastrigin, Staircase, TestCost,
};

/// Small instances of everything, with one, two and three axes.
fn small() -> Vec<Box<dyn TestCost>> {
    let mut costs: Vec<Box<dyn TestCost>> = Vec::new();
    for dimension in 1..=3 {
        costs.push(Box::new(DeJong::new(dimension).unwrap()));
        costs.push(Box::new(Rastrigin::new(dimension, 23).unwrap()));
        costs.push(Box::new(Ackley::new(dimension, 17).unwrap()));
        costs.push(Box::new(Needle::flat(dimension, 0.7, 0.01).unwrap()));
        costs.push(Box::new(Needle::sloped(dimension, 0.65, 0.1, 2.0, 9).unwrap()));
        costs.push(Box::new(Knapsack::from_seed(dimension as u64, dimension, 6).unwrap()));
    }
    for kind in [Kind::White, Kind::Walk, Kind::Trend] {
        costs.push(Box::new(RandomStaircase::from_seed(11, 300, kind).unwrap()));
    }
    costs.push(Box::new(Staircase::new(vec![-3.0, -1.0, 0.0, 9.5], vec![4.0, 2.0, 2.0]).unwrap()));
    costs
}

/// The box a cost answers with.
fn corners(cost: &mut dyn TestCost, x: &[f64]) -> (f64, Vec<f64>, Vec<f64>) {
    let answer = cost.evaluate(x);
    match answer.step {
        Step::Box { lo, hi } => (answer.value, lo, hi),
        Step::Point => panic!("{}: no step at {x:?}", cost.name()),
    }
}

/// The bounds of one axis.
fn ends(cost: &dyn TestCost, axis: usize) -> (f64, f64) {
    let bounds = cost.bounds();
    (bounds.axes()[axis].lo(), bounds.axes()[axis].hi())
}

/// The starts of all steps on one axis, found by walking from each step to the next with the other coordinates fixed.
fn walk(cost: &mut dyn TestCost, axis: usize, from: &[f64]) -> Vec<f64> {
    let (lo, hi) = ends(cost, axis);
    let mut x = from.to_vec();
    let mut starts = vec![lo];
    loop {
        x[axis] = *starts.last().unwrap();
        let next = corners(cost, &x).2[axis];
        assert!(next > x[axis]);
        if next > hi {
            return starts;
        }
        starts.push(next);
    }
}

/// The start of every step in all axes: the product of those on each.
fn all_steps(cost: &mut dyn TestCost) -> Vec<Vec<f64>> {
    let from = cost.minimiser();
    let axes: Vec<Vec<f64>> = (0..from.len()).map(|axis| walk(cost, axis, &from)).collect();
    axes.iter().fold(vec![vec![]], |places, starts| {
        let longer = |place: &Vec<f64>| {
            let place = place.clone();
            starts.iter().map(move |&start| [&place[..], &[start]].concat())
        };
        places.iter().flat_map(longer).collect()
    })
}

#[test]
fn the_minimum_is_the_lowest_of_all_steps_and_their_number_is_right() {
    for mut cost in small() {
        let steps = all_steps(&mut *cost);
        assert_eq!(steps.len() as u128, cost.step_count(), "{}", cost.name());
        let values = steps.iter().map(|x| cost.evaluate(x).value);
        let lowest = values.fold(f64::INFINITY, f64::min);
        assert_eq!(lowest, cost.minimum(), "{} of {:?}", cost.name(), cost.dimension());
    }
}

#[test]
fn the_minimiser_is_inside_and_has_the_minimum() {
    for mut cost in small() {
        let x = cost.minimiser();
        assert!(cost.bounds().contains(&x), "{}: {x:?}", cost.name());
        assert_eq!(cost.evaluate(&x).value, cost.minimum(), "{}", cost.name());
        assert_eq!(cost.dimension(), Some(x.len()));
    }
}

#[test]
fn steps_hold_their_lower_corner_and_end_before_the_upper_one() {
    for mut cost in small() {
        for x in all_steps(&mut *cost) {
            let (value, lo, hi) = corners(&mut *cost, &x);
            for axis in 0..x.len() {
                // The same step at its start, at its last number and in the middle.
                let (first, last) = ends(&*cost, axis);
                let (start, end) = (lo[axis].max(first), hi[axis].min(last));
                for place in [start, f64::midpoint(start, end), hi[axis].next_down().min(f64::MAX)] {
                    let mut other = x.clone();
                    other[axis] = place;
                    let same = (value, lo.clone(), hi.clone());
                    assert_eq!(corners(&mut *cost, &other), same, "{} at {other:?}", cost.name());
                }
                // Others just outside, which begin or end where this one does.
                if hi[axis].is_finite() {
                    let mut above = x.clone();
                    above[axis] = hi[axis];
                    assert_eq!(corners(&mut *cost, &above).1[axis], hi[axis], "{}", cost.name());
                }
                if lo[axis].is_finite() {
                    let mut below = x.clone();
                    below[axis] = lo[axis].next_down();
                    assert_eq!(corners(&mut *cost, &below).2[axis], lo[axis], "{}", cost.name());
                }
            }
        }
    }
}

#[test]
fn nan_and_other_numbers_of_axes_have_the_value_nan() {
    for mut cost in small() {
        let x = vec![f64::NAN; cost.minimiser().len()];
        assert!(cost.evaluate(&x).value.is_nan() && cost.evaluate(&[]).value.is_nan(), "{}", cost.name());
    }
}

/// The formulas once more, in their plainest form, on a lattice of places in two axes.
#[test]
fn rastrigin_and_ackley_follow_their_formulas_on_cell_centres() {
    let cells = 40;
    let golden = (5_f64.sqrt() - 1.0) / 2.0;
    for (half, ackley) in [(5.12, false), (32.768, true)] {
        let mut cost: Box<dyn TestCost> = if ackley {
            Box::new(Ackley::new(2, cells).unwrap())
        } else {
            Box::new(Rastrigin::new(2, cells).unwrap())
        };
        let width = 2.0 * half / cells as f64;
        let centre = |k: f64| -half + (k + 0.5) * width;
        let shift = |i: f64| centre((cells as f64 * (i * golden).fract()).floor());
        for i in 0..100 {
            // Places inside cells, since the borders are rounded otherwise here.
            let share = (f64::from(i) * golden).fract();
            let x = [centre(f64::from(i % 40)) + 0.4 * width, centre((40.0 * share).floor()) - 0.4 * width];
            let t: Vec<f64> = x
                .iter()
                .zip([1.0, 2.0])
                .map(|(x, i)| centre(((x + half) / width).floor()) - shift(i))
                .collect();
            let squares: f64 = t.iter().map(|t| t * t).sum();
            let cosines: f64 = t.iter().map(|t| (TAU * t).cos()).sum();
            let formula = if ackley {
                20.0 + E - 20.0 * (-0.2 * (squares / 2.0).sqrt()).exp() - (cosines / 2.0).exp()
            } else {
                squares + 20.0 - 10.0 * cosines
            };
            let value = cost.evaluate(&x).value;
            assert!((value - formula).abs() < 1e-10, "{x:?}: {value} is not {formula}");
        }
    }
}

#[test]
fn a_known_knapsack_has_its_known_optimum() {
    // Ten items, of which the first four and the sixth fill the capacity exactly.
    let weights = [23, 31, 29, 44, 53, 38, 63, 85, 89, 82];
    let values = [92, 57, 49, 68, 60, 43, 67, 84, 87, 72];
    let items: Vec<Item> =
        weights.iter().zip(values).map(|(&weight, value)| Item { value, weight, most: 1 }).collect();
    let cost = Knapsack::new(&items, 165).unwrap();
    assert_eq!(cost.minimum(), -309.0);
    assert_eq!(cost.best(), [1, 1, 1, 1, 0, 1, 0, 0, 0, 0]);
    assert_eq!(cost.step_count(), 1024);
}
