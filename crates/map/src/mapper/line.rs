//! Work in steps, by as many threads as come.

use std::sync::{Mutex, MutexGuard, PoisonError};

/// Turns of waiting before the processor is offered to others.
const TURNS: usize = 64;

/// Parts of something that go through steps, one after the other. Each step takes the parts in their order, one at a time, and there are
/// never more than `room` parts between the first step and the last.
///
/// Threads [work](Self::work) until nothing is left: each takes the step that it prefers of those that can be done. So the outcome does
/// not depend on how many there are, and one that comes late, or never, is only missed for its work.
pub(super) struct Line<const STEPS: usize> {
    parts: usize,
    room: usize,
    progress: Mutex<Progress<STEPS>>,
}

struct Progress<const STEPS: usize> {
    /// Parts that each step is done with.
    done: [usize; STEPS],
    busy: [bool; STEPS],
    stopped: bool,
}

enum Next {
    Step(usize, usize),
    Wait,
    Nothing,
}

impl<const STEPS: usize> Line<STEPS> {
    pub(super) fn new(parts: usize, room: usize) -> Self {
        let progress = Progress { done: [0; STEPS], busy: [false; STEPS], stopped: false };
        Self { parts, room, progress: Mutex::new(progress) }
    }

    /// Does steps, of which `step` tells the number and that of the part, until all are done or one tells to stop by `false`. Steps are taken in
    /// the order of `prefers`.
    ///
    /// A step must not wait for other work of the same threads: they may be in here.
    pub(super) fn work(&self, prefers: [usize; STEPS], mut step: impl FnMut(usize, usize) -> bool) {
        let mut turns = 0;
        loop {
            match self.next(prefers) {
                Next::Nothing => return,
                Next::Wait if turns < TURNS => {
                    turns += 1;
                    std::hint::spin_loop();
                }
                Next::Wait => std::thread::yield_now(),
                Next::Step(number, part) => {
                    turns = 0;
                    let mut working = Working { line: self, number, is_done: false };
                    working.is_done = step(number, part);
                }
            }
        }
    }

    fn next(&self, prefers: [usize; STEPS]) -> Next {
        let mut progress = lock(&self.progress);
        let Progress { done, busy, stopped } = &mut *progress;
        let all_done = done.iter().all(|done| *done == self.parts);
        if *stopped || all_done {
            return Next::Nothing;
        }
        for number in prefers {
            let part = done[number];
            let last = done[STEPS - 1];
            let comes = match number.checked_sub(1) {
                Some(before) => part < done[before],
                None => part < self.parts && part < last + self.room,
            };
            if comes && !busy[number] {
                busy[number] = true;
                return Next::Step(number, part);
            }
        }
        Next::Wait
    }
}

/// A step that is being done. One that is left by a panic stops the line, or the others would wait for it.
struct Working<'l, const STEPS: usize> {
    line: &'l Line<STEPS>,
    number: usize,
    is_done: bool,
}

impl<const STEPS: usize> Drop for Working<'_, STEPS> {
    fn drop(&mut self) {
        let mut progress = lock(&self.line.progress);
        progress.busy[self.number] = false;
        progress.done[self.number] += usize::from(self.is_done);
        progress.stopped |= !self.is_done;
    }
}

/// What a panic of another thread left is not used any more: the line stops.
pub(super) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// All steps in the order in which they ended.
    fn run(parts: usize, room: usize, threads: usize) -> Vec<(usize, usize)> {
        let line = Line::<3>::new(parts, room);
        let log = Mutex::new(Vec::new());
        std::thread::scope(|scope| {
            for thread in 0..threads {
                let (line, log) = (&line, &log);
                let prefers = [thread % 3, (thread + 1) % 3, (thread + 2) % 3];
                scope.spawn(move || {
                    line.work(prefers, |step, part| {
                        lock(log).push((step, part));
                        true
                    });
                });
            }
        });
        log.into_inner().unwrap()
    }

    proptest! {
        #[test]
        fn every_step_takes_all_parts_in_order(parts in 0..40_usize, room in 1..5_usize, threads in 1..5_usize) {
            let log = run(parts, room, threads);
            for step in 0..3 {
                let of_step: Vec<usize> = log.iter().filter(|(s, _)| *s == step).map(|(_, p)| *p).collect();
                prop_assert_eq!(of_step, (0..parts).collect::<Vec<_>>());
            }
            for part in 0..parts {
                let at = |step| log.iter().position(|entry| *entry == (step, part)).unwrap();
                prop_assert!(at(0) < at(1) && at(1) < at(2));
                if part >= room {
                    let left = log.iter().position(|entry| *entry == (2, part - room)).unwrap();
                    prop_assert!(left < at(0), "room");
                }
            }
        }
    }

    #[test]
    fn a_step_that_tells_to_stop_ends_it_for_all() {
        let line = Line::<2>::new(100, 4);
        let done = Mutex::new(0);
        std::thread::scope(|scope| {
            for _ in 0..2 {
                scope.spawn(|| {
                    line.work([0, 1], |step, part| {
                        *lock(&done) += 1;
                        (step, part) != (1, 5)
                    });
                });
            }
        });
        assert!(done.into_inner().unwrap() <= 6 + 10);
    }

    #[test]
    fn a_step_that_panics_ends_it_for_the_others() {
        let line = Line::<2>::new(100, 4);
        std::thread::scope(|scope| {
            let step = |_, part| {
                assert_ne!(part, 7, "the panic of this test");
                true
            };
            let line = &line;
            let one = scope.spawn(move || line.work([0, 1], step));
            let other = scope.spawn(move || line.work([1, 0], step));
            assert!(one.join().is_err() | other.join().is_err());
        });
    }
}
