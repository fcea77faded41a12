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
    /// The step `x` stands on: the whole box can be had for the same cost.
    pub step: Step,
    /// How often a value was asked for, known or not: the length of [`trace`](Self::trace).
    pub calls: usize,
    /// How often the cost was really evaluated; at most `calls`.
    pub evaluations: usize,
    /// The rounds done after the first population.
    pub rounds: usize,
    /// Why the search ended.
    pub stop: StopReason,
    /// Every place whose value was asked for, in order.
    pub trace: Vec<Trial>,
}

/// One question of a search.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Trial {
    /// The place.
    pub x: Vec<f64>,
    /// The cost there.
    pub value: f64,
    /// Whether the cost had to be evaluated.
    pub source: Source,
    /// Whether the place entered the population.
    pub accepted: bool,
    /// The round, counted from one; zero is the first population.
    pub round: usize,
}

/// Where a value came from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Source {
    /// The cost was evaluated.
    Evaluated,
    /// The place lies on a known step; the cost was not asked.
    Known,
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
    /// The population agrees on value and place. This is convergence and not proof: a reflection may still leave the
    /// step by as much as its width, and a lower step elsewhere may never have been met. It is proof when the step
    /// contains the bounds. When several reasons hold at once, this one is given.
    OneStep,
}
