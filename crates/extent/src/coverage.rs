//! Which pixels of a border are more in than out.

use crate::footprint::Pixels;
use crate::runs::Runs;

/// Pixels this far away, along rows and columns, tell how many points a covered pixel has.
const AROUND: i32 = 3;

/// Points on a covered pixel from which on the number on another tells how far it is covered.
const ENOUGH: f64 = 4.0;

/// Takes away those border pixels that have less than half of the points of the pixels within.
///
/// Where points are dense, every pixel they touch is occupied, and the border would lie half a pixel too far out. Where
/// there is about one point on a pixel, the border is right as it is.
pub(crate) fn trimmed(closed: Runs, pixels: &Pixels) -> Runs {
    let border = closed.border();
    let inner = closed.clone().without(&border);
    let is_outer = |pixel: &[i32; 2]| {
        let count = f64::from(pixels.get(pixel).copied().unwrap_or(0));
        within(&inner, pixels, *pixel).is_some_and(|covered| covered >= ENOUGH && count < covered / 2.0)
    };
    let outer: Vec<[i32; 2]> = border.into_iter().filter(is_outer).collect();
    closed.without(&outer)
}

/// Mean number of points on the inner pixels around.
fn within(inner: &Runs, pixels: &Pixels, [column, row]: [i32; 2]) -> Option<f64> {
    let (mut points, mut covered) = (0_u64, 0_u32);
    for row in row - AROUND..=row + AROUND {
        for column in inner.columns(row, column - AROUND, column + AROUND + 1) {
            points += u64::from(pixels.get(&[column, row]).copied().unwrap_or(0));
            covered += 1;
        }
    }
    (covered > 0).then(|| points as f64 / f64::from(covered))
}
