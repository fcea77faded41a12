//! One evaluation of each test function, and the dynamic programming of a knapsack.

// A bench has no caller to report to.
#![allow(clippy::unwrap_used)]

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use terrace_staircases::{Ackley, DeJong, Kind, Knapsack, Needle, RandomStaircase, Rastrigin, TestCost};

fn evaluate(c: &mut Criterion) {
    let costs: Vec<Box<dyn TestCost>> = vec![
        Box::new(DeJong::new(5).unwrap()),
        Box::new(Rastrigin::new(5, 64).unwrap()),
        Box::new(Ackley::new(5, 256).unwrap()),
        Box::new(Needle::sloped(5, 0.7, 0.02, 1.0, 20).unwrap()),
        Box::new(RandomStaircase::from_seed(1, 1000, Kind::Walk).unwrap()),
        Box::new(Knapsack::from_seed(1, 5, 9).unwrap()),
    ];
    for mut cost in costs {
        let x: Vec<f64> =
            cost.bounds().axes().iter().map(|axis| axis.lo() + 0.3 * (axis.hi() - axis.lo())).collect();
        let name = format!("evaluate/{}, {} axes", cost.name(), x.len());
        c.bench_function(&name, |b| b.iter(|| cost.evaluate(black_box(&x))));
    }
}

fn knapsack(c: &mut Criterion) {
    c.bench_function("knapsack/20 items, 5 pieces each", |b| {
        b.iter(|| Knapsack::from_seed(black_box(1), 20, 5).unwrap().minimum());
    });
}

criterion_group!(benches, evaluate, knapsack);
criterion_main!(benches);
