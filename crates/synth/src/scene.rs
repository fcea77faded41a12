//! A building with known planes, and the places from which it is scanned.

use crate::build::Surface;
use crate::chunks::Chunks;
use crate::kind::SceneKind;
use crate::params::{Params, SynthError};
use crate::scenes;
use crate::sensor::{Sensor, View};
use crate::shape::Ray;
use crate::synthetic::Synthetic;
use crate::vector::{Vec3, add_scaled};
use std::num::NonZeroU16;
use terrace_types::{Plane, PlaneId, Pose};

/// A plane of a scene, as built.
#[derive(Debug, Clone, PartialEq)]
pub struct ScenePlane {
    /// Its identity in the labels.
    pub id: PlaneId,
    /// What it is, in English.
    pub name: &'static str,
    /// Where it is in the world; the normal points to the side from which it is seen.
    pub plane: Plane,
}

/// A place with known planes that can be scanned with any number of points.
///
/// See the [crate page](crate) for an example.
#[derive(Debug, Clone)]
pub struct Scene {
    pub(crate) kind: SceneKind,
    /// What rays can meet: of several equal rooms those of the first, in whose place every view is cast.
    pub(crate) surfaces: Vec<Surface>,
    pub(crate) planes: Vec<ScenePlane>,
    pub(crate) views: Vec<View>,
    /// From the building to the world.
    pub(crate) placement: Pose,
    /// Where there is no sensor: the standard error in metres at the start and at the end of the first side of every
    /// rectangle, and evenly between them.
    pub(crate) white_noise: [f64; 2],
}

/// Where a ray ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Hit {
    pub(crate) distance: f64,
    pub(crate) plane: Option<PlaneId>,
}

impl Scene {
    /// The scene of this kind, as large as its usual number of points fills.
    pub fn new(kind: SceneKind) -> Self {
        Self::sized(kind, kind.default_points())
    }

    /// The scene of this kind, as large as this many points fill: a building has a room for every
    /// [`POINTS_PER_ROOM`](crate::POINTS_PER_ROOM) of them, to the nearest whole number; the others have a size of their own.
    ///
    /// ```
    /// use terrace_synth::{Scene, SceneKind};
    ///
    /// let room = Scene::room().planes().len();
    /// assert_eq!(Scene::sized(SceneKind::Building, 1_000_000).planes().len(), 10 * room);
    /// assert_eq!(Scene::sized(SceneKind::Room, 1_000_000).planes().len(), room);
    /// ```
    pub fn sized(kind: SceneKind, points: usize) -> Self {
        match kind {
            SceneKind::Table => Self::table(),
            SceneKind::Desk => Self::desk(),
            SceneKind::Strip => Self::strip(),
            SceneKind::Patch => Self::patch(),
            SceneKind::Room => Self::room(),
            SceneKind::Building => Self::building(scenes::rooms_for(points)),
            SceneKind::Corridor => Self::corridor(),
        }
    }

    /// A top of 1.2 × 1.0 m and two side panels 0.75 m high that meet it and each other along edges, the whole turned
    /// so that no plane is parallel to an axis. Points are spread evenly over the area and moved by noise of the
    /// same size along every axis, 1 cm unless chosen; the place of a sensor is not known.
    pub fn table() -> Self {
        scenes::table()
    }

    /// A board of 1.2 × 0.8 m at a height of 0.75 m on two side panels that end 4 cm below its surface and 10 cm inside
    /// its ends: two orientations only, both along an axis. Points and noise as for [`Scene::table`].
    pub fn desk() -> Self {
        scenes::desk()
    }

    /// One plane of 0.9 × 0.3 m, 1.5 m from the origin and seen from there at a slant; neither it nor a side of it is
    /// parallel to an axis. Points and noise as for [`Scene::table`].
    pub fn strip() -> Self {
        scenes::strip()
    }

    /// One plane of 0.6 × 0.6 m at the place of [`Scene::strip`]. Points as for [`Scene::table`]; the noise is the same
    /// along every axis and, unless chosen, grows evenly along one side from 1 mm to 12 mm.
    pub fn patch() -> Self {
        scenes::patch()
    }

