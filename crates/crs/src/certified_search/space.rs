//! Several axes: disjoint boxes of what is not known.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::outlook::{Level, Outlook, Pair};
use super::pieces::{centre, halves, share, subtract};
use super::{CertifiedSearch, HONEST, OPENING, SLACK};
use crate::ledger::Ledger;
use crate::steps::Key;
use crate::{Axis, Cost, Minimum, SearchError, Step, StopReason};

pub(super) struct Space<'a, C: ?Sized> {
    ledger: Ledger<'a, C>,
    search: &'a CertifiedSearch,
    /// A piece that was asked in, or covered, is taken out.
    pieces: Vec<Option<Piece>>,
    by_score: BinaryHeap<(Key, Reverse<usize>)>,
    by_size: BinaryHeap<(Key, Reverse<usize>)>,
    seen: Vec<Observation>,
    pairs: Vec<Pair>,
    outlook: Outlook,
    highest: f64,
    /// Pairs when the outlook was last estimated.
    estimated: usize,
    questions: usize,
    points: usize,
    /// Whether all axes have a next value, so that single places can cover the domain.
    counted: bool,
}

/// An uncovered box.
struct Piece {
    axes: Vec<(f64, f64)>,
    /// The last place asked for beside it.
    beside: Option<usize>,
}

struct Observation {
    x: Vec<f64>,
    value: f64,
    level: Level,
}

impl<'a, C: Cost + ?Sized> Space<'a, C> {
    pub(super) fn new(ledger: Ledger<'a, C>, search: &'a CertifiedSearch) -> Self {
        let axes = ledger.bounds().axes();
        let whole = axes.iter().map(Axis::span).collect();
        let mut space = Self {
            counted: axes.iter().all(|axis| axis.count().is_some()),
            ledger,
            search,
            pieces: Vec::new(),
            by_score: BinaryHeap::new(),
            by_size: BinaryHeap::new(),
            seen: Vec::new(),
            pairs: Vec::new(),
            outlook: Outlook::estimate(&mut []),
            highest: f64::MIN,
            estimated: 0,
            questions: 0,
            points: 0,
        };
        space.push(whole, None);
        space
    }

    pub(super) fn run(mut self) -> Result<Minimum, SearchError> {
        for start in &self.search.start {
            if let Some(stop) = self.ledger.halt() {
                return self.finish(0, stop);
            }
            self.ledger.ask(start, 0)?;
        }
        let mut rounds = 0;
        loop {
            if let Some(stop) = self.ledger.halt() {
                return self.finish(rounds, stop);
            }
            if self.search.stopping.rounds.is_some_and(|most| rounds >= most) {
                return self.finish(rounds, StopReason::Rounds);
            }
            if self.points >= self.search.points(self.ledger.bounds().dimension()) {
                return self.finish(rounds, StopReason::NoSteps);
            }
            let mut group = Vec::new();
            let count = self.ledger.room(self.search.group());
            while group.len() < count
                && let Some(piece) = self.next()
            {
                group.push(piece);
            }
            if group.is_empty() {
                return self.ledger.finish_with(rounds, StopReason::Certified, Some(1.0));
            }
            rounds += 1;
            self.ask(group, rounds)?;
        }
    }

    /// The piece to ask in next, free of everything that is proven.
    fn next(&mut self) -> Option<Piece> {
        if 4 * (self.pairs.len() - self.estimated) > self.pairs.len() {
            self.refresh();
        }
        self.questions += 1;
        let by_size = self.questions.is_multiple_of(HONEST);
        loop {
            let (Key(key), Reverse(number)) =
                if by_size { self.by_size.pop()? } else { self.by_score.pop()? };
            let Some(piece) = &self.pieces[number] else { continue };
            if !by_size {
                // The lowest value may have fallen since this score was computed, and scores fall with it.
                let score = self.score(piece);
                let entry = (Key::new(score), Reverse(number));
                if score < key && self.by_score.peek().is_some_and(|next| *next > entry) {
                    self.by_score.push(entry);
                    continue;
                }
            }
            let piece = self.pieces[number].take()?;
            let Some(lowest) = self.ledger.lowest() else { return Some(piece) };
            let Some(covered) = self.ledger.steps().proof(&piece.axes, lowest, self.counted) else {
                return Some(piece);
            };
            for rest in subtract(self.ledger.bounds().axes(), &piece.axes, covered) {
                self.push(rest, piece.beside);
            }
        }
    }

