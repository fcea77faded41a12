//! Points one by one, by either rule.

use terrace_stats::{SymmetricMatrix3, UncertainVector};

use crate::cell::CellId;
use crate::grid::Home;
use crate::key::key_of;
use crate::{Assignment, GridError, VoxelGrid, VoxelKey};

impl VoxelGrid {
    /// Adds a point with weight 1 and returns its cell. Many at once are faster by [`VoxelGrid::insert_all`].
    ///
    /// # Errors
    /// [`GridError`] for a point or error that is not finite, a negative error, a point out of range, a full grid. The
    /// grid is then unchanged.
    #[inline]
    pub fn insert(&mut self, point: &UncertainVector) -> Result<CellId, GridError> {
        let (home, local) = self.place(point)?;
        self.moments_mut(home).push(&local);
        Ok(self.id_of(home))
    }

    /// Adds a point with weight 1 whose error has this covariance, in m², and returns its cell. The rule of assignment
    /// looks at its diagonal.
    ///
    /// # Errors
    /// As [`VoxelGrid::insert`], and for a covariance that is not finite or has a negative variance.
    #[inline]
    pub fn insert_covariant(
        &mut self,
        point: [f64; 3],
        covariance: &SymmetricMatrix3,
    ) -> Result<CellId, GridError> {
        if !covariance.is_finite() || covariance.diagonal_entries().iter().any(|variance| *variance < 0.0) {
            return Err(GridError::Covariance { covariance: covariance.0 });
        }
        let error = covariance.diagonal_entries().map(f64::sqrt);
        let (home, local) = self.place(&UncertainVector { value: point, error })?;
        self.moments_mut(home).push_covariant(local.value, covariance);
        Ok(self.id_of(home))
    }

    /// Adds a point with a weight, such as `1/σ²`, and returns its cell.
    ///
    /// # Errors
    /// As [`VoxelGrid::insert`], and for a weight that is not positive and finite.
    pub fn insert_weighted(&mut self, point: &UncertainVector, weight: f64) -> Result<CellId, GridError> {
        if !(weight > 0.0 && weight.is_finite()) {
            return Err(GridError::Weight { weight });
        }
        let (home, local) = self.place(point)?;
        self.moments_mut(home).push_weighted(&local, weight);
        Ok(self.id_of(home))
    }

    /// Where the cell that `point` belongs to is kept, and the point relative to its centre.
    #[inline]
    fn place(&mut self, point: &UncertainVector) -> Result<(Home, UncertainVector), GridError> {
        if !point.error.iter().all(|e| e.is_finite() && *e >= 0.0) {
            return Err(GridError::StandardError { error: point.error });
        }
        let key = key_of(point.value, self.lattice.size)?;
        let (own, new) = self.home_or_new(key)?;
        match self.assignment {
            Assignment::ExpectedDistance if !new => Ok(self.nearest(key, own, point)),
            _ => Ok((own, self.local(key, point))),
        }
    }

    #[inline]
    fn local(&self, key: VoxelKey, point: &UncertainVector) -> UncertainVector {
        let anchor = self.lattice.anchor_of(key);
        UncertainVector { value: [0, 1, 2].map(|i| point.value[i] - anchor[i]), error: point.error }
    }

    /// The cell around `key` with the smallest expected squared distance, `own` on a tie, and the point relative to its
    /// centre.
    fn nearest(&self, key: VoxelKey, own: Home, point: &UncertainVector) -> (Home, UncertainVector) {
        let candidate = |home: Home, key: VoxelKey| {
            let local = self.local(key, point);
            let distance = self.moments(home).expected_squared_distance(&local).unwrap_or(f64::INFINITY);
            (distance, home, local)
        };
        let mut best = candidate(own, key);
        for dx in -1..=1 {
            for dy in -1..=1 {
                for dz in -1..=1 {
                    let around = [key[0] + dx, key[1] + dy, key[2] + dz];
                    if let Some(home) = self.home_of(around) {
                        let other = candidate(home, around);
                        if other.0 < best.0 {
                            best = other;
                        }
                    }
                }
            }
        }
        (best.1, best.2)
    }
}
