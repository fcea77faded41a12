//! The shapes buildings are made of, and where rays meet them.

mod cylinder;
mod rectangle;
mod sphere;

pub(crate) use cylinder::Cylinder;
pub(crate) use rectangle::Rectangle;
pub(crate) use sphere::Sphere;

use crate::vector::{Vec3, add_scaled};

/// A half line. The direction has unit length, so that distances along it are metres.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ray {
    pub(crate) origin: Vec3,
    pub(crate) direction: Vec3,
}

impl Ray {
    pub(crate) fn at(&self, distance: f64) -> Vec3 {
        add_scaled(self.origin, distance, self.direction)
    }
}

/// Distances below this are the surface the ray starts on.
pub(crate) const NEAREST: f64 = 1e-9;

/// A surface that rays can meet from either side.
#[derive(Debug, Clone)]
pub(crate) enum Shape {
    Rectangle(Rectangle),
    Sphere(Sphere),
    Cylinder(Cylinder),
}

impl Shape {
    /// Distance along the ray to the first point of the surface beyond [`NEAREST`].
    pub(crate) fn intersect(&self, ray: &Ray) -> Option<f64> {
        match self {
            Self::Rectangle(shape) => shape.intersect(ray),
            Self::Sphere(shape) => shape.intersect(ray),
            Self::Cylinder(shape) => shape.intersect(ray),
        }
    }

    /// Whether a curved shape has the point inside it by more than a margin.
    #[cfg(test)]
    pub(crate) fn encloses(&self, point: Vec3, margin: f64) -> bool {
        match self {
            Self::Rectangle(_) => false,
            Self::Sphere(s) => crate::vector::length(crate::vector::sub(point, s.centre)) < s.radius - margin,
            Self::Cylinder(shape) => shape.encloses(point, margin),
        }
    }
}

/// The smaller root of t² + 2 b t + c beyond [`NEAREST`] that `accept` takes, or else the larger one.
fn first_root(b: f64, c: f64, accept: impl Fn(f64) -> bool) -> Option<f64> {
    let discriminant = b * b - c;
    if discriminant < 0.0 {
        return None;
    }
    let root = discriminant.sqrt();
    [-b - root, -b + root].into_iter().find(|t| *t > NEAREST && accept(*t))
}
