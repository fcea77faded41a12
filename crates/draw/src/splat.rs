//! Closes the gaps between points.

use crate::cloud::DepthImage;

/// Number of neighbours from which the density around a point is taken.
const NEIGHBOURS: usize = 8;

/// How far they are looked for, in pixels; what has fewer than [`COMPANY`] neighbours there is a stray point.
const REACH: i16 = 20;
const COMPANY: usize = 3;
const STRAY_RADIUS: f64 = 2.0;

/// Grows every occupied pixel to a disc, nearer ones over farther ones.
///
/// *Algorithm*
/// 1. Of each occupied pixel, find the distance R within which eight others lie that are no farther than `jump` in
///    depth, so that a sparse surface before a dense one counts as sparse.
/// 2. Discs of radius r around points scattered at random with density ρ leave a share exp(−ρ π r²) uncovered. With
///    ρ = 8 / (π R²), r = 0.85 R leaves 0.3 %. Stray points stay small.
/// 3. Each pixel takes the nearest depth among the discs that cover it.
/// 4. Small holes that are left are filled: a pixel with at least six of its eight neighbours nearer by more than `jump`
///    takes after the farthest of them. This is done a few times, so that holes close from their rims.
pub(crate) fn close(seen: &DepthImage, jump: f32) -> DepthImage {
    let ring = by_distance();
    let mut closed = seen.clone();
    for y in 0..seen.height {
        for x in 0..seen.width {
            let at = y * seen.width + x;
            if seen.depth[at].is_finite() {
                let radius = 0.85 * spacing(seen, x, y, jump, &ring).unwrap_or(STRAY_RADIUS / 0.85);
                disc(&mut closed, x, y, radius, seen.depth[at], seen.colour[at]);
            }
        }
    }
    for _ in 0..FILLS {
        fill_holes(&mut closed, jump);
    }
    closed
}

/// Steps to the pixels around one, nearest first, and their distances.
fn by_distance() -> Vec<([isize; 2], f64)> {
    let mut steps: Vec<_> = (-REACH..=REACH)
        .flat_map(|dy| {
            (-REACH..=REACH).map(move |dx| ([dx.into(), dy.into()], f64::from(dx).hypot(f64::from(dy))))
        })
        .filter(|(_, distance)| *distance > 0.0 && *distance <= f64::from(REACH))
        .collect();
    steps.sort_by(|(_, a), (_, b)| a.total_cmp(b));
    steps
}

/// The distance within which a pixel has its neighbours; `None` for a stray point.
fn spacing(seen: &DepthImage, x: usize, y: usize, jump: f32, ring: &[([isize; 2], f64)]) -> Option<f64> {
    let here = seen.depth_at(x, y)?;
    let mut found = 0;
    for ([dx, dy], distance) in ring {
        let place = x.checked_add_signed(*dx).zip(y.checked_add_signed(*dy));
        let depth = place.and_then(|(x, y)| seen.depth_at(x, y));
        found += usize::from(depth.is_some_and(|depth| (depth - here).abs() < jump));
        if found == NEIGHBOURS {
            return Some(*distance);
        }
    }
    (found >= COMPANY).then_some(f64::from(REACH) * 0.7)
}

/// Rounds of filling.
const FILLS: usize = 4;

fn fill_holes(image: &mut DepthImage, jump: f32) {
    let (width, height) = (image.width, image.height);
    let mut filled = Vec::new();
    for y in 1..height.saturating_sub(1) {
        for x in 1..width.saturating_sub(1) {
            let at = y * width + x;
            let around = [
                at - width - 1,
                at - width,
                at - width + 1,
                at - 1,
                at + 1,
                at + width - 1,
                at + width,
                at + width + 1,
            ];
            let here = image.depth[at];
            let nearer = || around.into_iter().filter(|other| image.depth[*other] + jump < here);
            if nearer().count() >= 6
                && let Some(rim) = nearer().max_by(|a, b| image.depth[*a].total_cmp(&image.depth[*b]))
            {
                filled.push((at, image.depth[rim], image.colour[rim]));
            }
        }
    }
    for (at, depth, colour) in filled {
        image.depth[at] = depth;
        image.colour[at] = colour;
    }
}

/// Lays one disc over what is farther away.
fn disc(closed: &mut DepthImage, x: usize, y: usize, radius: f64, depth: f32, colour: [u8; 3]) {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and REACH")]
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
