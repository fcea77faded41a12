//! What a search returns.

use crate::Step;

/// The lowest cost a search has seen, and how it came to it.
///
/// Of several places with the same cost, the one found first is returned.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Minimum {
    /// Where the lowest cost was seen; inside the bounds.
    pub x: Vec<f64>,
    /// The cost there.
    pub value: f64,
    /// The step `x` stands on: every place on it has the same cost.
    pub step: Step,
    /// How often a value was asked for, known or not: the length of [`trace`](Self::trace).
    pub calls: usize,
    /// How often the cost was really evaluated, answers that gave up early included; at most `calls`.
    pub evaluations: usize,
    /// The rounds done after the first population or start places; each method tells what a round is.
    pub rounds: usize,
    /// Why the search ended.
    pub stop: StopReason,
    /// The share of the domain (all allowed places), from 0 to 1, on which it is proven that the cost is not below
    /// [`value`](Self::value): the places on known steps of this or a higher value, and those for which the cost said
    /// that it is *at least* this value or a higher one. Real axes are measured by width, the others by the number of
    /// values; in several axes the share of a box is the product of its shares of the axes.
    ///
    /// Exactly 1 only when it is proven at every place: where the least is missing it is below 1. `None` when the
    /// method does not keep count: in several axes all but [`CertifiedSearch`](crate::CertifiedSearch).
    pub certified: Option<f64>,
    /// Every place whose value was asked for, in order.
    pub trace: Vec<Trial>,
}

impl Minimum {
    /// Whether [`value`](Self::value) is proven to be the lowest cost of the whole domain.
    ///
    /// The proof rests on the steps and lower bounds the cost has told: it is as right as they are.
    pub fn is_proven(&self) -> bool {
        self.certified == Some(1.0)
    }
}

/// One question of a search: a place whose value was asked for, and the answer.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Trial {
    /// The place.
    pub x: Vec<f64>,
    /// The cost there; a lower bound of it when [`source`](Self::source) says so.
    pub value: f64,
    /// Where the value came from.
    pub source: Source,
    /// Whether the place entered the population. In a pattern search: whether it was a start place, or lower than the
    /// place the move was made from. In the other methods without a population: whether it was the lowest so far.
    pub accepted: bool,
    /// The round, counted from one; zero is the first population or the start places, in a pattern search the first of
    /// these.
    pub round: usize,
}

/// Where a value came from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Source {
    /// The cost was evaluated.
    Evaluated,
    /// The place lies on a known step; the cost was not asked.
    Known,
    /// The cost was evaluated and gave up early: the value is a lower bound of the cost there.
    Bounded,
    /// The place lies where a lower bound is known that is at or above the lowest value so far; the cost was not
    /// asked.
    KnownBounded,
}

impl Source {
    /// Whether the value is a lower bound of the cost and not the cost itself.
    pub fn is_bound(self) -> bool {
        matches!(self, Self::Bounded | Self::KnownBounded)
    }

    /// Whether the cost was asked.
    pub fn is_evaluation(self) -> bool {
        matches!(self, Self::Evaluated | Self::Bounded)
    }
}

/// Why a search ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum StopReason {
    /// The allowed number of rounds was done.
    Rounds,
    /// The costs of the population lay within [`Stopping::spread`](crate::Stopping::spread) of each other.
    Spread,
    /// One known step contains every member of the population; for a cost that knows no steps, all members are the
    /// same place.
    ///
    /// The population agrees on value and place. This does not prove that nothing is lower: a reflection could still
    /// leave the step by as much as its width, and a lower step elsewhere may never have been met. It is proof when
    /// the step contains the bounds.
    OneStep,
    /// The cost was evaluated [`Stopping::evaluations`](crate::Stopping::evaluations) times.
    Evaluations,
    /// [`Stopping::stall`](crate::Stopping::stall) evaluations in a row gave no lower value.
    Stall,
    /// A value at or below [`Stopping::target`](crate::Stopping::target) was seen.
    Target,
    /// The caller set the flag [`Stopping::cancel`](crate::Stopping::cancel).
    Cancelled,
    /// At every place of the domain the cost is known, or proven to be no lower: no allowed place has a lower value
    /// than the one found.
    Certified,
    /// From every start a pattern search has come to a place from which none of its moves leads down.
    Converged,
    /// A [`CertifiedSearch`](crate::CertifiedSearch) without a limit met a cost that tells no steps on a real axis,
    /// where no number of single places makes a proof.
    NoSteps,
}
