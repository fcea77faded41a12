//! Puts a building together from surfaces and views.

use crate::kind::SceneKind;
use crate::scene::{Scene, ScenePlane};
use crate::sensor::{Sensor, View};
use crate::shape::{Cylinder, Rectangle, Shape, Sphere};
use crate::vector::Vec3;
use terrace_types::{Plane, PlaneId, Pose};

/// The noise of a scene without sensor, in metres.
const WHITE_NOISE: [f64; 2] = [0.01; 2];

/// A surface and the true plane it belongs to.
#[derive(Debug, Clone)]
pub(crate) struct Surface {
    pub(crate) shape: Shape,
    pub(crate) plane: Option<PlaneId>,
}

/// Collects what a scene consists of. Only the fixed buildings of this crate pass through it, so that what cannot
/// be built is a mistake in their constants, which the tests of every scene would meet.
#[derive(Debug)]
pub(crate) struct Builder {
    scene: Scene,
}

impl Builder {
    pub(crate) fn new(kind: SceneKind) -> Self {
        Self {
            scene: Scene {
                kind,
                surfaces: Vec::new(),
                planes: Vec::new(),
                views: Vec::new(),
                placement: Pose::IDENTITY,
                white_noise: WHITE_NOISE,
            },
        }
    }

    /// The noise of a scene without sensor: see [`Scene`].
    pub(crate) fn white_noise(&mut self, sigmas: [f64; 2]) {
        self.scene.white_noise = sigmas;
    }

    /// A true plane, made of one or more coplanar rectangles; its normal is that of the first.
    #[expect(clippy::expect_used, reason = "fixed buildings, see the type")]
    pub(crate) fn plane(&mut self, name: &'static str, parts: impl IntoIterator<Item = Rectangle>) {
        let id = PlaneId::from_index(self.scene.planes.len()).expect("few planes");
        let mut parts = parts.into_iter().peekable();
        let first = parts.peek().expect("a plane has a part");
        let plane = Plane::through(first.corner(), first.normal()).expect("the part has a direction");
        self.scene.planes.push(ScenePlane { id, name, plane });
        self.scene
            .surfaces
            .extend(parts.map(|part| Surface { shape: Shape::Rectangle(part), plane: Some(id) }));
    }

    /// A flat part too narrow to count as a plane, such as the reveal of a door.
    pub(crate) fn trim(&mut self, part: Rectangle) {
        self.scene.surfaces.push(Surface { shape: Shape::Rectangle(part), plane: None });
    }

    pub(crate) fn sphere(&mut self, centre: Vec3, radius: f64) {
        let shape = Shape::Sphere(Sphere { centre, radius });
        self.scene.surfaces.push(Surface { shape, plane: None });
    }

    pub(crate) fn cylinder(&mut self, base: Vec3, top: Vec3, radius: f64) {
        let shape = Shape::Cylinder(Cylinder::between(base, top, radius));
        self.scene.surfaces.push(Surface { shape, plane: None });
    }

    #[expect(clippy::expect_used, reason = "fixed buildings, see the type")]
    pub(crate) fn view(&mut self, sensor: Sensor, rotation: [Vec3; 3], position: Vec3) {
        let pose = Pose::new(rotation, position).expect("the view has a rotation");
        let view = View { sensor, in_room: pose, room: [0.0; 3], planes_before: 0, in_world: pose };
        self.scene.views.push(view);
    }

    pub(crate) fn finish(self) -> Scene {
        self.scene
    }

    /// What was built so far as a room, with a copy of it at each of these places: at most 65 535, in steps of a
    /// room, so that less than a million planes are numbered with 32 bits, and all places are finite.
    #[expect(
        clippy::expect_used,
        reason = "rooms are counted with 16 bits, and places are multiples of a room"
    )]
    pub(crate) fn finish_copied(self, places: impl IntoIterator<Item = Vec3>) -> Scene {
        let room = self.scene;
        let mut building = Scene { planes: Vec::new(), views: Vec::new(), ..room.clone() };
        for place in places {
            let moved = room.translated(place).expect("the place is a number of metres");
            let before = building.planes.len();
            building.planes.extend(moved.planes.into_iter().zip(before..).map(|(plane, index)| ScenePlane {
                id: PlaneId::from_index(index).expect("few planes"),
                ..plane
            }));
            let views = moved.views.into_iter();
            building.views.extend(views.map(|view| View { room: place, planes_before: before, ..view }));
        }
        building
    }

    /// The finished scene, rotated.
    #[expect(clippy::expect_used, reason = "fixed buildings, see the type")]
    pub(crate) fn finish_rotated(self, rotation: [Vec3; 3]) -> Scene {
        Pose::new(rotation, [0.0; 3])
            .map_err(Into::into)
            .and_then(|pose| self.scene.transformed(&pose))
            .expect("the building has a rotation")
    }
}
