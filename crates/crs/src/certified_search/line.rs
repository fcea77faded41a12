//! One axis: gaps between known steps.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::outlook::{Level, Outlook, Pair};
use super::{CertifiedSearch, HONEST, OPENING, SLACK};
use crate::ledger::Ledger;
use crate::steps::Key;
use crate::{Axis, Cost, Minimum, SearchError, Step, StopReason};

/// No place nearer to the end of a gap than this part of it: that close, little is learnt of the rest.
const EDGE: f64 = 0.1;

/// So many questions in vain, and as many again as led to the lowest value, end the search for a lower one: the rest is
/// walked through.
const PATIENCE: usize = 50;

/// The axis in ascending order: gaps, and what is known between them.
pub(super) struct Line<'a, C: ?Sized> {
    axis: &'a Axis,
    ledger: Ledger<'a, C>,
    search: &'a CertifiedSearch,
    /// A linked list in a vector; a gap becomes the known step that was found in it and never goes away.
    stretches: Vec<Stretch>,
    first: usize,
    by_score: BinaryHeap<(Key, Reverse<usize>)>,
    by_width: BinaryHeap<(Key, Reverse<usize>)>,
    outlook: Outlook,
    highest: f64,
    /// Known steps, and how many they were when the outlook was last estimated.
    known: usize,
    seen: usize,
    questions: usize,
    points: usize,
    /// The lowest value so far, the stretch where it was found, and by which question.
    lowest: f64,
    lowest_at: usize,
    improved: usize,
    walk: Walk,
}

/// The way through the rest, in ascending order from the lowest value to the upper bound, and then from the lower one.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Walk {
    NotYet,
    /// The stretch it stands at, and whether it has begun at the lower bound.
    At(usize, bool),
}

#[derive(Debug, Clone, Copy)]
struct Stretch {
    lo: f64,
    hi: f64,
    before: Option<usize>,
    after: Option<usize>,
    state: State,
}

#[derive(Debug, Clone, Copy)]
enum State {
    Gap,
    /// A gap whose question is being asked.
    Asked,
    /// A value or a lower bound, and the trend there.
    Known {
        value: f64,
        level: Level,
    },
}

impl<'a, C: Cost + ?Sized> Line<'a, C> {
    pub(super) fn new(axis: &'a Axis, ledger: Ledger<'a, C>, search: &'a CertifiedSearch) -> Self {
        let (lo, hi) = axis.span();
        let whole = Stretch { lo, hi, before: None, after: None, state: State::Gap };
        let mut line = Self {
            axis,
            ledger,
            search,
            stretches: vec![whole],
            first: 0,
            by_score: BinaryHeap::new(),
            by_width: BinaryHeap::new(),
            outlook: Outlook::estimate(&mut []),
            highest: f64::MIN,
            known: 0,
            seen: 0,
            questions: 0,
            points: 0,
            lowest: f64::INFINITY,
            lowest_at: 0,
            improved: 0,
            walk: Walk::NotYet,
        };
        line.push(0);
        line
    }

    pub(super) fn run(mut self) -> Result<Minimum, SearchError> {
        for start in &self.search.start {
            if let Some(stop) = self.ledger.halt() {
                return self.ledger.finish(0, stop);
            }
            let [x] = start[..] else { continue };
            let value = self.ledger.ask(start, 0)?;
            if let Some(gap) = self.gap_around(x) {
                self.cut(gap, x, value);
            }
        }
        let mut rounds = 0;
        loop {
            if let Some(stop) = self.ledger.halt() {
                return self.ledger.finish(rounds, stop);
            }
            if self.search.stopping.rounds.is_some_and(|most| rounds >= most) {
                return self.ledger.finish(rounds, StopReason::Rounds);
            }
            if self.points >= self.search.points(1) {
                return self.ledger.finish(rounds, StopReason::NoSteps);
            }
            let group = self.group();
            if group.is_empty() {
                return self.ledger.finish(rounds, StopReason::Certified);
            }
            rounds += 1;
            self.ask(&group, rounds)?;
        }
    }

    /// The gaps to ask in next, and the place in each.
    fn group(&mut self) -> Vec<(usize, f64)> {
        let count = self.ledger.room(self.search.group());
        let mut group = Vec::with_capacity(count.min(self.stretches.len()));
        while group.len() < count {
            let Some((gap, at)) = self.next() else { break };
            let Stretch { lo, hi, .. } = self.stretches[gap];
            self.stretches[gap].state = State::Asked;
            group.push((gap, self.axis.part(lo, hi, at)));
        }
        group
    }

