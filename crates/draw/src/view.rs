//! From where a cloud is looked at.

use crate::error::DrawError;

type Vec3 = [f64; 3];

/// A box around a cloud, in metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    min: Vec3,
    max: Vec3,
}

impl Bounds {
    /// From the lower to the upper corner.
    ///
    /// # Errors
    /// [`DrawError::Bounds`] when a bound is not finite or a lower one above the upper one.
    pub fn new(min: Vec3, max: Vec3) -> Result<Self, DrawError> {
        let finite = min.iter().chain(&max).all(|x| x.is_finite());
        if finite && min.iter().zip(&max).all(|(a, b)| a <= b) {
            Ok(Self { min, max })
        } else {
            Err(DrawError::Bounds { min, max })
        }
    }

    /// The smallest box around the finite points; `None` when there are none.
    ///
    /// ```
    /// use terrace_draw::Bounds;
    ///
    /// let bounds = Bounds::of([[1.0, 2.0, 3.0], [0.0, 4.0, 3.0], [f64::NAN; 3]]).unwrap();
    /// assert_eq!(bounds, Bounds::new([0.0, 2.0, 3.0], [1.0, 4.0, 3.0])?);
    /// # Ok::<(), terrace_draw::DrawError>(())
    /// ```
    pub fn of(points: impl IntoIterator<Item = Vec3>) -> Option<Self> {
        points.into_iter().filter(|p| p.iter().all(|x| x.is_finite())).fold(None, |bounds, p| {
            let Self { min, max } = bounds.unwrap_or(Self { min: p, max: p });
            Some(Self { min: [0, 1, 2].map(|i| min[i].min(p[i])), max: [0, 1, 2].map(|i| max[i].max(p[i])) })
        })
    }

    /// The lower corner.
    pub fn min(&self) -> Vec3 {
        self.min
    }

    /// The upper corner.
    pub fn max(&self) -> Vec3 {
        self.max
    }

    /// The middle; halves are added so that the sum cannot overflow.
    pub(crate) fn centre(&self) -> Vec3 {
        [0, 1, 2].map(|i| self.min[i] / 2.0 + self.max[i] / 2.0)
    }

    /// The part of the box below a height, when up is along z; other boxes stay as they are.
    pub(crate) fn below(&self, up: Vec3, height: f64) -> Self {
        let mut part = *self;
        if up[2] > 1.0 - 1e-12 && height < self.max[2] {
            part.max[2] = height.max(self.min[2]);
        }
        part
    }

    pub(crate) fn corners(&self) -> [Vec3; 8] {
        [0, 1, 2, 3, 4, 5, 6, 7]
            .map(|k: usize| [0, 1, 2].map(|i| if (k >> i) & 1 == 0 { self.min[i] } else { self.max[i] }))
    }
}

/// A direction of view around the centre of the bounds, from a fixed distance chosen so that all is seen.
///
/// The azimuth turns the eye about the up direction: at 0 it stands on the +x side, at 90 degrees on the +y side. The
/// elevation lifts it above the horizon.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    azimuth: f64,
    elevation: f64,
    up: Vec3,
    /// Full angle of view in radians; `None` for parallel rays.
    angle: Option<f64>,
}

impl View {
    /// Parallel rays from an azimuth and an elevation in degrees; z is up.
    ///
    /// # Errors
    /// [`DrawError::Angle`] when one is not finite.
    pub fn from_degrees(azimuth: f64, elevation: f64) -> Result<Self, DrawError> {
        let [azimuth, elevation] = [azimuth, elevation].map(f64::to_radians);
        match [azimuth, elevation].into_iter().find(|a| !a.is_finite()) {
            Some(radians) => Err(DrawError::Angle { radians }),
            None => Ok(Self { azimuth, elevation, up: [0.0, 0.0, 1.0], angle: None }),
        }
    }

    /// The same view in perspective, with this full angle of view in degrees.
    ///
    /// # Errors
    /// [`DrawError::Angle`] unless it lies above 0 and below 180.
    pub fn with_perspective_degrees(self, angle: f64) -> Result<Self, DrawError> {
        if angle > 0.0 && angle < 180.0 {
            Ok(Self { angle: Some(angle.to_radians()), ..self })
        } else {
            Err(DrawError::Angle { radians: angle.to_radians() })
        }
    }

    /// The same view with another direction up, such as −y for the points of a camera.
    ///
    /// # Errors
    /// [`DrawError::Up`] when the direction is zero or not finite.
    pub fn with_up(self, up: Vec3) -> Result<Self, DrawError> {
        let length = dot(up, up).sqrt();
        if length.is_normal() {
            Ok(Self { up: up.map(|x| x / length), ..self })
        } else {
            Err(DrawError::Up { up })
        }
    }

    /// Whether a surface with this normal faces the eye (for parallel rays; nearly so in perspective).
    ///
    /// A scan of a room is seen from outside as a box. With the points of those planes left out that do not face the eye,
    /// their normals being turned to the sensor, it opens like a doll's house.
    ///
    /// ```
    /// use terrace_draw::View;
    ///
    /// let from_above = View::from_degrees(30.0, 60.0)?;
    /// assert!(from_above.faces([0.0, 0.0, 1.0]) && !from_above.faces([0.0, 0.0, -1.0]));
    /// # Ok::<(), terrace_draw::DrawError>(())
    /// ```
    pub fn faces(&self, normal: [f64; 3]) -> bool {
        let [_, _, toward_eye] = self.axes();
        dot(normal, toward_eye) > 0.0
    }

