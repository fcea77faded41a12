//! Random staircases whose answer is known by brute force.

// Each test program uses a part of it.
#![allow(dead_code)]

use proptest::prelude::*;
use terrace_crs::{Answer, Axis, Bounds, Cost, Evaluation, Step};

/// What a staircase tells of its steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tells {
    All,
    /// Less than the step: at most this far from x.
    Near(f64),
    Nothing,
    /// All of it in the lower half of the first axis, nothing above.
    Half,
}

/// A cost that is constant on every cell between cuts.
#[derive(Debug, Clone)]
pub struct Staircase {
    pub domain: Vec<Axis>,
    pub cuts: Vec<Vec<f64>>,
    pub values: Vec<f64>,
    pub tells: Tells,
}

impl Staircase {
    /// The cell around x: its number and its box.
    pub fn cell(&self, x: &[f64]) -> (usize, Vec<f64>, Vec<f64>) {
        let (mut cell, mut lo, mut hi) = (0, Vec::new(), Vec::new());
        for (cuts, &x) in self.cuts.iter().zip(x) {
            let below = cuts.iter().filter(|&&cut| cut <= x).count();
            cell = cell * (cuts.len() + 1) + below;
            lo.push(if below == 0 { f64::NEG_INFINITY } else { cuts[below - 1] });
            hi.push(cuts.get(below).copied().unwrap_or(f64::INFINITY));
        }
        (cell, lo, hi)
    }

    pub fn value(&self, x: &[f64]) -> f64 {
        self.values[self.cell(x).0]
    }

    pub fn cells(&self) -> usize {
        self.cuts.iter().map(|cuts| cuts.len() + 1).product()
    }

    /// A place on every cell that the domain meets; all places where the axes can be counted.
    pub fn places(&self) -> Vec<Vec<f64>> {
        let along = |(axis, cuts): (&Axis, &Vec<f64>)| -> Vec<f64> {
            match axis {
                Axis::Integer { lo, hi } => (*lo..=*hi).map(|i| i as f64).collect(),
                Axis::List(values) => values.clone(),
                real => cuts.iter().copied().chain([real.lo()]).filter(|x| real.contains(*x)).collect(),
            }
        };
        self.domain.iter().zip(&self.cuts).map(along).fold(vec![vec![]], |places, values| {
            let with = |place: &Vec<f64>| -> Vec<Vec<f64>> {
                values.iter().map(|value| place.iter().copied().chain([*value]).collect()).collect()
            };
            places.iter().flat_map(with).collect()
        })
    }

    pub fn lowest(&self) -> f64 {
        self.places().iter().map(|x| self.value(x)).fold(f64::INFINITY, f64::min)
    }

    pub fn bounds(&self) -> Bounds {
        Bounds::of(self.domain.clone()).unwrap()
    }

    pub fn answer(&self, x: &[f64]) -> Evaluation {
        let (cell, mut lo, mut hi) = self.cell(x);
        if let Tells::Near(reach) = self.tells {
            for (axis, &x) in x.iter().enumerate() {
                lo[axis] = lo[axis].max(x - reach);
                hi[axis] = hi[axis].min(x + reach);
            }
        }
        let nothing = self.tells == Tells::Nothing || self.tells == Tells::Half && x[0] > 0.5;
        let step = if nothing { Step::Point } else { Step::Box { lo, hi } };
        Evaluation { value: self.values[cell], step }
    }
}

/// What was answered at a place.
#[derive(Debug, Clone)]
pub struct Answered {
    pub x: Vec<f64>,
    pub step: Step,
    /// The value, or a lower bound of it.
    pub number: f64,
    pub bound: bool,
}

/// Fails when it is asked where it has answered already, and may give up early.
pub struct AskedOnce<'a> {
    pub staircase: &'a Staircase,
    pub early: bool,
    pub answers: Vec<Answered>,
}

impl<'a> AskedOnce<'a> {
    pub fn new(staircase: &'a Staircase, early: bool) -> Self {
        Self { staircase, early, answers: Vec::new() }
    }

