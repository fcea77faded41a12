//! Two axes on a plane.

use serde::Serialize;
use terrace_types::Plane;

use crate::ExtentError;

/// A right-handed frame on a plane: coordinates `(u, v)` in metres along two unit axes, from an origin on the plane.
///
/// The first axis is the world axis that is least aligned with the normal, projected into the plane (the first of
/// them where two are equal); the second is `normal × first`. So the same plane always has the same axes, a floor has
/// those of the world, and a polygon that runs counter-clockwise in the frame does so seen from where the normal
/// points.
///
/// ```
/// use terrace_extent::PlaneFrame;
/// use terrace_types::Plane;
///
/// let table = Plane::through([0.0, 0.0, 0.7], [0.0, 0.0, 1.0])?;
/// let frame = PlaneFrame::new(&table, [2.0, 3.0, 0.0])?;
/// assert_eq!(frame.origin(), [2.0, 3.0, 0.7]);
/// assert_eq!(frame.to_plane([2.5, 3.0, 0.71]), [0.5, 0.0]);
/// assert_eq!(frame.to_world([0.5, 1.0]), [2.5, 4.0, 0.7]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PlaneFrame {
    origin: [f64; 3],
    axes: [[f64; 3]; 2],
    normal: [f64; 3],
}

impl PlaneFrame {
    /// The frame whose origin is `reference`, in metres, dropped onto the plane. A reference near the points of the
    /// plane, such as their mean, keeps their coordinates small.
    ///
    /// # Errors
    /// [`ExtentError::PointNotFinite`] when the reference or its foot on the plane is not finite.
    pub fn new(plane: &Plane, reference: [f64; 3]) -> Result<Self, ExtentError> {
        let normal = plane.normal();
        let distance = plane.signed_distance(reference);
        let origin = [0, 1, 2].map(|i| reference[i] - distance * normal[i]);
        if !origin.iter().all(|x| x.is_finite()) {
            return Err(ExtentError::PointNotFinite { point: reference });
        }
        let least = (1..3).fold(0, |least, i| if normal[i].abs() < normal[least].abs() { i } else { least });
        let mut first = normal.map(|x| -normal[least] * x);
        first[least] += 1.0;
        let length = dot(first, first).sqrt();
        // At least √(2/3): the normal has length 1 and this is its smallest part.
        let first = first.map(|x| x / length);
        Ok(Self { origin, axes: [first, cross(normal, first)], normal })
    }

    /// Where `(0, 0)` is in the world, in metres.
    pub fn origin(&self) -> [f64; 3] {
        self.origin
    }

    /// The unit vectors along u and v, in the world.
    pub fn axes(&self) -> [[f64; 3]; 2] {
        self.axes
    }

    /// The unit normal of the plane, `u × v`.
    pub fn normal(&self) -> [f64; 3] {
        self.normal
    }

    /// The coordinates `(u, v)`, in metres, of the foot of a point of the world on the plane.
    pub fn to_plane(&self, point: [f64; 3]) -> [f64; 2] {
        let from_origin = [0, 1, 2].map(|i| point[i] - self.origin[i]);
        self.axes.map(|axis| dot(axis, from_origin))
    }

    /// The point of the world, in metres, at `(u, v)`.
    pub fn to_world(&self, [u, v]: [f64; 2]) -> [f64; 3] {
        let [first, second] = self.axes;
        [0, 1, 2].map(|i| self.origin[i] + u * first[i] + v * second[i])
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