    fn next(&mut self) -> Option<(usize, f64)> {
        if self.walk == Walk::NotYet && self.questions - self.improved > self.improved + PATIENCE {
            self.walk = Walk::At(self.lowest_at, false);
        }
        self.questions += 1;
        if let Some(gap) = self.next_on_walk() {
            return Some((gap, 0.0));
        }
        // A third more is known than when the outlook was estimated: each step is seen a constant number of times.
        if 3 * (self.known - self.seen) > self.seen {
            self.refresh();
        }
        if self.questions <= OPENING || self.questions.is_multiple_of(HONEST) {
            while let Some((_, Reverse(gap))) = self.by_width.pop() {
                if matches!(self.stretches[gap].state, State::Gap) {
                    return Some((gap, 0.5));
                }
            }
            return None;
        }
        loop {
            let (_, Reverse(gap)) = self.by_score.pop()?;
            if !matches!(self.stretches[gap].state, State::Gap) {
                continue;
            }
            // The lowest value may have fallen since this score was computed, and scores fall with it.
            let (score, at) = self.score(gap);
            let entry = (Key::new(score), Reverse(gap));
            if self.by_score.peek().is_some_and(|next| *next > entry) {
                self.by_score.push(entry);
            } else {
                return Some((gap, at));
            }
        }
    }

    fn next_on_walk(&mut self) -> Option<usize> {
        while let Walk::At(here, again) = self.walk {
            if matches!(self.stretches[here].state, State::Gap) {
                return Some(here);
            }
            self.walk = match self.stretches[here].after {
                Some(after) => Walk::At(after, again),
                None if again => return None,
                None => Walk::At(self.first, true),
            };
        }
        None
    }

    fn ask(&mut self, group: &[(usize, f64)], round: usize) -> Result<(), SearchError> {
        let lowest = self.ledger.lowest();
        let heard: Vec<f64> = if let [(_, x)] = group {
            let slack = match (lowest, self.walk) {
                _ if self.questions <= OPENING => f64::INFINITY,
                (Some(lowest), Walk::NotYet) => SLACK * (self.highest - lowest),
                _ => 0.0,
            };
            vec![self.ledger.ask_below(&[*x], round, slack)?.number()]
        } else {
            let places: Vec<Vec<f64>> = group.iter().map(|(_, x)| vec![*x]).collect();
            self.ledger.ask_many(&places, round)?
        };
        for ((gap, x), value) in group.iter().zip(heard) {
            self.highest = self.highest.max(value);
            self.cut(*gap, *x, value);
        }
        Ok(())
    }

    /// Makes the gap what was learnt at `x`, and new gaps of what it leaves on either side.
    fn cut(&mut self, gap: usize, x: f64, value: f64) {
        let steps = self.ledger.steps();
        let known = steps.step_at(&[x]).or_else(|| steps.bound_at(&[x])).map(|known| known.step);
        let (lo, hi) = if let Some(Step::Box { lo, hi }) = &known {
            (lo.first().copied().unwrap_or(x), hi.first().copied().unwrap_or(x))
        } else {
            self.points += usize::from(self.axis.count().is_none());
            (x, x.next_up())
        };
        let Stretch { lo: from, hi: to, before, after, .. } = self.stretches[gap];
        let (lo, hi) = (lo.max(from), hi.min(to));
        let width = self.axis.share(from, to);
        let at = if width > 0.0 { self.axis.share(from, lo) / width } else { 0.5 };
        let prior = self.level_in(before, after, width, at);
        let level = match prior {
            Some(prior) => self.outlook.update(prior, value),
            None => Level { mean: value, variance: self.outlook.jitter },
        };
        self.known += 1;
        // A bound is never below the lowest value.
        if value < self.lowest {
            (self.lowest, self.lowest_at, self.improved) = (value, gap, self.questions);
        }
        let state = State::Known { value, level };
        self.stretches[gap] = Stretch { lo, hi, before, after, state };
        // Links first, scores last: a score looks at both neighbours.
        let left = self.axis.within(from, lo).map(|(lo, hi)| {
            let left = self.add(Stretch { lo, hi, before, after: Some(gap), state: State::Gap });
            self.stretches[gap].before = Some(left);
            match before {
                Some(before) => self.stretches[before].after = Some(left),
                None => self.first = left,
            }
            left
        });
        let right = self.axis.within(hi, to).map(|(lo, hi)| {
            let right = self.add(Stretch { lo, hi, before: Some(gap), after, state: State::Gap });
            self.stretches[gap].after = Some(right);
            if let Some(after) = after {
                self.stretches[after].before = Some(right);
            }
            right
        });
        for new in [left, right].into_iter().flatten() {
            self.push(new);
        }
    }

