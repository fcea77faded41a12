//! The errors of many points.

use std::ops::Range;

use terrace_stats::{SymmetricMatrix3, UncertainVector};

use crate::ahead::Ahead;
use crate::{CellId, GridError, VoxelGrid};

/// The errors of points that are inserted together, in metres.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum PointErrors<'a> {
    /// Not known: taken as 0.
    #[default]
    None,
    /// The same standard error along every axis, for all points.
    Same(f64),
    /// The same standard error along every axis, for each point.
    Each(&'a [f64]),
    /// Standard errors along x, y and z, for each point.
    Axes(&'a [[f64; 3]]),
    /// A covariance (xx, xy, xz, yy, yz, zz) in m², for each point.
    Covariances(&'a [[f64; 6]]),
}

impl PointErrors<'_> {
    /// For how many points there are errors; `None` if for any number.
    fn len(&self) -> Option<usize> {
        match self {
            Self::None | Self::Same(_) => None,
            Self::Each(sigmas) => Some(sigmas.len()),
            Self::Axes(sigmas) => Some(sigmas.len()),
            Self::Covariances(covariances) => Some(covariances.len()),
        }
    }

    /// Whether there are errors for so many points.
    pub(super) fn require(&self, points: usize) -> Result<(), GridError> {
        let errors = self.len().filter(|errors| *errors != points);
        errors.map_or(Ok(()), |errors| Err(GridError::Lengths { points, errors }))
    }

    /// Those of some of the points.
    pub(super) fn part(&self, range: Range<usize>) -> Self {
        match *self {
            Self::None | Self::Same(_) => *self,
            Self::Each(sigmas) => Self::Each(&sigmas[range]),
            Self::Axes(sigmas) => Self::Axes(&sigmas[range]),
            Self::Covariances(covariances) => Self::Covariances(&covariances[range]),
        }
    }

    /// How many numbers there are for each point.
    pub(super) fn width(&self) -> usize {
        match self {
            Self::None | Self::Same(_) => 0,
            Self::Each(_) => 1,
            Self::Axes(_) => 3,
            Self::Covariances(_) => 6,
        }
    }

    /// Appends the numbers of a point.
    #[inline]
    pub(super) fn append(&self, at: usize, to: &mut Vec<f64>) {
        match self {
            Self::None | Self::Same(_) => {}
            Self::Each(sigmas) => to.push(sigmas[at]),
            Self::Axes(sigmas) => to.extend_from_slice(&sigmas[at]),
            Self::Covariances(all) => to.extend_from_slice(&all[at]),
        }
    }

    /// The same kind of errors, of these numbers.
    pub(super) fn of_numbers<'n>(&self, numbers: &'n [f64]) -> PointErrors<'n> {
        match self {
            Self::None => PointErrors::None,
            Self::Same(sigma) => PointErrors::Same(*sigma),
            Self::Each(_) => PointErrors::Each(numbers),
            Self::Axes(_) => PointErrors::Axes(numbers.as_chunks().0),
            Self::Covariances(_) => PointErrors::Covariances(numbers.as_chunks().0),
        }
    }

    /// Asks for the memory of those of some of the points.
    pub(super) fn fetch(&self, range: Range<usize>, ahead: Ahead) {
        match self {
            Self::None | Self::Same(_) => {}
            Self::Each(sigmas) => ahead.fetch(sigmas.get(range).unwrap_or(&[])),
            Self::Axes(sigmas) => ahead.fetch(sigmas.get(range).unwrap_or(&[])),
            Self::Covariances(covariances) => ahead.fetch(covariances.get(range).unwrap_or(&[])),
        }
    }

    /// Whether all can be used.
    pub(super) fn are_valid(&self) -> bool {
        // Without a branch, several at a time.
        let all = |sigmas: &[f64]| {
            let bad = |bad, sigma: &f64| bad | u64::from(!is_error(*sigma));
            pulp::Arch::new().dispatch(|| sigmas.iter().fold(0, bad)) == 0
        };
        match self {
            Self::None => true,
            Self::Same(sigma) => is_error(*sigma),
            Self::Each(sigmas) => all(sigmas),
            Self::Axes(sigmas) => all(sigmas.as_flattened()),
            Self::Covariances(covariances) => covariances.iter().all(is_covariance),
        }
    }

    /// Why the error of a point cannot be used.
    pub(super) fn refusal(&self, at: usize) -> Option<GridError> {
        if let Self::Covariances(all) = self {
            let covariance = all[at];
            return (!is_covariance(&covariance)).then_some(GridError::Covariance { covariance });
        }
        let error = self.of(at);
        (!error.iter().all(|e| is_error(*e))).then_some(GridError::StandardError { error })
    }

    /// Adds one point.
    pub(super) fn insert(
        &self,
        grid: &mut VoxelGrid,
        point: [f64; 3],
        at: usize,
    ) -> Result<CellId, GridError> {
        match self {
            Self::Covariances(all) => grid.insert_covariant(point, &SymmetricMatrix3(all[at])),
            _ => grid.insert(&UncertainVector { value: point, error: self.of(at) }),
        }
    }

    /// The standard errors of a point.
    fn of(&self, at: usize) -> [f64; 3] {
        match self {
            Self::None => [0.0; 3],
            Self::Same(sigma) => [*sigma; 3],
            Self::Each(sigmas) => [sigmas[at]; 3],
            Self::Axes(sigmas) => sigmas[at],
            Self::Covariances(all) => SymmetricMatrix3(all[at]).diagonal_entries().map(f64::sqrt),
        }
    }
}

#[inline]
#[allow(clippy::manual_range_contains, clippy::needless_bitwise_bool, reason = "without a branch")]
fn is_error(sigma: f64) -> bool {
    (sigma >= 0.0) & (sigma < f64::INFINITY)
}

#[inline]
fn is_covariance(covariance: &[f64; 6]) -> bool {
    let [xx, _, _, yy, _, zz] = *covariance;
    covariance.iter().all(|c| c.is_finite()) && xx >= 0.0 && yy >= 0.0 && zz >= 0.0
}
