//! What normals need to know of a cell.

use terrace_stats::{Stats, SymmetricMatrix3};

/// A cell of a neighbourhood, by what its normal is [estimated](crate::estimate) from: its statistics, or the [summary](Summary) of them.
pub trait Summarised {
    /// Sum of the weights of its points.
    fn weight(&self) -> f64;
    /// The mean of its points, in metres; `None` without weight.
    fn mean(&self) -> Option<[f64; 3]>;
    /// How its points scatter about their mean, in m²: see [`Stats::covariance`].
    fn covariance(&self) -> Option<SymmetricMatrix3>;
    /// The covariance of their mean, in m²: see [`Stats::covariance_of_mean`].
    fn covariance_of_mean(&self) -> Option<SymmetricMatrix3>;
}

impl Summarised for Stats {
    fn weight(&self) -> f64 {
        Self::weight(self)
    }

    fn mean(&self) -> Option<[f64; 3]> {
        Self::mean(self)
    }

    fn covariance(&self) -> Option<SymmetricMatrix3> {
        Self::covariance(self)
    }

    fn covariance_of_mean(&self) -> Option<SymmetricMatrix3> {
        Self::covariance_of_mean(self)
    }
}

/// The mean of a cell and the covariances around it, found once: for cells that are of many neighbourhoods, as those of a grid are. Normals
/// are the same to the bit.
///
/// ```
/// use terrace_normals::{FitTo, Summary, estimate};
/// use terrace_stats::{Stats, UncertainVector};
///
/// let cells: Vec<Stats> = (0..9)
///     .map(|i| {
///         let centre = [0.1 * f64::from(i % 3), 0.1 * f64::from(i / 3), 0.7];
///         let mut cell = Stats::new(centre);
///         cell.push(&UncertainVector::isotropic(centre, 0.01));
///         cell
///     })
///     .collect();
/// let summaries: Vec<Summary> = cells.iter().map(Summary::of).collect();
/// assert_eq!(estimate(&summaries, FitTo::Points), estimate(&cells, FitTo::Points));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Summary {
    weight: f64,
    /// None without weight.
    known: Option<Known>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Known {
    mean: [f64; 3],
    covariance: SymmetricMatrix3,
    covariance_of_mean: SymmetricMatrix3,
}

impl Summary {
    /// Of the statistics of a cell.
    pub fn of(cell: &Stats) -> Self {
        let known = || {
            Some(Known {
                mean: cell.mean()?,
                covariance: cell.covariance()?,
                covariance_of_mean: cell.covariance_of_mean()?,
            })
        };
        Self { weight: cell.weight(), known: known() }
    }
}

impl Summarised for Summary {
    fn weight(&self) -> f64 {
        self.weight
    }

    fn mean(&self) -> Option<[f64; 3]> {
        Some(self.known?.mean)
    }

    fn covariance(&self) -> Option<SymmetricMatrix3> {
        Some(self.known?.covariance)
    }

    fn covariance_of_mean(&self) -> Option<SymmetricMatrix3> {
        Some(self.known?.covariance_of_mean)
    }
}
