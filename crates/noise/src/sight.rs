//! How a sensor saw a point.

use std::f64::consts::FRAC_PI_2;

use crate::vector::{difference, direction, dot};

/// How a sensor saw a point: the ray, the range, and, when known, the optical axis and the incidence angle.
///
/// ```
/// use terrace_noise::Sight;
///
/// let sight = Sight::new([0.0, 0.0, 1.0], [3.0, 0.0, 5.0]).unwrap();
/// assert_eq!((sight.range(), sight.depth()), (5.0, 5.0));
/// // A camera that looks along z measures depth along z.
/// let sight = sight.with_axis([0.0, 0.0, 2.0]).unwrap();
/// assert!((sight.depth() - 4.0).abs() < 1e-15);
/// assert!(Sight::new([1.0; 3], [1.0; 3]).is_none(), "no ray leads from a place to itself");
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sight {
    ray: [f64; 3],
    range: f64,
    axis: Option<[f64; 3]>,
    incidence: Option<f64>,
}

impl Sight {
    /// From the position of the sensor and that of the point, in metres, in the same frame.
    ///
    /// `None` when a coordinate or the distance is not finite, and when the point is at the sensor.
    pub fn new(sensor: [f64; 3], point: [f64; 3]) -> Option<Self> {
        let (ray, range) = direction(difference(point, sensor))?;
        Some(Self { ray, range, axis: None, incidence: None })
    }

    /// The same sight by a camera with this optical axis (any length, from the camera into the scene).
    ///
    /// `None` when the axis is zero or not finite.
    #[must_use = "the sight with the axis is returned"]
    pub fn with_axis(self, axis: [f64; 3]) -> Option<Self> {
        let (axis, _) = direction(axis)?;
        Some(self.with_unit_axis(axis))
    }

    /// The same sight by a camera with this optical axis, of length 1.
    pub(crate) fn with_unit_axis(self, axis: [f64; 3]) -> Self {
        Self { axis: Some(axis), ..self }
    }

    /// The same sight of a surface at this angle, in radians, between the ray and the normal of the surface.
    ///
    /// `None` when the angle is not within 0 and π/2.
    #[must_use = "the sight with the angle is returned"]
    pub fn with_incidence(self, incidence: f64) -> Option<Self> {
        (0.0..=FRAC_PI_2).contains(&incidence).then_some(Self { incidence: Some(incidence), ..self })
    }

    /// The same sight of a surface with this normal (any length, either side).
    ///
    /// `None` when the normal is zero or not finite.
    #[must_use = "the sight with the angle is returned"]
    pub fn with_normal(self, normal: [f64; 3]) -> Option<Self> {
        let (normal, _) = direction(normal)?;
        let cosine = dot(normal, self.ray).abs().min(1.0);
        Some(Self { incidence: Some(cosine.acos()), ..self })
    }

    /// The viewing ray, of length 1, from the sensor to the point.
    pub fn ray(&self) -> [f64; 3] {
        self.ray
    }

    /// The straight distance from the sensor to the point, in metres.
    pub fn range(&self) -> f64 {
        self.range
    }

    /// The optical axis, of length 1.
    pub fn axis(&self) -> Option<[f64; 3]> {
        self.axis
    }

    /// The angle between the ray and the normal of the surface, in radians, from 0 to π/2.
    pub fn incidence(&self) -> Option<f64> {
        self.incidence
    }

    /// The distance along the optical axis, in metres: negative behind the camera. Without an axis it is the range, as
    /// if the point were in the middle of the image.
    pub fn depth(&self) -> f64 {
        self.axis.map_or(self.range, |axis| self.range * dot(self.ray, axis))
    }
}
