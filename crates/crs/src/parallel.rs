//! A cost whose evaluations run on several threads.

use std::num::NonZeroUsize;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use crate::{Cost, Evaluation};

/// A cost of any number of axes from a function that may be called from several threads at once; places that are asked
/// for together ([`Cost::evaluate_many`]) are evaluated on up to `threads` threads.
///
/// The answers come in the order of the questions, so that a search gives the same result on any number of threads. A
/// search asks for several places at once only when its `batch` is above one; [`Sweep`](crate::Sweep) and
/// [`PatternSearch`](crate::PatternSearch) have no `batch` and ask for one place after another.
///
/// Threads are started for each group, some tens of microseconds: worth it for evaluations of about a millisecond and
/// more. A panic of the function is passed on.
///
/// ```
/// use std::num::NonZeroUsize;
/// use terrace_crs::{Bounds, CertifiedSearch, Evaluation, in_parallel};
///
/// let stairs = |x: &[f64]| {
///     let lo = x[0].floor();
///     Evaluation::interval((lo - 5.0).abs(), lo..lo + 1.0)
/// };
/// let bounds = Bounds::interval(0.0, 20.0)?;
/// let search = CertifiedSearch { batch: NonZeroUsize::new(4), ..CertifiedSearch::default() };
/// let mut minima = [1, 4].into_iter().filter_map(NonZeroUsize::new).map(|threads| {
///     search.minimise(&mut in_parallel(stairs, threads), &bounds)
/// });
/// assert_eq!(minima.next(), minima.next());
/// # Ok::<(), terrace_crs::BoundsError>(())
/// ```
pub fn in_parallel<F: Fn(&[f64]) -> Evaluation + Sync>(function: F, threads: NonZeroUsize) -> impl Cost {
    Parallel { function, threads }
}

struct Parallel<F> {
    function: F,
    threads: NonZeroUsize,
}

impl<F: Fn(&[f64]) -> Evaluation + Sync> Cost for Parallel<F> {
    fn evaluate(&mut self, x: &[f64]) -> Evaluation {
        (self.function)(x)
    }

    fn evaluate_many(&mut self, xs: &[Vec<f64>]) -> Vec<Evaluation> {
        let threads = self.threads.get().min(xs.len());
        if threads <= 1 {
            return xs.iter().map(|x| (self.function)(x)).collect();
        }
        // Evaluations differ in length: each thread takes the next place that nobody has taken.
        let next = AtomicUsize::new(0);
        let work = || {
            let mut answers = Vec::new();
            loop {
                let at = next.fetch_add(1, Ordering::Relaxed);
                let Some(x) = xs.get(at) else { return answers };
                answers.push((at, (self.function)(x)));
            }
        };
        let mut answers: Vec<(usize, Evaluation)> = thread::scope(|scope| {
            let workers: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
            workers
                .into_iter()
                .flat_map(|worker| worker.join().unwrap_or_else(|panic| resume_unwind(panic)))
                .collect()
        });
        answers.sort_unstable_by_key(|(at, _)| *at);
        answers.into_iter().map(|(_, answer)| answer).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_come_in_the_order_of_the_questions() {
        let xs: Vec<Vec<f64>> = (0..100).map(|i| vec![f64::from(i)]).collect();
        for threads in [1, 2, 7, 200] {
            let mut cost =
                in_parallel(|x| Evaluation::point(x[0] * 2.0), NonZeroUsize::new(threads).unwrap());
            let answers = cost.evaluate_many(&xs);
            assert_eq!(answers.len(), xs.len());
            assert!(answers.iter().zip(&xs).all(|(answer, x)| answer.value == 2.0 * x[0]));
        }
    }

    #[test]
    fn no_place_gives_no_answer() {
        let mut cost = in_parallel(|_| Evaluation::point(0.0), NonZeroUsize::new(4).unwrap());
        assert!(cost.evaluate_many(&[]).is_empty());
    }

    #[test]
    #[should_panic(expected = "place 3")]
    fn a_panic_is_passed_on() {
        let stumbles = |x: &[f64]| {
            assert!(x[0] < 3.0, "place {}", x[0]);
            Evaluation::point(0.0)
        };
        in_parallel(stumbles, NonZeroUsize::new(2).unwrap()).evaluate_many(&[
            vec![1.0],
            vec![2.0],
            vec![3.0],
            vec![0.0],
        ]);
    }
}