    /// A room of 5 × 4 × 2.6 m with a door recessed by 6 cm, two tables, a sideboard, a board that leans at a wall, a
    /// ball and a pillar, seen by a depth camera from fourteen places, with the noise of a Kinect along each ray.
    pub fn room() -> Self {
        scenes::room()
    }

    /// Copies of [`Scene::room`] side by side and above each other, as near to a cube as whole rooms allow: a place that
    /// grows with its rooms and is everywhere as dense. Walls are 0.3 m thick, ceilings 0.4 m, and nothing is seen from one
    /// room in another. The rooms follow each other along x, then y, then z, and so do their views and planes: those of the
    /// second room come after all of the first, with the same names.
    pub fn building(rooms: NonZeroU16) -> Self {
        scenes::building(rooms)
    }

    /// A corridor of 26 m, 2.5 m wide and 2.8 m high, with a right-angled bend, eight doors in niches of different
    /// depth and two pipes, scanned by a lidar from a place every 1.5 m, with 2 cm of noise along each ray.
    pub fn corridor() -> Self {
        scenes::corridor()
    }

    /// Which scene this is.
    pub fn kind(&self) -> SceneKind {
        self.kind
    }

    /// The true planes, by identity.
    pub fn planes(&self) -> &[ScenePlane] {
        &self.planes
    }

    /// The optical axis in the frame of the scene's sensor: +z of a depth camera. `None` for a lidar, which has none, and
    /// for scenes without a sensor.
    pub fn optical_axis(&self) -> Option<[f64; 3]> {
        match self.views.first()?.sensor {
            Sensor::Camera => Some([0.0, 0.0, 1.0]),
            Sensor::Lidar => None,
        }
    }

    /// The same scene moved rigidly: `world = pose · old world`. Points in the sensors' frames stay the same to the
    /// last bit; the poses of the sensors move.
    ///
    /// # Errors
    /// [`SynthError::Pose`] or [`SynthError::Plane`] when the motion leaves the range of numbers.
    pub fn transformed(&self, pose: &Pose) -> Result<Self, SynthError> {
        self.moved(|own| compose(pose, own), |point| pose.transform(point), |normal| pose.rotate(normal))
    }

    /// As [`transformed`](Self::transformed) by a translation in metres, which leaves all rotations as they are, to the bit.
    pub(crate) fn translated(&self, by: Vec3) -> Result<Self, SynthError> {
        self.moved(|own| Ok(own.translated(by)?), |point| add_scaled(point, 1.0, by), |normal| normal)
    }

    /// With each pose, and the points and normals of planes, moved so.
    fn moved(
        &self,
        pose: impl Fn(&Pose) -> Result<Pose, SynthError>,
        point: impl Fn(Vec3) -> Vec3,
        normal: impl Fn(Vec3) -> Vec3,
    ) -> Result<Self, SynthError> {
        let mut moved = self.clone();
        moved.placement = pose(&self.placement)?;
        for view in &mut moved.views {
            view.in_world = pose(&view.in_world)?;
        }
        for ScenePlane { plane, .. } in &mut moved.planes {
            let foot = plane.normal().map(|x| -plane.d() * x);
            *plane = Plane::through(point(foot), normal(plane.normal()))?;
        }
        Ok(moved)
    }

    /// Scans the scene; every view that has points becomes one scan.
    ///
    /// # Errors
    /// [`SynthError`] for parameters out of range.
    pub fn generate(&self, params: &Params) -> Result<Synthetic, SynthError> {
        let mut chunks = self.chunks(params, usize::MAX)?;
        let scans = chunks.by_ref().map(|chunk| chunk.scan).collect();
        Ok(Synthetic { scans, planes: chunks.planes() })
    }

