//! Closes the gaps between points.

use crate::cloud::DepthImage;

/// Side of the tiles in which the density of points is measured, in pixels.
const TILE: usize = 16;

/// Largest radius of a disc, in pixels: sparser points than it can close stay apart.
const MAX_RADIUS: f64 = 7.0;

/// Grows every occupied pixel to a disc, nearer ones over farther ones.
///
/// *Algorithm*
/// 1. In tiles of 16 × 16 pixels, count the occupied ones: density ρ. Tiles are smoothed over their neighbours so
///    that a tile on the border of a surface does not count the empty side alone.
/// 2. Discs of radius r around points scattered at random leave a share exp(−ρ π r²) uncovered; r is chosen so that
///    1 % is, and at most 7 pixels.
/// 3. Each pixel takes the nearest depth among the discs that cover it.
pub(crate) fn close(seen: &DepthImage) -> DepthImage {
    let radii = tile_radii(seen);
    let tiles_across = seen.width.div_ceil(TILE);
    let mut closed = seen.clone();
    for y in 0..seen.height {
        for x in 0..seen.width {
            let at = y * seen.width + x;
            let (depth, colour) = (seen.depth[at], seen.colour[at]);
            if depth.is_finite() {
                let radius = radii[y / TILE * tiles_across + x / TILE];
                disc(&mut closed, x, y, radius, depth, colour);
            }
        }
    }
    closed
}

/// Lays one disc over what is farther away.
fn disc(closed: &mut DepthImage, x: usize, y: usize, radius: f64, depth: f64, colour: [u8; 3]) {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and MAX_RADIUS")]
    let reach = radius.max(0.0) as usize;
    for row in y.saturating_sub(reach)..(y + reach + 1).min(closed.height) {
        for column in x.saturating_sub(reach)..(x + reach + 1).min(closed.width) {
            let (dx, dy) = (column.abs_diff(x), row.abs_diff(y));
            let at = row * closed.width + column;
            if ((dx * dx + dy * dy) as f64) <= radius * radius && depth < closed.depth[at] {
                closed.depth[at] = depth;
                closed.colour[at] = colour;
            }
        }
    }
}

fn tile_radii(seen: &DepthImage) -> Vec<f64> {
    let (across, down) = (seen.width.div_ceil(TILE), seen.height.div_ceil(TILE));
    let mut counts = vec![0_usize; across * down];
    for (row, depths) in seen.depth.chunks_exact(seen.width).enumerate() {
        for (column, _) in depths.iter().enumerate().filter(|(_, depth)| depth.is_finite()) {
            counts[row / TILE * across + column / TILE] += 1;
        }
    }
    let mut radii = Vec::with_capacity(counts.len());
    for ty in 0..down {
        for tx in 0..across {
            let (mut sum, mut tiles) = (0, 0);
            for ny in ty.saturating_sub(1)..(ty + 2).min(down) {
                for nx in tx.saturating_sub(1)..(tx + 2).min(across) {
                    let count = counts[ny * across + nx];
                    sum += count;
                    tiles += usize::from(count > 0);
                }
            }
            let density = sum as f64 / (tiles.max(1) * TILE * TILE) as f64;
            // Without points the radius is never used.
            let radius = (-(0.01_f64.ln()) / (density * std::f64::consts::PI)).sqrt();
            radii.push(radius.min(MAX_RADIUS));
        }
    }
    radii
}
