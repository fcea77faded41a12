//! Brings out the shape of a closed depth image.

use crate::cloud::DepthImage;
use crate::image::Image;

/// Reach of the smoothing of depth, in pixels to each side, and the jump of depth in pixels that ends it.
const REACH: usize = 10;
pub(crate) const JUMP: f32 = 40.0;

/// From where the light comes: to the right, up, and toward the eye.
const LIGHT: [f32; 3] = [-0.40, 0.56, 0.72];

/// Colours a depth image.
///
/// *Algorithm*
/// 1. Depth is averaged over the pixels around that lie within a jump of it, first along rows, then along columns, so
///    that the noise of points does not become grain while edges stay.
/// 2. The slope of the smoothed depth gives the normal, and that the light on the pixel.
/// 3. A pixel is darkened by how far it lies behind its neighbours (eye-dome lighting, after C. Boucheny, 2009), which
///    draws a line along every jump of depth.
///
/// `pixel` is the size of a pixel in metres.
pub(crate) fn shade(seen: &DepthImage, pixel: f32) -> Image {
    let across = smooth(seen, 1, pixel);
    let smoothed = smooth(&across, seen.width, pixel);
    let mut image = Image::white(seen.width, seen.height);
    for (at, out) in image.pixels_mut().iter_mut().enumerate() {
        let (x, y) = (at % seen.width, at / seen.width);
        let depth = smoothed.depth[at];
        if depth.is_finite() {
            let brightness = light(&smoothed, x, y, pixel) * edge(&smoothed, x, y, pixel);
            *out = seen.colour[at]
                .map(|c| crate::palette::to_byte(f64::from(c) / 255.0 * f64::from(brightness)));
        }
    }
    image
}

/// Averages depth along rows (`stride` 1) or columns (`stride` = width).
fn smooth(seen: &DepthImage, stride: usize, pixel: f32) -> DepthImage {
    let mut smoothed = seen.clone();
    for (at, out) in smoothed.depth.iter_mut().enumerate() {
        let here = seen.depth[at];
        if !here.is_finite() {
            continue;
        }
        let (place, length) =
            if stride == 1 { (at % seen.width, seen.width) } else { (at / seen.width, seen.height) };
        let (mut sum, mut n) = (0.0, 0.0);
        for other in place.saturating_sub(REACH)..(place + REACH + 1).min(length) {
            let depth = seen.depth[at + other * stride - place * stride];
            if (depth - here).abs() < JUMP * pixel {
                sum += depth - here;
                n += 1.0;
            }
        }
        if n > 0.0 {
            *out = here + sum / n;
        }
    }
    smoothed
}

/// Brightness under the light, from the slope of the depth over a few pixels.
fn light(seen: &DepthImage, x: usize, y: usize, pixel: f32) -> f32 {
    let here = seen.depth_at(x, y).unwrap_or(f32::INFINITY);
    let slope = |ahead: Option<f32>, behind: Option<f32>, run: f32| {
        let usable = |depth: Option<f32>| depth.filter(|d| (d - here).abs() < JUMP * pixel);
        match (usable(ahead), usable(behind)) {
            (Some(a), Some(b)) => (a - b) / (2.0 * run * pixel),
            (Some(a), None) => (a - here) / (run * pixel),
            (None, Some(b)) => (here - b) / (run * pixel),
            (None, None) => 0.0,
        }
    };
    let run = 6;
    let right =
        slope(seen.depth_at(x + run, y), x.checked_sub(run).and_then(|x| seen.depth_at(x, y)), run as f32);
    let down =
        slope(seen.depth_at(x, y + run), y.checked_sub(run).and_then(|y| seen.depth_at(x, y)), run as f32);
    // Depth grows away from the eye: a surface that recedes to the right faces right.
    let normal = [right, -down, 1.0];
    let length = normal.iter().map(|c| c * c).sum::<f32>().sqrt();
    let cosine = normal.iter().zip(LIGHT).map(|(a, b)| a * b).sum::<f32>() / length;
    if cosine.is_finite() { 0.62 + 0.46 * cosine.max(0.0) } else { 1.0 }
}

/// 1 where nothing nearer is around, less the farther the pixel lies behind its neighbours.
fn edge(seen: &DepthImage, x: usize, y: usize, pixel: f32) -> f32 {
    let here = seen.depth_at(x, y).unwrap_or(f32::INFINITY);
    let mut behind = 0.0;
    for (dx, dy) in [(-3, 0), (3, 0), (0, -3), (0, 3), (-2, -2), (2, -2), (-2, 2), (2, 2)] {
        let neighbour =
            x.checked_add_signed(dx).zip(y.checked_add_signed(dy)).and_then(|(x, y)| seen.depth_at(x, y));
        if let Some(depth) = neighbour.filter(|depth| *depth < here) {
            // Differences of a steep surface stay below a few pixels and count as nothing.
            behind += ((here - depth) / pixel - 16.0).clamp(0.0, 80.0) / 80.0;
        }
    }
    (-0.9 * behind / 3.0_f32).exp()
}
