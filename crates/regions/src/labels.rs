//! Which region the points of samples are of, cell by cell.

use glam::DVec3;
use rayon::prelude::*;

use crate::RegionsError;
use crate::field::Field;
use crate::grow::Region;
use crate::near::{Nearby, Within};
use crate::of_cells::OfCells;

/// Points, each of a cell.
#[derive(Debug, Clone, Copy)]
pub struct Points<'a> {
    /// The cell of each point; `None` for points of none, which get no label.
    pub cells: &'a [Option<u32>],
    /// Where each is, from the anchor of its cell's sums, in metres. Places that are not finite get no label.
    pub places: &'a [[f32; 3]],
}

impl Points<'_> {
    /// # Errors
    /// [`RegionsError`] when there are not as many places as points, too many points, or a point of a cell that does not exist.
    pub(crate) fn check(&self, cells: usize) -> Result<(), RegionsError> {
        let (points, places) = (self.cells.len(), self.places.len());
        if points != places {
            return Err(RegionsError::Places { points, places });
        }
        if u32::try_from(points).is_err() {
            return Err(RegionsError::TooManyPoints { points });
        }
        let strange = |cell: &Option<u32>| cell.is_some_and(|cell| cell as usize >= cells);
        match self.cells.iter().position(strange) {
            Some(point) => Err(RegionsError::NoCell { point, cell: self.cells[point].unwrap_or(0) }),
            None => Ok(()),
        }
    }
}

/// Pieces that are handed to a thread at once.
const AT_ONCE: usize = 1024;

/// Points of a region in a cell.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Piece {
    pub(crate) region: u32,
    /// The place of the cell along the curve.
    pub(crate) cell: u32,
    pub(crate) points: u32,
    /// Sum of their places from the anchor of the cell.
    pub(crate) sum: DVec3,
    /// Sum of their squared distances from its plane, in m².
    pub(crate) squares: f64,
}

/// The places in the list of the pieces of each of so many regions.
pub(crate) fn by_region(pieces: &[Piece], regions: usize) -> Vec<Vec<u32>> {
    let mut counts = vec![0; regions];
    for piece in pieces {
        counts[piece.region as usize] += 1;
    }
    let mut of_each: Vec<Vec<u32>> = counts.into_iter().map(Vec::with_capacity).collect();
    for (at, piece) in (0..).zip(pieces) {
        of_each[piece.region as usize].push(at);
    }
    of_each
}

/// The pieces of all cells, as their samples tell. A cell whose whole sample is of one region is of it with all its points.
pub(crate) fn pieces<P: Iterator<Item = ([f32; 3], f64)>>(
    field: &Field,
    of_cells: &OfCells,
    regions: &[Region],
    reach: f64,
    samples: impl Fn(usize) -> P + Sync,
) -> Vec<Piece> {
    // Which there are is told first: so they are written where they stay.
    let mut told: Vec<(u32, u32)> = Vec::with_capacity(of_cells.parts.len());
    for (cell, of_cell) in (0..).zip(&of_cells.parts) {
        for (part, of) in (0..).zip(of_cell.as_slice()) {
            if of.labelled > 0.0 {
                told.push((cell, part));
            }
        }
    }
    let piece = |(cell, part): &(u32, u32)| {
        let at = *cell as usize;
        let part = &of_cells.parts[at].as_slice()[*part as usize];
        let plane = &regions[part.region as usize].fitted.plane;
        let (sums, anchor) = (&field.cells[at], field.anchors[at]);
        // Shares of a count of 64 bits that is above 2³² do not occur: so many points are not numbered.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let points = part.labelled.round().max(1.0) as u32;
        let piece =
            |sum: DVec3, squares: f64| Piece { region: part.region, cell: *cell, points, sum, squares };
        // Less than all is less by a sampled point at least: shares of the points are rounded.
        if part.labelled + 0.5 >= sums.points {
            return piece((sums.mean - anchor) * sums.points, sums.mean_square(plane) * sums.points);
        }
        let (mut count, mut sum, mut squares) = (0.0, DVec3::ZERO, 0.0);
        for (place, each) in samples(at) {
            if of_cells.nearby[at].label(place, reach) == Some(part.region) {
                let place = DVec3::from(place.map(f64::from));
                count += each;
                sum += place * each;
                squares += plane.distance(anchor + place).powi(2) * each;
            }
        }
        let each = if count > 0.0 { f64::from(points) / count } else { 0.0 };
        piece(sum * each, squares * each)
    };
    told.par_iter().with_min_len(AT_ONCE).map(piece).collect()
}

impl Nearby {
    /// The region that a point is most probably of.
    #[inline]
    pub(crate) fn label(&self, place: [f32; 3], reach: f64) -> Option<u32> {
        // As places are.
        #[allow(clippy::cast_possible_truncation)]
        let reach = reach as f32;
        match self {
            Self::None => None,
            Self::One(near) => near.errors(place, reach).map(|_| near.region),
            Self::Several(several) => {
                let group = several.group();
                let at = match group.within(place, reach) {
                    Within::None => None,
                    Within::One(at) => Some(at),
                    Within::Several => group.best(place, reach),
                };
                at.map(|at| several.near[at].region)
            }
        }
    }
}
