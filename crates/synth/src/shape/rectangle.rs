//! A rectangle, possibly with rectangular holes; six of them make a box.

use super::{NEAREST, Ray};
use crate::vector::{Vec3, add_scaled, cross, dot, length, sub};

#[derive(Debug, Clone)]
pub(crate) struct Rectangle {
    corner: Vec3,
    u: Vec3,
    v: Vec3,
    normal: Vec3,
    size: [f64; 2],
    holes: Vec<[[f64; 2]; 2]>,
}

impl Rectangle {
    /// Spanned from a corner by two perpendicular edges; its normal is their cross product.
    pub(crate) fn new(corner: Vec3, edge_u: Vec3, edge_v: Vec3) -> Self {
        let size = [length(edge_u), length(edge_v)];
        let (u, v) = (edge_u.map(|x| x / size[0]), edge_v.map(|x| x / size[1]));
        Self { corner, u, v, normal: cross(u, v), size, holes: Vec::new() }
    }

    /// Cuts away `u0..u1` along the first edge times `v0..v1` along the second, in metres from the corner.
    pub(crate) fn with_hole(mut self, u: [f64; 2], v: [f64; 2]) -> Self {
        self.holes.push([u, v]);
        self
    }

    pub(crate) fn corner(&self) -> Vec3 {
        self.corner
    }

    pub(crate) fn normal(&self) -> Vec3 {
        self.normal
    }

    /// Area between the outer edges, holes not taken off.
    pub(crate) fn area(&self) -> f64 {
        self.size[0] * self.size[1]
    }

    /// The point at shares `a` and `b` of the two edges.
    pub(crate) fn at(&self, a: f64, b: f64) -> Vec3 {
        add_scaled(add_scaled(self.corner, a * self.size[0], self.u), b * self.size[1], self.v)
    }

    pub(super) fn intersect(&self, ray: &Ray) -> Option<f64> {
        let slope = dot(ray.direction, self.normal);
        // A ray within the plane sees an edge without area.
        if slope.abs() < 1e-12 {
            return None;
        }
        let distance = dot(sub(self.corner, ray.origin), self.normal) / slope;
        (distance > NEAREST && self.covers(ray.at(distance))).then_some(distance)
    }

    /// Whether a point of the plane is on the rectangle: within its closed border and not inside a hole.
    pub(crate) fn covers(&self, point: Vec3) -> bool {
        let p = sub(point, self.corner);
        let [s, t] = [dot(p, self.u), dot(p, self.v)];
        (0.0..=self.size[0]).contains(&s)
            && (0.0..=self.size[1]).contains(&t)
            && !self.holes.iter().any(|[u, v]| s > u[0] && s < u[1] && t > v[0] && t < v[1])
    }

    /// The six faces of an axis-parallel box with normals outward, in the order −x, +x, −y, +y, −z, +z.
    pub(crate) fn faces_of_box(min: Vec3, max: Vec3) -> [Self; 6] {
        let [x, y, z] = sub(max, min);
        let (ex, ey, ez) = ([x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]);
        [
            Self::new(min, ez, ey),
            Self::new([max[0], min[1], min[2]], ey, ez),
            Self::new(min, ex, ez),
            Self::new([min[0], max[1], min[2]], ez, ex),
            Self::new(min, ey, ex),
            Self::new([min[0], min[1], max[2]], ex, ey),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_pass_through_holes_and_beside_the_rectangle() {
        let wall = Rectangle::new([0.0, 2.0, 0.0], [0.0, 0.0, 3.0], [5.0, 0.0, 0.0])
            .with_hole([0.0, 2.0], [1.0, 2.0]);
        let from = |x, z| Ray { origin: [x, 0.0, z], direction: [0.0, 1.0, 0.0] };
        let hit = |x, z| wall.intersect(&from(x, z));
        assert_eq!(hit(0.5, 1.0), Some(2.0));
        assert_eq!(hit(1.5, 1.0), None);
        assert_eq!(hit(1.5, 2.5), Some(2.0));
        assert_eq!(hit(5.5, 1.0), None);
        assert_eq!(wall.intersect(&Ray { origin: [0.5, 3.0, 1.0], direction: [0.0, 1.0, 0.0] }), None);
        assert_eq!(wall.intersect(&Ray { origin: [-1.0, 2.0, 1.0], direction: [1.0, 0.0, 0.0] }), None);
    }

    #[test]
    fn the_faces_of_a_box_look_outward_and_carry_its_area() {
        let (min, max) = ([1.0, 2.0, 3.0], [2.0, 4.0, 6.0]);
        let centre = [1.5, 3.0, 4.5];
        let faces = Rectangle::faces_of_box(min, max);
        for (i, face) in faces.iter().enumerate() {
            let outward = if i % 2 == 0 { -1.0 } else { 1.0 };
            assert!((face.normal()[i / 2] - outward).abs() < 1e-15);
            assert!(dot(sub(face.at(0.5, 0.5), centre), face.normal()) > 0.0);
        }
        let area: f64 = faces.iter().map(Rectangle::area).sum();
        assert!((area - 22.0).abs() < 1e-12);
    }
}