    /// Scans the scene in pieces of at most `size` points (at least 1), in the order of [`Scene::generate`] and
    /// bit for bit the same points, so that memory stays bounded for scans of any size.
    ///
    /// # Errors
    /// [`SynthError`] for parameters out of range.
    pub fn chunks(&self, params: &Params, size: usize) -> Result<Chunks<'_>, SynthError> {
        Chunks::new(self, params, size.max(1))
    }

    /// The nearest surface along a ray of the room's frame.
    pub(crate) fn cast(&self, ray: &Ray) -> Option<Hit> {
        let mut nearest: Option<Hit> = None;
        for surface in &self.surfaces {
            if let Some(distance) = surface.shape.intersect(ray)
                && nearest.is_none_or(|hit| distance < hit.distance)
            {
                nearest = Some(Hit { distance, plane: surface.plane });
            }
        }
        nearest
    }
}

/// First `b`, then `a`.
fn compose(a: &Pose, b: &Pose) -> Result<Pose, SynthError> {
    let r = b.rotation();
    let columns = [0, 1, 2].map(|j| a.rotate([r[0][j], r[1][j], r[2][j]]));
    let rows = [0, 1, 2].map(|i| [columns[0][i], columns[1][i], columns[2][i]]);
    Ok(Pose::new(rows, a.transform(b.translation()))?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::Shape;
    use crate::vector::{length, sub, unit};
    use proptest::prelude::*;

    /// Distance of a point from the surface that the shape lies in, its borders left aside.
    fn off_surface(shape: &Shape, point: [f64; 3]) -> f64 {
        match shape {
            Shape::Rectangle(r) if r.covers(point) => {
                crate::vector::dot(sub(point, r.corner()), r.normal()).abs()
            }
            Shape::Rectangle(_) => f64::INFINITY,
            Shape::Sphere(s) => (length(sub(point, s.centre)) - s.radius).abs(),
            Shape::Cylinder(c) => c.off_side(point),
        }
    }

    proptest! {
        // Brute force: along the ray up to the hit, every surface is evaluated at many places. None may be crossed
        // before the hit, and at the hit there is one.
        #[test]
        fn rays_end_on_the_nearest_surface(
            room: bool, view in 0..14_usize, direction in prop::array::uniform3(-1.0..1.0_f64)
        ) {
            prop_assume!(length(direction) > 0.1);
            let scene = if room { Scene::room() } else { Scene::corridor() };
            let origin = scene.views[view].in_room.translation();
            let ray = Ray { origin, direction: unit(direction) };
            let hit = scene.cast(&ray).unwrap();
            let end = ray.at(hit.distance);
            prop_assert!(scene.surfaces.iter().any(|s| s.plane == hit.plane && off_surface(&s.shape, end) < 1e-9));
            let step = 0.002;
            let mut place = step;
            while place < hit.distance - step {
                for surface in &scene.surfaces {
                    // A rectangle is crossed between two places on different sides; curved surfaces are at least as
                    // thick as many steps unless they are only grazed.
                    if let Shape::Rectangle(r) = &surface.shape {
                        let side = |t: f64| crate::vector::dot(sub(ray.at(t), r.corner()), r.normal());
                        let (a, b) = (side(place), side(place + step));
                        let crossed = a * b < 0.0 && r.covers(ray.at(place + step * a / (a - b)));
                        prop_assert!(!crossed, "{place} before {}", hit.distance);
                    } else {
                        prop_assert!(!surface.shape.encloses(ray.at(place), 1e-6), "{place} before {}", hit.distance);
                    }
                }
                place += step;
            }
        }
    }

    #[test]
    fn buildings_are_closed() {
        for scene in [Scene::room(), Scene::building(NonZeroU16::MIN.saturating_add(2)), Scene::corridor()] {
            for view in &scene.views {
                for k in 0..2_000 {
                    // Directions on a spiral over the sphere.
                    let z = (f64::from(k) + 0.5) / 1_000.0 - 1.0;
                    let (sin, cos) = (f64::from(k) * 2.4).sin_cos();
                    let across = (1.0 - z * z).sqrt();
                    let ray = Ray {
                        origin: view.in_room.translation(),
                        direction: [across * cos, across * sin, z],
                    };
                    assert!(scene.cast(&ray).is_some());
                }
            }
        }
    }
}
