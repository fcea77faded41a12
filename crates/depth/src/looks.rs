//! What the tiles of a region look like: their area, and how they are bent.

pub(crate) use terrace_regions::Bend;
use terrace_regions::Column;

use crate::camera::Camera;
use crate::flat::Noise;
use crate::grow::{Image, Region};

/// How a region looks.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Looks {
    /// In m².
    pub(crate) area: f64,
    pub(crate) bend: Option<Bend>,
}

impl Looks {
    pub(crate) fn of(region: &Region, image: Image, camera: &Camera, noise: Noise) -> Self {
        let plane = &region.fitted.plane;
        let [e1, e2] = region.fitted.fit.axes.map(glam::DVec3::from);
        let per_pixel = camera.pixel() * camera.pixel();
        let mut area = 0.0;
        let mut columns: Vec<Column> = Vec::with_capacity(region.tiles.len());
        for tile in region.tiles.iter().filter_map(|tile| image.tiles[*tile as usize].as_ref()) {
            let off = tile.mean - plane.point;
            let height = off.dot(plane.normal);
            // A pixel covers the more of a surface the more it is turned away.
            let slope = (plane.normal.dot(tile.mean) / tile.mean.z).abs();
            area += tile.points * per_pixel * tile.mean.z * tile.mean.z / slope;
            columns.push(Column { points: tile.points, place: [off.dot(e1), off.dot(e2)], height });
        }
        // Errors that are larger than stated do not hide a bend.
        let bend = Bend::of(&columns, region.fitted.variance / noise.scale);
        Self { area, bend }
    }
}
