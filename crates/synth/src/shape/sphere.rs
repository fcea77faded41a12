//! A sphere.

use super::{Ray, first_root};
use crate::vector::{Vec3, dot, sub};

#[derive(Debug, Clone)]
pub(crate) struct Sphere {
    pub(crate) centre: Vec3,
    pub(crate) radius: f64,
}

impl Sphere {
    /// |o + t d − c|² = r², a quadratic in t with leading coefficient 1.
    pub(super) fn intersect(&self, ray: &Ray) -> Option<f64> {
        let o = sub(ray.origin, self.centre);
        first_root(dot(o, ray.direction), dot(o, o) - self.radius * self.radius, |_| true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_through_the_centre_hits_at_the_near_side_and_from_inside_at_the_far_side() {
        let sphere = Sphere { centre: [0.0, 0.0, 5.0], radius: 2.0 };
        let ray = |z| Ray { origin: [0.0, 0.0, z], direction: [0.0, 0.0, 1.0] };
        assert_eq!(sphere.intersect(&ray(0.0)), Some(3.0));
        assert_eq!(sphere.intersect(&ray(5.0)), Some(2.0));
        assert_eq!(sphere.intersect(&ray(8.0)), None);
        assert_eq!(sphere.intersect(&Ray { origin: [2.1, 0.0, 0.0], direction: [0.0, 0.0, 1.0] }), None);
    }
}
