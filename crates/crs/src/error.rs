//! Why a search gives no result.

use thiserror::Error;

use crate::{CostError, StopReason};

/// Why a search gives no result. Positions and axes count from zero.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum SearchError {
    /// A population of zero has no best member, and a pattern search with zero starts no result.
    #[error("the population is empty")]
    EmptyPopulation,
    /// The subset, the members drawn for a reflection, is too small: one is reflected, through the centre of the
    /// others.
    #[error("a subset of {subset} is too small: a reflection needs at least 2 places")]
    SubsetTooSmall {
        /// The subset asked for.
        subset: usize,
    },
    /// The subset is drawn from the population, none twice, and cannot be larger.
    #[error("a subset of {subset} cannot be drawn from a population of {population}")]
    SubsetTooLarge {
        /// The subset asked for.
        subset: usize,
        /// The population.
        population: usize,
    },
    /// The spread at which to end, [`Stopping::spread`](crate::Stopping::spread), is negative or NaN.
    #[error("the spread tolerance {spread:?} is not a number of at least 0")]
    Spread {
        /// The tolerance asked for.
        spread: f64,
    },
    /// The target value is NaN, which no value reaches.
    #[error("the target {target:?} is not a number")]
    Target {
        /// The target asked for.
        target: f64,
    },
    /// The finest mesh of a pattern search, the shortest length of its moves
    /// ([`PatternSearch::finest`](crate::PatternSearch::finest)), is not above zero: it would never be reached.
    #[error("the finest mesh {finest:?} is not a number above 0")]
    Mesh {
        /// The finest mesh asked for.
        finest: f64,
    },
    /// The search had to end before any value was known: too few evaluations were allowed, or it was cancelled.
    #[error("the search ended before any value was known: {stop:?}")]
    NothingSeen {
        /// Why it ended.
        stop: StopReason,
    },
    /// A sweep goes from step to step, and this cost told no step at `x` and at a thousand places after it. Other
    /// methods work without steps.
    #[error("the cost tells no step at x = {x:?}: it cannot be swept on a real axis")]
    NoStep {
        /// The first of these places.
        x: f64,
    },
    /// A sweep walks along one axis.
    #[error("a sweep takes 1 axis, the bounds have {axes}")]
    NotOneAxis {
        /// The number of axes of the bounds.
        axes: usize,
    },
    /// There are more start places than members of the population, or than starts of a pattern search: raise that
    /// number or leave it to the method.
    #[error("{starts} start places do not fit a population of {population}")]
    TooManyStarts {
        /// The number of start places.
        starts: usize,
        /// The population, or the starts.
        population: usize,
    },
    /// A start place has another number of axes than the bounds.
    #[error("start place {index} has {axes} coordinates, the bounds have {dimension} axes")]
    StartDimension {
        /// Which start place, counted from zero.
        index: usize,
        /// Its number of coordinates.
        axes: usize,
        /// The number of axes of the bounds.
        dimension: usize,
    },
    /// A start place lies between the ends of an axis of whole numbers or listed values, but is none of its values.
    #[error("start place {index} is not allowed on axis {axis}: {value:?} is none of its values")]
    StartNotAllowed {
        /// Which start place, counted from zero.
        index: usize,
        /// The first axis on which it is not allowed.
        axis: usize,
        /// Its coordinate there.
        value: f64,
    },
    /// A start place is NaN or outside the bounds.
    #[error("start place {index} is outside the bounds on axis {axis}: {value:?} is not in [{lo:?}, {hi:?}]")]
    StartOutside {
        /// Which start place, counted from zero.
        index: usize,
        /// The first axis on which it is outside.
        axis: usize,
        /// Its coordinate there.
        value: f64,
        /// The lower bound there.
        lo: f64,
        /// The upper bound there.
        hi: f64,
    },
    /// The cost is made for another number of axes.
    #[error("the cost takes {cost} coordinates, the bounds have {bounds} axes")]
    CostDimension {
        /// The number of axes of the cost.
        cost: usize,
        /// The number of axes of the bounds.
        bounds: usize,
    },
    /// The known steps are those of a cost with another number of axes.
    #[error("the known steps have {steps} axes, the bounds have {bounds}")]
    StepsDimension {
        /// The number of axes of the known steps.
        steps: usize,
        /// The number of axes of the bounds.
        bounds: usize,
    },
    /// The cost broke its [contract](crate::Cost#contract).
    #[error(transparent)]
    Cost(#[from] CostError),
}