    pub(crate) fn up(&self) -> Vec3 {
        self.up
    }

    /// Right, up and toward the eye, as unit vectors.
    fn axes(&self) -> [Vec3; 3] {
        // With z up these are x and y; other directions up take the shortest turn there from z.
        let [east, north] = level_axes(self.up);
        let (sin_a, cos_a) = self.azimuth.sin_cos();
        let (sin_e, cos_e) = self.elevation.sin_cos();
        let level = [0, 1, 2].map(|i| cos_a * east[i] + sin_a * north[i]);
        let right = [0, 1, 2].map(|i| cos_a * north[i] - sin_a * east[i]);
        let toward_eye = [0, 1, 2].map(|i| cos_e * level[i] + sin_e * self.up[i]);
        let above = [0, 1, 2].map(|i| cos_e * self.up[i] - sin_e * level[i]);
        [right, above, toward_eye]
    }
}

/// Two perpendicular directions of the horizon: x and y turned with z into `up`.
fn level_axes(up: Vec3) -> [Vec3; 2] {
    let [a, b, c] = up;
    if c < -1.0 + 1e-9 {
        // Straight down: half a turn about x.
        return [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0]];
    }
    let k = 1.0 / (1.0 + c);
    [[1.0 - a * a * k, -a * b * k, -a], [-a * b * k, 1.0 - b * b * k, -b]]
}

/// Takes points to places in the picture.
#[derive(Debug, Clone)]
pub(crate) struct Projection {
    centre: Vec3,
    axes: [Vec3; 3],
    /// Distance of the eye from the centre; `None` for parallel rays.
    eye: Option<f64>,
    /// Pixels per metre, at the centre in perspective.
    scale: f64,
    middle: [f64; 2],
}

/// Share of the picture that the bounds fill at most.
const FILL: f64 = 0.94;

impl Projection {
    /// Fits the bounds into `width` × `height` pixels below `top` free ones.
    pub(crate) fn new(view: &View, bounds: &Bounds, width: usize, height: usize, top: usize) -> Self {
        let axes = view.axes();
        let centre = bounds.centre();
        let corners = bounds.corners().map(|c| {
            let d = [0, 1, 2].map(|i| c[i] - centre[i]);
            axes.map(|axis| dot(axis, d))
        });
        let room = [width as f64, height.saturating_sub(top).max(1) as f64].map(|side| side * FILL);
        let eye = view.angle.map(|angle| {
            // The eye is as near as it can be with every corner within the cone: |x| ≤ (eye − z) tan(angle / 2).
            let tangent = (angle / 2.0).tan();
            corners
                .iter()
                .map(|c| c[2] + c[0].abs().max(c[1].abs()) / tangent)
                .fold(f64::MIN_POSITIVE, f64::max)
        });
        // Where the corners appear at one pixel per metre; they are moved to the middle of the picture.
        let span = |i: usize| {
            let seen =
                corners.iter().map(|c| c[i] * eye.map_or(1.0, |eye| eye / (eye - c[2]).max(eye * 1e-6)));
            seen.fold([f64::MAX, -f64::MAX], |[low, high], x| [low.min(x), high.max(x)])
        };
        let spans = [span(0), span(1)];
        let scale = (room[0] / (spans[0][1] - spans[0][0])).min(room[1] / (spans[1][1] - spans[1][0]));
        // Bounds without extent, or with more than can be divided by, are drawn at one pixel per metre.
        let scale = if scale.is_finite() && scale > 0.0 { scale } else { 1.0 };
        let sheet = [width as f64 / 2.0, f64::midpoint(height as f64, top.min(height) as f64)];
        let off = spans.map(|[low, high]| scale * f64::midpoint(low, high));
        let middle = [sheet[0] - off[0], sheet[1] + off[1]];
        Self { centre, axes, eye, scale, middle }
    }

    /// Column, row and depth (metres away from the eye, from an arbitrary zero) of a point; `None` behind the eye and
    /// for points that are not finite.
    pub(crate) fn project(&self, point: Vec3) -> Option<Vec3> {
        let d = [0, 1, 2].map(|i| point[i] - self.centre[i]);
        let [x, y, z] = self.axes.map(|axis| dot(axis, d));
        let zoom = match self.eye {
            None => self.scale,
            Some(eye) if eye > z => self.scale * eye / (eye - z),
            Some(_) => return None,
        };
        let place = [self.middle[0] + zoom * x, self.middle[1] - zoom * y, -z];
        place.iter().all(|x| x.is_finite()).then_some(place)
    }

    /// Metres per pixel at the centre.
    #[expect(clippy::cast_possible_truncation, reason = "a scale for shading")]
    pub(crate) fn pixel(&self) -> f32 {
        (1.0 / self.scale) as f32
    }
}

fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
