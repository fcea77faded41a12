//! An infinite plane in Hesse normal form.

use crate::vector::{direction, dot};

/// A plane `a x + b y + c z + d = 0` with unit normal `(a, b, c)` and `d` in metres.
///
/// ```
/// use terrace_types::Plane;
///
/// let floor = Plane::through([5.0, 5.0, 1.0], [0.0, 0.0, 2.0])?;
/// assert_eq!(floor.coefficients(), [0.0, 0.0, 1.0, -1.0]);
/// assert_eq!(floor.signed_distance([0.0, 0.0, 3.0]), 2.0);
/// # Ok::<(), terrace_types::PlaneError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    normal: [f64; 3],
    d: f64,
}

/// Why no plane could be made.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum PlaneError {
    /// The normal is zero (or subnormal) along every axis, or not finite. Its length does not matter otherwise.
    #[error("the normal ({}, {}, {}) has no direction", normal[0], normal[1], normal[2])]
    NoDirection {
        /// The normal as given.
        normal: [f64; 3],
    },
    /// The point on the plane is not finite, or so far away that its distance from the origin is not.
    #[error("the point ({}, {}, {}) on the plane is not within a finite distance", point[0], point[1], point[2])]
    PointNotFinite {
        /// The point as given.
        point: [f64; 3],
    },
}

impl Plane {
    /// The plane through `point` with this normal, which need not be of unit length.
    ///
    /// # Errors
    /// [`PlaneError`] when the normal has no direction or the point is not finite.
    pub fn through(point: [f64; 3], normal: [f64; 3]) -> Result<Self, PlaneError> {
        let normal = direction(normal).ok_or(PlaneError::NoDirection { normal })?;
        let d = -dot(normal, point);
        if d.is_finite() { Ok(Self { normal, d }) } else { Err(PlaneError::PointNotFinite { point }) }
    }

    /// The unit normal `(a, b, c)`.
    pub fn normal(&self) -> [f64; 3] {
        self.normal
    }

    /// The offset `d`, in metres: minus the distance of the plane from the origin along the normal.
    pub fn d(&self) -> f64 {
        self.d
    }

    /// `[a, b, c, d]`.
    pub fn coefficients(&self) -> [f64; 4] {
        let [a, b, c] = self.normal;
        [a, b, c, self.d]
    }

    /// Distance of `point` from the plane in metres, positive on the side the normal points to.
    pub fn signed_distance(&self, point: [f64; 3]) -> f64 {
        dot(self.normal, point) + self.d
    }

    /// The same plane with its normal turned round.
    #[must_use]
    pub fn flipped(&self) -> Self {
        Self { normal: self.normal.map(|x| -x), d: -self.d }
    }
}
