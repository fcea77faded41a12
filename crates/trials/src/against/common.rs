//! Planes near one plane, in parameters that they have in common.

use glam::{DMat3, DVec3};
use terrace::{ExtractedPlane, PlaneEstimate};

/// A frame on a plane.
#[derive(Debug, Clone, Copy)]
pub(super) struct Common {
    origin: DVec3,
    normal: DVec3,
    axes: [DVec3; 2],
}

/// Two tilts and the height over the origin of a plane near that of the frame, with their covariance.
#[derive(Debug, Clone, Copy)]
pub(super) struct Seen {
    pub(super) at: DVec3,
    pub(super) covariance: DMat3,
}

impl Common {
    pub(super) fn of(plane: &ExtractedPlane) -> Self {
        let normal = DVec3::from(plane.plane.normal());
        let (u, v) = normal.any_orthonormal_pair();
        Self { origin: plane.centroid.into(), normal, axes: [u, v] }
    }

    /// Between the normals, whichever side they point to, in radians.
    pub(super) fn angle(&self, estimate: &PlaneEstimate) -> f64 {
        let normal = DVec3::from(estimate.plane.normal());
        normal.cross(self.normal).length().atan2(normal.dot(self.normal).abs())
    }

    /// `(e₁ᵀn, e₂ᵀn, −nᵀ(x₀ − c))` for a plane through `c` with normal `n`, and its covariance to first order, `J C Jᵀ`. Far from
    /// the place where the estimate is, its tilts carry the height along.
    pub(super) fn seen(&self, estimate: &PlaneEstimate) -> Seen {
        let normal = DVec3::from(estimate.plane.normal());
        let normal = if normal.dot(self.normal) < 0.0 { -normal } else { normal };
        // Relative to the estimate: in coordinates of 10⁷ m the coefficients have fewer digits left.
        let arm = self.origin - DVec3::from(estimate.centroid);
        let of = |direction: DVec3, height: f64| {
            DVec3::new(self.axes[0].dot(direction), self.axes[1].dot(direction), height)
        };
        let [first, second] = estimate.axes.map(|axis| {
            let axis = DVec3::from(axis);
            of(axis, -axis.dot(arm))
        });
        // The covariance is that of the normal turned round as well.
        let jacobian = DMat3::from_cols(first, second, DVec3::Z);
        let c = DMat3::from_cols_array_2d(&estimate.tilt_offset);
        Seen { at: of(normal, -normal.dot(arm)), covariance: jacobian * c * jacobian.transpose() }
    }

    /// Distance from the origin to the place of an estimate, along the plane, in metres.
    pub(super) fn distance(&self, estimate: &PlaneEstimate) -> f64 {
        (self.origin - DVec3::from(estimate.centroid)).reject_from(self.normal).length()
    }
}

/// The inverse of a covariance, by way of the correlations: units do not matter. `None` where there is none.
pub(super) fn inverse(covariance: DMat3) -> Option<DMat3> {
    let deviations = DVec3::new(covariance.x_axis.x, covariance.y_axis.y, covariance.z_axis.z).map(f64::sqrt);
    if !(deviations.is_finite() && deviations.min_element() > 0.0) {
        return None;
    }
    let scale = DMat3::from_diagonal(deviations.recip());
    let correlations = scale * covariance * scale;
    // That of the identity is 1, and rounding alone is left well below this.
    let determinant = correlations.determinant();
    if determinant.is_nan() || determinant <= 1e-14 {
        return None;
    }
    let inverse = scale * correlations.inverse() * scale;
    inverse.is_finite().then_some(inverse)
}
