//! The side of a circular cylinder, without its end discs.

use super::{Ray, first_root};
use crate::vector::{Vec3, add_scaled, dot, length, sub};

#[derive(Debug, Clone)]
pub(crate) struct Cylinder {
    base: Vec3,
    axis: Vec3,
    height: f64,
    radius: f64,
}

impl Cylinder {
    /// Around the segment from `base` to `top`.
    pub(crate) fn between(base: Vec3, top: Vec3, radius: f64) -> Self {
        let height = length(sub(top, base));
        Self { base, axis: sub(top, base).map(|x| x / height), height, radius }
    }

    /// The sphere's quadratic in the plane across the axis; a root counts when it lies between the ends.
    pub(super) fn intersect(&self, ray: &Ray) -> Option<f64> {
        let o = sub(ray.origin, self.base);
        let (o_along, d_along) = (dot(o, self.axis), dot(ray.direction, self.axis));
        let o_across = add_scaled(o, -o_along, self.axis);
        let d_across = add_scaled(ray.direction, -d_along, self.axis);
        let a = dot(d_across, d_across);
        // A ray along the axis never crosses the side.
        if a < 1e-24 {
            return None;
        }
        let b = dot(o_across, d_across) / a;
        let c = (dot(o_across, o_across) - self.radius * self.radius) / a;
        first_root(b, c, |t| (0.0..=self.height).contains(&(o_along + t * d_along)))
    }

    /// Height above the base and distance from the axis.
    #[cfg(test)]
    pub(super) fn along_and_across(&self, point: Vec3) -> [f64; 2] {
        let p = sub(point, self.base);
        let along = dot(p, self.axis);
        [along, length(add_scaled(p, -along, self.axis))]
    }

    /// Distance from the side, which is endless here.
    #[cfg(test)]
    pub(crate) fn off_side(&self, point: Vec3) -> f64 {
        (self.along_and_across(point)[1] - self.radius).abs()
    }

    /// Whether the point lies inside by more than a margin.
    #[cfg(test)]
    pub(super) fn encloses(&self, point: Vec3, margin: f64) -> bool {
        let [along, across] = self.along_and_across(point);
        along > margin && along < self.height - margin && across < self.radius - margin
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_hit_the_side_between_the_ends_only() {
        let cylinder = Cylinder::between([0.0, 0.0, 1.0], [0.0, 0.0, 3.0], 0.5);
        let across = |z| Ray { origin: [-2.0, 0.0, z], direction: [1.0, 0.0, 0.0] };
        assert_eq!(cylinder.intersect(&across(2.0)), Some(1.5));
        assert_eq!(cylinder.intersect(&across(0.5)), None);
        assert_eq!(cylinder.intersect(&across(3.5)), None);
        // Along the axis, inside and outside.
        assert_eq!(cylinder.intersect(&Ray { origin: [0.0; 3], direction: [0.0, 0.0, 1.0] }), None);
        // Over the near rim onto the inner side.
        let s = std::f64::consts::FRAC_1_SQRT_2;
        let over = cylinder.intersect(&Ray { origin: [-1.0, 0.0, 3.7], direction: [s, 0.0, -s] });
        assert!((over.unwrap() - 1.5 / s).abs() < 1e-12);
    }
}