    fn add(&mut self, stretch: Stretch) -> usize {
        self.stretches.push(stretch);
        self.stretches.len() - 1
    }

    fn push(&mut self, gap: usize) {
        let Stretch { lo, hi, .. } = self.stretches[gap];
        self.by_width.push((Key::new(self.axis.share(lo, hi)), Reverse(gap)));
        let score = self.score(gap).0;
        self.by_score.push((Key::new(score), Reverse(gap)));
    }

    fn level(&self, stretch: usize) -> Option<Level> {
        match self.stretches[stretch].state {
            State::Known { level, .. } => Some(level),
            State::Gap | State::Asked => None,
        }
    }

    /// The trend to be expected in a gap between two stretches.
    fn level_in(&self, before: Option<usize>, after: Option<usize>, width: f64, at: f64) -> Option<Level> {
        match (before.and_then(|b| self.level(b)), after.and_then(|a| self.level(a))) {
            (Some(a), Some(b)) => Some(self.outlook.level(a, b, width, at)),
            (Some(a), None) => Some(self.outlook.beyond(a, width * at)),
            (None, Some(b)) => Some(self.outlook.beyond(b, width * (1.0 - at))),
            (None, None) => None,
        }
    }

    /// The best place in a gap, as a part of it, and its score.
    fn score(&self, gap: usize) -> (f64, f64) {
        let Stretch { lo, hi, before, after, .. } = self.stretches[gap];
        let width = self.axis.share(lo, hi);
        let Some(lowest) = self.ledger.lowest() else { return (f64::INFINITY, 0.5) };
        let goal = self.outlook.goal(lowest);
        // At the end of the axis nothing bounds the trend, and it may have gone farthest at the far end.
        let (a, b) = (before.and_then(|b| self.level(b)), after.and_then(|a| self.level(a)));
        match (a, b) {
            (Some(a), Some(b)) => {
                // Without jitter the best place divides the gap as the two heights above the goal are to each other.
                let (over_a, over_b) = (a.mean - goal, b.mean - goal);
                let towards = if over_a + over_b > 0.0 { over_a / (over_a + over_b) } else { 0.5 };
                let towards = towards.clamp(EDGE, 1.0 - EDGE);
                let places = [0.5, towards];
                let scored = places.map(|at| (self.outlook.between(a, b, width, at, goal), at));
                if scored[1].0 > scored[0].0 { scored[1] } else { scored[0] }
            }
            (Some(a), None) => (self.outlook.chance(self.outlook.beyond(a, width), goal), 1.0),
            (None, Some(b)) => (self.outlook.chance(self.outlook.beyond(b, width), goal), 0.0),
            (None, None) => (f64::INFINITY, 0.5),
        }
    }

    /// Estimates the scale and the trend anew, and with it all scores.
    fn refresh(&mut self) {
        self.seen = self.known;
        let (mut places, mut values, mut gaps) = (Vec::with_capacity(self.known), Vec::new(), Vec::new());
        let mut next = Some(self.first);
        while let Some(here) = next {
            let Stretch { lo, hi, after, state, .. } = self.stretches[here];
            match state {
                State::Known { value, .. } => {
                    let [from, to] = [lo, hi].map(|end| self.axis.share(f64::NEG_INFINITY, end));
                    places.push((here, f64::midpoint(from, to)));
                    values.push(value);
                }
                State::Gap => gaps.push(here),
                State::Asked => {}
            }
            next = after;
        }
        let distances = std::iter::once(0.0).chain(places.windows(2).map(|pair| pair[1].1 - pair[0].1));
        let known: Vec<(f64, f64)> = distances.zip(values).collect();
        let mut pairs: Vec<Pair> = known
            .windows(2)
            .map(|pair| Pair { distance: pair[1].0, difference: pair[1].1 - pair[0].1 })
            .collect();
        self.outlook = Outlook::estimate(&mut pairs);
        for ((here, _), level) in places.iter().zip(self.outlook.smooth(&known)) {
            if let State::Known { level: old, .. } = &mut self.stretches[*here].state {
                *old = level;
            }
        }
        self.by_score = gaps.iter().map(|gap| (Key::new(self.score(*gap).0), Reverse(*gap))).collect();
    }

    /// The gap that holds `x`, if it is not known.
    fn gap_around(&self, x: f64) -> Option<usize> {
        let mut next = Some(self.first);
        while let Some(here) = next {
            let Stretch { lo, hi, after, state, .. } = self.stretches[here];
            if lo <= x && x < hi {
                return matches!(state, State::Gap).then_some(here);
            }
            next = after;
        }
        None
    }
}
