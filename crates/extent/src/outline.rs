//! From pixels to polygons.

use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay::{IntOverlayOptions, Overlay, ShapeType};
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::i_float::int::point::IntPoint;
use i_overlay::i_shape::int::shape::{IntContour, IntShapes};

use crate::coverage::trimmed;
use crate::polygon::signed_area;
use crate::ring::{midpoints, straightened};
use crate::runs::Runs;
use crate::{ExtentError, Footprint, Polygon, suggested_gap};

/// Widest gap, in pixels, that can be closed.
const WIDEST_GAP: u32 = 128;

/// Parts into which a pixel is divided where polygons are intersected, along each axis.
const PARTS: f64 = (1_u64 << 20) as f64;

/// What an outline shows and what it leaves out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutlineOptions {
    /// Gaps up to this width, in metres, are closed: between points, and between parts of a plane. See
    /// [`suggested_gap`]. Corners that turn inwards are rounded by half as much.
    pub gap: f64,
    /// Holes smaller than this, in square metres, are filled.
    pub min_hole_area: f64,
    /// Polygons smaller than this, in square metres, are left out.
    pub min_area: f64,
    /// How far the border may be moved to make it straight, in metres. `None` is one pixel, which makes straight
    /// what was straight before pixels were made of it.
    pub tolerance: Option<f64>,
}

impl OutlineOptions {
    /// For points with this mean spacing, in metres: gaps as [`suggested_gap`] has them, holes and polygons of less than
    /// twenty points, which come about by chance, filled or left out.
    pub fn for_spacing(spacing: f64) -> Self {
        let least = 20.0 * spacing * spacing;
        Self { gap: suggested_gap(spacing), min_hole_area: least, min_area: least, tolerance: None }
    }

    /// Closes gaps of up to `gap` metres and keeps every hole and polygon.
    pub fn closing(gap: f64) -> Self {
        Self { gap, min_hole_area: 0.0, min_area: 0.0, tolerance: None }
    }
}

impl Footprint {
    /// The polygons that the points cover, the largest first.
    ///
    /// # Errors
    /// [`ExtentError::Size`] for options that are negative or not finite, [`ExtentError::GapTooWide`] for gaps of more
    /// than 128 pixels.
    pub fn outline(&self, options: &OutlineOptions) -> Result<Vec<Polygon>, ExtentError> {
        let pixel = self.resolution();
        let tolerance = options.tolerance.unwrap_or(pixel);
        for (name, value) in [
            ("gap", options.gap),
            ("min_hole_area", options.min_hole_area),
            ("min_area", options.min_area),
            ("tolerance", tolerance),
        ] {
            if !(0.0..=f64::MAX).contains(&value) {
                return Err(ExtentError::Size { name, value });
            }
        }
        if options.gap > f64::from(WIDEST_GAP) * pixel {
            return Err(ExtentError::GapTooWide { gap: options.gap, resolution: pixel, most: WIDEST_GAP });
        }
        let seen = Runs::of(self.pixels().keys().copied());
        // A disc of this radius, centred on a pixel, does not fit between pixels that far apart.
        let radius = f64::midpoint(options.gap / pixel, 1.0);
        let covered = trimmed(seen.closed(radius), self.pixels());
        let min_hole = options.min_hole_area / pixel / pixel;
        let traced = traced(&covered)
            .into_iter()
            .flat_map(|shape| shape.into_iter().enumerate())
            .map(|(k, ring)| (k > 0, midpoints(&ring)))
            .filter(|(is_hole, ring)| !is_hole || -signed_area(ring) >= min_hole)
            .map(|(_, ring)| straightened(&ring, tolerance / pixel));
        let mut polygons: Vec<Polygon> = cleaned(traced)
            .into_iter()
            .map(|shape| to_polygon(&shape, pixel))
            .filter(|polygon| polygon.area() > 0.0 && polygon.area() >= options.min_area)
            .collect();
        // Stable, and shapes come in a fixed order.
        polygons.sort_by(|a, b| b.area().total_cmp(&a.area()));
        Ok(polygons)
    }
}

/// Borders of pixels: outer rings counter-clockwise and then their holes clockwise, as corners of pixels.
fn traced(pixels: &Runs) -> IntShapes<i32> {
    let mut union = Overlay::<i32>::new(4 * pixels.rows().map(|(_, runs)| runs.len()).sum::<usize>());
    for (row, runs) in pixels.rows() {
        for &(start, end) in runs {
            let corners = [(start, row), (end, row), (end, row + 1), (start, row + 1)];
            let corners = corners.map(|(x, y)| IntPoint::new(x, y));
            union.add_contour(&corners, ShapeType::Subject);
        }
    }
    union.overlay(OverlayRule::Subject, FillRule::NonZero)
}

/// Straightening can make rings cross each other or themselves. What is inside is what they go round once more to the
/// left than to the right; this also joins polygons when the hole between them was filled.
fn cleaned(rings: impl Iterator<Item = Vec<[f64; 2]>>) -> IntShapes<i64> {
    let mut overlay =
        Overlay::<i64>::new_custom(0, IntOverlayOptions::ogc(), i_overlay::core::solver::Solver::default());
    for ring in rings {
        let ring = ring.iter().map(|point| {
            #[expect(clippy::cast_possible_truncation, reason = "below 2^49, for pixels are below 2^28")]
            let [x, y] = point.map(|x| (x * PARTS).round() as i64);
            IntPoint::new(x, y)
        });
        overlay.add_path_iter(ring, ShapeType::Subject);
    }
    overlay.overlay(OverlayRule::Subject, FillRule::Positive)
}

fn to_polygon(shape: &[IntContour<i64>], pixel: f64) -> Polygon {
    let mut rings = shape.iter().map(|ring| {
        ring.iter().map(|p| [p.x, p.y].map(|x| x as f64 / PARTS * pixel)).collect::<Vec<[f64; 2]>>()
    });
    let outer = rings.next().unwrap_or_default();
    // Slivers between rings that were moved across each other.
    let holes = rings.filter(|hole| -signed_area(hole) >= 0.25 * pixel * pixel).collect();
    Polygon::new(outer, holes)
}
