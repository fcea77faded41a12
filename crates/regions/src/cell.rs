//! A cell as the growth sees it.

use glam::DVec3;
use terrace_stats::{Stats, SymmetricMatrix3};

use crate::flat::Flat;
use crate::sum::Sum;

/// A cell of points: where it is in the lattice, and the sums of its points with their errors.
///
/// Where errors of points are large beside the edge, eight cells tell no more of a surface than one in their place: see
/// [`is_wide`](Self::is_wide).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cell {
    /// Its place in the lattice of cubic cells.
    pub key: [i32; 3],
    /// Whether it has twice the edge: it is in the place of all eight cells whose keys differ from its own in the lowest bits only, and
    /// none of these is there. Its sums are then from its middle.
    pub is_wide: bool,
    /// Its points, each with weight 1, and what is known of their errors.
    pub stats: Stats,
}

/// Cells that may be kept elsewhere: of each, by its place, what a [`Cell`] is.
pub trait Cells: Sync {
    /// How many there are.
    fn count(&self) -> usize;

    /// See [`Cell::key`].
    fn key(&self, at: usize) -> [i32; 3];

    /// See [`Cell::is_wide`].
    fn is_wide(&self, at: usize) -> bool;

    /// See [`Cell::stats`].
    fn stats(&self, at: usize) -> Stats;

    /// Whether all cells that are not wide are told about the middle of the wide cell whose part they are, and have all their points in their own
    /// cube: then it is known better which planes can reach them.
    fn are_parts(&self) -> bool {
        false
    }

    /// That the sums of a cell are asked for soon: a chance to have its memory brought.
    fn fetch(&self, _at: usize) {}
}

impl Cells for [Cell] {
    fn count(&self) -> usize {
        self.len()
    }

    fn key(&self, at: usize) -> [i32; 3] {
        self[at].key
    }

    fn is_wide(&self, at: usize) -> bool {
        self[at].is_wide
    }

    fn stats(&self, at: usize) -> Stats {
        self[at].stats
    }
}

/// A cell with what is asked of it again and again.
#[derive(Debug, Clone)]
pub(crate) struct Sums {
    pub(crate) points: f64,
    pub(crate) mean: DVec3,
    scatter: SymmetricMatrix3,
    /// The mean covariance of the error of a point.
    noise: SymmetricMatrix3,
}

impl Sums {
    /// Of no points.
    pub(crate) const NOTHING: Self = Self {
        points: 0.0,
        mean: DVec3::ZERO,
        scatter: SymmetricMatrix3::ZERO,
        noise: SymmetricMatrix3::ZERO,
    };

    /// `None` without a point, or when the sums are not finite.
    pub(crate) fn of(stats: &Stats) -> Option<Self> {
        let (moments, mean) = (stats.moments(), DVec3::from(stats.mean()?));
        let points = stats.count() as f64;
        let finite = mean.is_finite() && moments.second().is_finite() && moments.noise().is_finite();
        let scatter = stats.covariance()?;
        finite.then(|| Self { points, mean, scatter, noise: moments.noise() * (1.0 / points) })
    }

    /// Takes other errors: the sum of their covariances.
    pub(crate) fn set_noise(&mut self, noise: SymmetricMatrix3) {
        self.noise = noise * (1.0 / self.points);
    }

    /// Adds to the errors of all points.
    pub(crate) fn add_noise(&mut self, mean: &SymmetricMatrix3) {
        self.noise += *mean;
    }

    /// The sums about an anchor.
    // Into what callers are dispatched to.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    pub(crate) fn about(&self, anchor: DVec3) -> Sum {
        Sum::of_mean(self.points, self.mean - anchor, &self.scatter, &self.noise)
    }

    /// Mean squared distance of the points from a plane, in m².
    pub(crate) fn mean_square(&self, plane: &Flat) -> f64 {
        let off = plane.distance(self.mean);
        self.scatter.quadratic_form(plane.normal.to_array()).max(0.0) + off * off
    }

    /// Mean variance of the error of a point along a direction, as it is stated, in m².
    pub(crate) fn stated(&self, direction: DVec3) -> f64 {
        self.noise.quadratic_form(direction.to_array())
    }
}

/// What the errors of points are taken to be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Noise {
    /// Times what is stated, in m²/m².
    pub(crate) scale: f64,
    /// And at least this, in m².
    pub(crate) floor: f64,
}

impl Noise {
    /// In units of a squared edge, which is in metres.
    pub(crate) fn in_units(self, edge: f64) -> Self {
        Self { floor: self.floor / (edge * edge), ..self }
    }

    /// Variance of the error of a point of a cell along a direction, in m².
    pub(crate) fn variance(&self, cell: &Sums, direction: DVec3) -> f64 {
        (self.scale * cell.stated(direction)).max(self.floor)
    }
}
