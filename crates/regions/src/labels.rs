//! Which region the points of samples are of, cell by cell.

use glam::DVec3;
use rayon::prelude::*;

use crate::RegionsError;
use crate::field::Field;
use crate::flat::Flat;
use crate::near::{Nearby, Within};
use crate::of_cells::{OfCells, Part};

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
}

/// Where the points of a piece are.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Whereabouts {
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

/// The pieces of all cells, as their samples tell, along the curve.
pub(crate) fn pieces(of_cells: &OfCells) -> Vec<Piece> {
    let mut pieces = Vec::with_capacity(of_cells.parts.len());
    for (cell, of_cell) in (0..).zip(&of_cells.parts) {
        let labelled = of_cell.as_slice().iter().filter(|part| part.labelled > 0.0);
        // Shares of a count of 64 bits that is above 2³² do not occur: so many points are not numbered.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let points = |part: &Part| part.labelled.round().max(1.0) as u32;
        pieces.extend(labelled.map(|part| Piece { region: part.region, cell, points: points(part) }));
    }
    pieces
}

/// What tells where the points of pieces are.
pub(crate) struct Looking<'a, S> {
    pub(crate) field: &'a Field,
    pub(crate) of_cells: &'a OfCells,
    pub(crate) reach: f64,
    /// Places of some points of a cell, each with the number of points that it stands for.
    pub(crate) samples: S,
}

impl<P: Iterator<Item = ([f32; 3], f64)>, S: Fn(usize) -> P + Sync> Looking<'_, S> {
    /// Where the points of pieces of one region are, whose number was this and whose plane this is.
    pub(crate) fn at(&self, pieces: &[Piece], region: u32, plane: &Flat) -> Vec<(Piece, Whereabouts)> {
        let of_piece = |piece: &Piece| (*piece, self.at_one(piece, region, plane));
        pieces.par_iter().with_min_len(AT_ONCE).map(of_piece).collect()
    }

    /// A cell whose whole sample is of one region is of it with all its points.
    fn at_one(&self, piece: &Piece, region: u32, plane: &Flat) -> Whereabouts {
        let Self { field, of_cells, reach, samples } = self;
        let at = piece.cell as usize;
        let (sums, anchor) = (&field.cells[at], field.anchors[at]);
        let own = of_cells.parts[at].as_slice().iter().find(|part| part.region == region);
        if own.is_some_and(|part| part.is_all_of(sums.points)) {
            let sum = (sums.mean - anchor) * sums.points;
            return Whereabouts { sum, squares: sums.mean_square(plane) * sums.points };
        }
        let (mut count, mut sum, mut squares) = (0.0, DVec3::ZERO, 0.0);
        for (place, each) in samples(at) {
            if of_cells.nearby[at].label(place, *reach) == Some(region) {
                let place = DVec3::from(place.map(f64::from));
                count += each;
                sum += place * each;
                squares += plane.distance(anchor + place).powi(2) * each;
            }
        }
        let each = if count > 0.0 { f64::from(piece.points) / count } else { 0.0 };
        Whereabouts { sum: sum * each, squares: squares * each }
    }
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
