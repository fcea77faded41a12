//! The one place where evaluations are counted, the same for all methods.

use terrace_crs::{Bounds, Evaluation};
use terrace_staircases::TestCost;

/// A cost that counts, keeps the lowest value so far, and answers no more once a run is over: when the value is low
/// enough, or when as many evaluations are done as are allowed.
pub struct Recorder {
    cost: Box<dyn TestCost>,
    bounds: Bounds,
    threshold: f64,
    cap: usize,
    evaluations: usize,
    asked_outside: bool,
    /// Each evaluation that lowered the value, and the value.
    lowered: Vec<(usize, f64)>,
}

impl Recorder {
    /// Success is a value of at most `threshold`; at most `cap` evaluations.
    pub fn new(cost: Box<dyn TestCost>, threshold: f64, cap: usize) -> Self {
        let bounds = cost.bounds();
        Self { cost, bounds, threshold, cap, evaluations: 0, asked_outside: false, lowered: Vec::new() }
    }

    /// Where the method may look.
    pub fn bounds(&self) -> &Bounds {
        &self.bounds
    }

    /// The lower and the upper corner of the bounds.
    pub fn corners(&self) -> (Vec<f64>, Vec<f64>) {
        self.bounds.axes().iter().map(|axis| (axis.lo(), axis.hi())).unzip()
    }

    /// What counts as success.
    pub fn threshold(&self) -> f64 {
        self.threshold
    }

    /// The evaluations done so far.
    pub fn evaluations(&self) -> usize {
        self.evaluations
    }

    /// The evaluations that may still be done.
    pub fn left(&self) -> usize {
        self.cap - self.evaluations
    }

    /// Whether a place outside the bounds was evaluated, which would make the comparison unfair.
    pub fn asked_outside(&self) -> bool {
        self.asked_outside
    }

    /// Whether nothing more is answered.
    pub fn over(&self) -> bool {
        self.left() == 0 || self.success().is_some()
    }

    /// The number of the first evaluation with a value low enough.
    pub fn success(&self) -> Option<usize> {
        self.lowered.last().filter(|(_, value)| *value <= self.threshold).map(|(number, _)| *number)
    }

    /// The answer of the cost at `x`, counted; `None` once the run is over.
    pub fn ask(&mut self, x: &[f64]) -> Option<Evaluation> {
        if self.over() {
            return None;
        }
        self.asked_outside |= !self.bounds.contains(x);
        let evaluation = self.cost.evaluate(x);
        self.evaluations += 1;
        if self.lowered.last().is_none_or(|(_, lowest)| evaluation.value < *lowest) {
            self.lowered.push((self.evaluations, evaluation.value));
        }
        Some(evaluation)
    }

    /// The value at `x`, for methods that know no steps and cannot be told to end: past the end the largest number.
    pub fn value(&mut self, x: &[f64]) -> f64 {
        self.ask(x).map_or(f64::MAX, |evaluation| evaluation.value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use terrace_staircases::Staircase;

    fn recorder(cap: usize) -> Recorder {
        let cost = Staircase::new(vec![0.0, 1.0, 2.0, 3.0], vec![5.0, 3.0, 1.0]).unwrap();
        Recorder::new(Box::new(cost), 1.0, cap)
    }

    #[test]
    fn success_is_the_first_low_enough_evaluation_and_ends_the_run() {
        let mut recorder = recorder(10);
        assert_eq!((recorder.value(&[0.5]), recorder.value(&[0.5]), recorder.value(&[1.5])), (5.0, 5.0, 3.0));
        assert_eq!((recorder.success(), recorder.over()), (None, false));
        assert_eq!(recorder.value(&[2.5]), 1.0);
        assert_eq!((recorder.success(), recorder.over(), recorder.evaluations()), (Some(4), true, 4));
        assert_eq!((recorder.ask(&[0.5]), recorder.evaluations()), (None, 4));
    }

    #[test]
    fn places_outside_are_noticed() {
        let mut recorder = recorder(9);
        recorder.value(&[0.0]);
        recorder.value(&[1.0]);
        assert!(!recorder.asked_outside());
        recorder.value(&[3.1]);
        assert!(recorder.asked_outside());
    }

    #[test]
    fn the_cap_ends_the_run_without_success() {
        let mut recorder = recorder(2);
        recorder.value(&[0.5]);
        assert_eq!(recorder.left(), 1);
        recorder.value(&[0.5]);
        assert_eq!((recorder.value(&[2.5]), recorder.success(), recorder.over()), (f64::MAX, None, true));
    }
}
