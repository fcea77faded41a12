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
    /// How often the cost was really evaluated, answers that gave up early included; at most `calls`.
    pub evaluations: usize,
    /// The rounds done after the first population or start places.
    pub rounds: usize,
    /// Why the search ended.
    pub stop: StopReason,
    /// The share of the domain, from 0 to 1, on which it is proven that the cost is not below [`value`](Self::value):
    /// the places on known steps of this or a higher value, and those under a lower bound at or above it. Measured as
    /// the product over the axes: by width on real axes, by the number of values on the others and on axes of zero
    /// width.
    ///
    /// Exactly 1 only when it is proven at every place, however little may be missing. `None` when the method does not
    /// keep count: the population methods and the pattern search, in several axes.
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

/// One question of a search.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Trial {
    /// The place.
    pub x: Vec<f64>,
    /// The cost there; a lower bound of it when [`source`](Self::source) says so.
    pub value: f64,
    /// Where the value came from.
    pub source: Source,
    /// Whether the place entered the population. Methods without one: whether the search went on from there (pattern
    /// search) or it was the lowest so far (the others).
    pub accepted: bool,
    /// The round, counted from one; zero is the first population, or the start places.
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
    /// The place lies where a lower bound is known that suffices; the cost was not asked.
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
    /// The population agrees on value and place. This is convergence and not proof: a reflection may still leave the
    /// step by as much as its width, and a lower step elsewhere may never have been met. It is proof when the step
    /// contains the bounds.
    OneStep,
    /// The cost was evaluated [`Stopping::evaluations`](crate::Stopping::evaluations) times.
    Evaluations,
    /// [`Stopping::stall`](crate::Stopping::stall) evaluations in a row gave no lower value.
    Stall,
    /// A value at or below [`Stopping::target`](crate::Stopping::target) was seen.
    Target,
    /// The caller set the flag [`Stopping::cancel`](crate::Stopping::cancel).
    Cancelled,
    /// The cost is known, or proven to be no lower, at every place of the domain: the value is the global minimum.
    Certified,
    /// Every start of a pattern search has come to a place from which none of its moves leads down.
    Converged,
    /// A search for a certificate met a cost that tells no steps on a real axis, where no number of places makes a
    /// proof, and no limit was set. See [`CertifiedSearch`](crate::CertifiedSearch).
    NoSteps,
}