    fn ask(&mut self, group: Vec<Piece>, round: usize) -> Result<(), SearchError> {
        let axes = self.ledger.bounds().axes();
        let places: Vec<Vec<f64>> = group.iter().map(|piece| centre(axes, &piece.axes)).collect();
        let heard = match &places[..] {
            [x] => {
                let slack = match self.ledger.lowest() {
                    Some(lowest) if self.questions > OPENING => SLACK * (self.highest - lowest),
                    _ => f64::INFINITY,
                };
                vec![self.ledger.ask_below(x, round, slack)?.number()]
            }
            many => self.ledger.ask_many(many, round)?,
        };
        for ((piece, x), value) in group.into_iter().zip(places).zip(heard) {
            self.highest = self.highest.max(value);
            let steps = self.ledger.steps();
            let step =
                steps.step_at(&x).or_else(|| steps.bound_at(&x)).map_or(Step::Point, |known| known.step);
            let rest = match step {
                Step::Box { lo, hi } => {
                    let covered: Vec<(f64, f64)> = lo.into_iter().zip(hi).collect();
                    subtract(axes, &piece.axes, &covered)
                }
                Step::Point if self.counted => {
                    let place: Vec<(f64, f64)> = x.iter().map(|x| (*x, x.next_up())).collect();
                    subtract(axes, &piece.axes, &place)
                }
                Step::Point => {
                    self.points += 1;
                    halves(axes, &piece.axes, &x)
                }
            };
            let here = self.observe(piece.beside, x, value);
            for axes in rest {
                self.push(axes, Some(here));
            }
        }
        Ok(())
    }

    fn observe(&mut self, beside: Option<usize>, x: Vec<f64>, value: f64) -> usize {
        let level = match beside.map(|number| &self.seen[number]) {
            Some(other) => {
                let distance = self.distance(&other.x, &x);
                self.pairs.push(Pair { distance, difference: value - other.value });
                self.outlook.update(self.outlook.beyond(other.level, distance), value)
            }
            None => Level { mean: value, variance: self.outlook.jitter },
        };
        self.seen.push(Observation { x, value, level });
        self.seen.len() - 1
    }

    fn push(&mut self, axes: Vec<(f64, f64)>, beside: Option<usize>) {
        let number = self.pieces.len();
        let piece = Piece { axes, beside };
        self.by_size.push((Key::new(share(self.ledger.bounds().axes(), &piece.axes)), Reverse(number)));
        self.by_score.push((Key::new(self.score(&piece)), Reverse(number)));
        self.pieces.push(Some(piece));
    }

    fn score(&self, piece: &Piece) -> f64 {
        let (Some(lowest), Some(beside)) = (self.ledger.lowest(), piece.beside) else { return f64::INFINITY };
        let beside = &self.seen[beside];
        let x = centre(self.ledger.bounds().axes(), &piece.axes);
        let level = self.outlook.beyond(beside.level, self.distance(&beside.x, &x));
        self.outlook.chance(level, self.outlook.goal(lowest))
    }

    /// The largest distance along an axis, as a share of it.
    fn distance(&self, a: &[f64], b: &[f64]) -> f64 {
        let axes = self.ledger.bounds().axes();
        let along = axes.iter().zip(a).zip(b).map(|((axis, a), b)| axis.share(a.min(*b), a.max(*b)));
        along.fold(0.0, f64::max)
    }

    /// Estimates the scale anew, and with it all scores.
    fn refresh(&mut self) {
        self.estimated = self.pairs.len();
        self.outlook = Outlook::estimate(&mut self.pairs);
        let scored = self.pieces.iter().enumerate().filter_map(|(number, piece)| {
            piece.as_ref().map(|piece| (Key::new(self.score(piece)), Reverse(number)))
        });
        self.by_score = scored.collect();
    }

    fn finish(self, rounds: usize, stop: StopReason) -> Result<Minimum, SearchError> {
        let Some(lowest) = self.ledger.lowest() else { return self.ledger.finish(rounds, stop) };
        let axes = self.ledger.bounds().axes();
        let mut open: Vec<Vec<(f64, f64)>> =
            self.pieces.into_iter().flatten().map(|piece| piece.axes).collect();
        let (mut uncovered, mut missing) = (0.0, false);
        while let Some(piece) = open.pop() {
            if let Some(covered) = self.ledger.steps().proof(&piece, lowest, self.counted) {
                open.extend(subtract(axes, &piece, covered));
            } else {
                uncovered += share(axes, &piece);
                missing = true;
            }
        }
        let most = if missing { 1.0_f64.next_down() } else { 1.0 };
        self.ledger.finish_with(rounds, stop, Some((1.0 - uncovered).clamp(0.0, most)))
    }
}
