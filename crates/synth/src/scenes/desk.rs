//! Three planes in the shape of a desk, as section VI-A of the paper is read for its Table I.

use crate::build::Builder;
use crate::kind::SceneKind;
use crate::scene::Scene;
use crate::shape::Rectangle;

pub(crate) fn desk() -> Scene {
    let (width, depth, height) = (1.2, 0.8, 0.75);
    // The board is 4 cm thick and overhangs the panels; its underside is not seen.
    let (overhang, panel) = (0.1, height - 0.04);
    let mut b = Builder::new(SceneKind::Desk);
    b.plane("top", [Rectangle::new([0.0, 0.0, height], [width, 0.0, 0.0], [0.0, depth, 0.0])]);
    b.plane("left", [Rectangle::new([overhang, 0.0, 0.0], [0.0, 0.0, panel], [0.0, depth, 0.0])]);
    b.plane("right", [Rectangle::new([width - overhang, 0.0, 0.0], [0.0, depth, 0.0], [0.0, 0.0, panel])]);
    b.finish()
}
