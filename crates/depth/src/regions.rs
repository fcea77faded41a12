//! The regions of an image, and the errors that explain them.

use crate::around::Arounds;
use crate::flat::Noise;
use crate::grow::{Growing, Image, Region, SEED_CHI_SQUARED};
use crate::strips::Strips;

/// Where the means of tiles scatter by more than this about their planes, in units of what the errors of their points make of them,
/// neighbouring pixels share errors: a distorted sensor, a bent table.
const SHARED: f64 = 2.0;
/// Tiles may then lie off by so many standard deviations of the others of their region.
const SPREAD: f64 = 3.0;

/// Regions of all tiles whose orientation is sure to `tilt`, in radians.
///
/// Errors are trusted while the means of tiles are as near their planes as errors of single pixels would have them. Where they are
/// not, or where errors were found from scatter, which tells nothing of what neighbouring pixels share, the tiles of a region may
/// scatter by more.
pub(crate) fn regions(image: Image, noise: Noise, are_stated: bool, tilt: f64) -> Vec<Region> {
    let strips = Strips::of(image.tiles, &image.levels[0], noise);
    let mut arounds = Arounds::of(image.levels, noise, SEED_CHI_SQUARED);
    let is_sure = |region: &Region| region.fitted.tilt <= tilt;
    if are_stated {
        let mut strict = Growing::of(image, &strips, &mut arounds, 0.0).all();
        if shared(image, noise, &strict) <= SHARED {
            strict.retain(is_sure);
            return strict;
        }
    }
    let mut regions = Growing::of(image, &strips, &mut arounds, SPREAD).all();
    let before = regions.len();
    regions.retain(is_sure);
    if regions.len() < before {
        regions = Growing::of(image, &strips, &mut arounds, SPREAD).again(regions);
        regions.retain(is_sure);
    }
    regions
}

/// Mean squared distance of the means of tiles from the planes of their regions, in units of its expectation were errors independent.
fn shared(image: Image, noise: Noise, regions: &[Region]) -> f64 {
    let (mut sum, mut tiles) = (0.0, 0.0);
    for region in regions {
        let plane = &region.fitted.plane;
        for tile in region.tiles.iter().filter_map(|tile| image.tiles[*tile as usize].as_ref()) {
            let off = plane.distance(tile.mean);
            sum += tile.points * off * off / tile.variance(noise, plane.normal);
            tiles += 1.0;
        }
    }
    if tiles > 0.0 { sum / tiles } else { 0.0 }
}