    fn note(&mut self, x: &[f64], answer: &Evaluation, bound: bool) {
        for Answered { x: origin, step, .. } in &self.answers {
            assert!(!step.contains(origin, x), "asked at {x:?}, known on {step} since {origin:?}");
        }
        assert!(self.staircase.bounds().contains(x), "asked outside the bounds at {x:?}");
        self.answers.push(Answered { x: x.to_vec(), step: answer.step.clone(), number: answer.value, bound });
    }
}

impl Cost for AskedOnce<'_> {
    fn evaluate(&mut self, x: &[f64]) -> Evaluation {
        let answer = self.staircase.answer(x);
        self.note(x, &answer, false);
        answer
    }

    fn evaluate_below(&mut self, x: &[f64], ceiling: f64) -> Answer {
        let Evaluation { value, step } = self.staircase.answer(x);
        if !self.early || value < ceiling {
            return Answer::Exact(self.evaluate(x));
        }
        // Known to be too high before it is known how high.
        let bound = Evaluation { value: f64::midpoint(value, ceiling), step };
        self.note(x, &bound, true);
        Answer::AtLeast(bound)
    }
}

fn tells() -> impl Strategy<Value = Tells> {
    prop_oneof![
        Just(Tells::All),
        (0.001..0.3_f64).prop_map(Tells::Near),
        Just(Tells::Nothing),
        Just(Tells::Half)
    ]
}

/// Few different values make ties; many make a rugged staircase.
fn values(count: usize) -> impl Strategy<Value = Vec<f64>> {
    prop_oneof![
        prop::collection::vec((0..4).prop_map(f64::from), count),
        prop::collection::vec(-1e3..1e3_f64, count)
    ]
}

fn ascending(
    values: impl Strategy<Value = f64>,
    count: std::ops::Range<usize>,
) -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(values, count).prop_map(|mut values| {
        values.sort_by(f64::total_cmp);
        values.dedup();
        values
    })
}

/// Of one to three axes [0, 1].
pub fn staircase() -> impl Strategy<Value = Staircase> {
    // Cuts on a coarse raster coincide with start points and with each other's sums.
    let axis =
        |most| ascending(prop_oneof![1e-9..1.0_f64, (1..16).prop_map(|i| f64::from(i) / 16.0)], 0..most);
    let cuts = prop_oneof![
        prop::collection::vec(axis(40), 1),
        prop::collection::vec(axis(8), 2),
        prop::collection::vec(axis(4), 3)
    ];
    (cuts, values(81), tells()).prop_map(|(cuts, values, tells)| {
        let domain = vec![Axis::Real { lo: 0.0, hi: 1.0 }; cuts.len()];
        Staircase { domain, cuts, values, tells }
    })
}

/// Of one to three axes of any kind, some of them held fixed.
pub fn mixed() -> impl Strategy<Value = Staircase> {
    let raster = |most| prop_oneof![-1.0..6.0_f64, (0..most).prop_map(|i| f64::from(i) / 2.0)];
    let axis = prop_oneof![
        Just(Axis::Real { lo: 0.0, hi: 5.0 }),
        (0.0..5.0_f64).prop_map(|at| Axis::Real { lo: at, hi: at }),
        (-1..3_i64, 0..5_i64).prop_map(|(lo, more)| Axis::Integer { lo, hi: lo + more }),
        ascending(raster(10), 1..6).prop_map(Axis::List)
    ];
    let axes = prop::collection::vec((axis, ascending(raster(10), 0..4)), 1..4);
    (axes, values(64), tells()).prop_map(|(axes, values, tells)| {
        let (domain, cuts) = axes.into_iter().unzip();
        Staircase { domain, cuts, values, tells }
    })
}

/// Places of interest: the borders of a step and their neighbours, kept finite.
pub fn around(step: &Step, x: &[f64]) -> Vec<Vec<f64>> {
    let Step::Box { lo, hi } = step else { return vec![x.to_vec()] };
    let ends = |axis: usize| {
        let (lo, hi) = (lo[axis].max(-9.0), hi[axis].min(9.0));
        [lo, lo.next_down(), hi, hi.next_down(), x[axis]]
    };
    (0..x.len())
        .flat_map(|axis| {
            ends(axis).map(|end| {
                let mut place = x.to_vec();
                place[axis] = end;
                place
            })
        })
        .collect()
}
