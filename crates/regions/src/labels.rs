//! Which region each point is of.

use glam::DVec3;
use rayon::prelude::*;

use crate::RegionsError;
use crate::field::Field;
use crate::flat::Flat;
use crate::mixture::{Candidate, OfCell};
use crate::near::{Near, Nearby, Several};

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

/// Cells that are handed to a thread at once.
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

/// The pieces of all cells, as their samples tell. A cell whose whole sample is of one region is of it with all its points.
pub(crate) fn pieces<'s>(
    field: &Field,
    of_cells: &[OfCell],
    candidates: &[Option<Candidate>],
    reach: f64,
    samples: impl Fn(usize) -> &'s [[f32; 3]] + Sync,
) -> Vec<Piece> {
    let of_some = |(first, of_cells): (usize, &[OfCell])| {
        // Cells are numbered with 32 bits.
        let first = u32::try_from(first * AT_ONCE).unwrap_or(u32::MAX);
        pieces_of_some(field, (first, of_cells), candidates, reach, &samples)
    };
    let pieces: Vec<Vec<Piece>> = of_cells.par_chunks(AT_ONCE).enumerate().map(of_some).collect();
    pieces.concat()
}

/// Of some cells, and where they begin.
fn pieces_of_some<'s>(
    field: &Field,
    (first, of_cells): (u32, &[OfCell]),
    candidates: &[Option<Candidate>],
    reach: f64,
    samples: impl Fn(usize) -> &'s [[f32; 3]],
) -> Vec<Piece> {
    let mut pieces: Vec<Piece> = Vec::with_capacity(of_cells.len());
    for (cell, of) in (first..).zip(of_cells) {
        let sums = &field.cells[cell as usize];
        let plane = |region: u32| Some(candidates[region as usize].as_ref()?.plane);
        let parts = of.parts.as_slice().iter().filter(|part| part.labelled > 0.0);
        for part in parts {
            let Some(plane) = plane(part.region) else { continue };
            // Shares of a count of 64 bits that is above 2³² do not occur: so many points are not numbered.
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            let points = part.labelled.round().max(1.0) as u32;
            let piece = |sum: DVec3, squares: f64| Piece { region: part.region, cell, points, sum, squares };
            if part.labelled >= sums.points {
                let sum = (sums.mean - field.anchors[cell as usize]) * sums.points;
                pieces.push(piece(sum, sums.mean_square(&plane) * sums.points));
                continue;
            }
            let (mut count, mut sum, mut squares) = (0.0, DVec3::ZERO, 0.0);
            for place in samples(cell as usize) {
                if of.nearby.label(*place, reach) == Some(part.region) {
                    let place = DVec3::from(place.map(f64::from));
                    count += 1.0;
                    sum += place;
                    squares += plane.distance(field.anchors[cell as usize] + place).powi(2);
                }
            }
            let each = f64::from(points) / f64::max(count, 1.0);
            pieces.push(piece(sum * each, squares * each));
        }
    }
    pieces
}

impl Nearby {
    /// The region that a point is most probably of.
    #[inline]
    fn label(&self, place: [f32; 3], reach: f64) -> Option<u32> {
        // As places are.
        #[allow(clippy::cast_possible_truncation)]
        let reach = reach as f32;
        match self {
            Self::None => None,
            Self::One(near) => near.errors(place, reach).map(|_| near.region),
            Self::Several(several) => several.best(place, reach).map(|at| several.near[at].region),
        }
    }
}

/// Tells of which plane points are, one by one, by the cell and the place of each. Nothing is kept of the points themselves, so that
/// they can be read again and labelled as they come.
#[derive(Debug, Clone)]
pub struct Labeller {
    reach: f32,
    cells: Vec<Place>,
    /// What places of cells are counted from.
    origin: DVec3,
    planes: Vec<Flat>,
    units: Units,
    /// Points that are summed up in 64 bits.
    at_once: usize,
}

/// A cell, as its points are labelled.
#[derive(Debug, Clone)]
struct Place {
    /// Where the anchor is from the origin, in units.
    from: [i64; 3],
    seen: Seen,
}

/// What points of a cell can be of. Regions are numbered as planes; those that are none have no number.
#[derive(Debug, Clone)]
enum Seen {
    None,
    One(Near, Off),
    Several(Box<(Several, Vec<Option<Off>>)>),
}

/// A plane as it is measured from a cell.
#[derive(Debug, Clone, Copy)]
struct Off {
    plane: u32,
    /// How far the anchor of the cell is from it, in metres.
    distance: f64,
}

/// Labelled points of a plane, counted and measured. Sums are of whole numbers, so that it does not matter in which order points come,
/// and in which parts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Measure {
    /// How many there are.
    pub points: u64,
    /// Sum of where they are from the origin of the labeller, in its units.
    sum: [i128; 3],
    /// Sum of their squared distances from the plane, likewise.
    squares: i128,
}

impl Measure {
    /// Adds those of other points of the plane.
    pub fn add(&mut self, other: &Self) {
        self.points = self.points.wrapping_add(other.points);
        self.squares = self.squares.wrapping_add(other.squares);
        for (sum, more) in self.sum.iter_mut().zip(other.sum) {
            *sum = sum.wrapping_add(more);
        }
    }
}

/// What lengths and squares of them are counted in: powers of two, a small share of a cell.
#[derive(Debug, Clone, Copy)]
struct Units {
    length: f64,
    square: f64,
}

impl Units {
    fn of(edge: f64) -> Self {
        // The exponent bits alone are the power of two below.
        let below = f64::from_bits(edge.to_bits() & (0x7ff << 52));
        let length = below * (-24_f64).exp2();
        Self { length, square: length * length * 16.0 }
    }
}

impl Labeller {
    /// `number` is that of the plane which points of a region are of in a cell, if it is one.
    pub(crate) fn of(
        field: &Field,
        of_cells: Vec<OfCell>,
        reach: f64,
        mut number: impl FnMut(u32, u32) -> Option<u32>,
        planes: Vec<Flat>,
    ) -> Self {
        let (units, origin) = (Units::of(field.edge), field.anchors.first().copied().unwrap_or(DVec3::ZERO));
        let nowhere = Place { from: [0; 3], seen: Seen::None };
        let mut cells: Vec<Place> = vec![nowhere; of_cells.len()];
        // Cells too far from the first for a number of 56 bits have the farthest there is.
        #[allow(clippy::cast_possible_truncation)]
        let whole = |x: f64| ((x / units.length).round() as i64).clamp(-FARTHEST, FARTHEST);
        let mut farthest = 0;
        for (((rank, given), of), anchor) in (0..).zip(&field.order).zip(of_cells).zip(&field.anchors) {
            let mut off = |near: &Near| {
                let plane = number(rank, near.region)?;
                Some(Off { plane, distance: planes.get(plane as usize)?.distance(*anchor) })
            };
            let seen = match of.nearby {
                Nearby::None => Seen::None,
                Nearby::One(near) => off(&near).map_or(Seen::None, |off| Seen::One(near, off)),
                Nearby::Several(several) => {
                    let planes: Vec<Option<Off>> = several.near.iter().map(off).collect();
                    if planes.iter().all(Option::is_none) {
                        Seen::None
                    } else {
                        Seen::Several(Box::new((*several, planes)))
                    }
                }
            };
            let from = (*anchor - origin).to_array().map(whole);
            farthest = from.iter().fold(farthest, |farthest, x| farthest.max(x.abs()));
            cells[*given as usize] = Place { from, seen };
        }
        // So many places are summed up in 64 bits.
        let at_once = usize::try_from(i64::MAX / (farthest + NEAREST)).unwrap_or(LONGEST).min(LONGEST);
        // As places are.
        #[allow(clippy::cast_possible_truncation)]
        Self { reach: reach as f32, cells, origin, planes, units, at_once }
    }

    /// The number of the plane that a point is of; `None` for a point of no plane, and of a cell that does not exist. `cell` is its
    /// place among the cells, and `place` where the point is from the anchor of the cell's sums, in metres.
    #[inline]
    pub fn label(&self, cell: u32, place: [f32; 3]) -> Option<u32> {
        match &self.cells.get(cell as usize)?.seen {
            Seen::None => None,
            Seen::One(near, off) => near.errors(place, self.reach).map(|_| off.plane),
            Seen::Several(several) => Some(of_several(several, place, self.reach)?.plane),
        }
    }

    /// Labels points one after the other, as [`label`](Self::label) does, and measures them: what is given back has a place for each
    /// plane. `cells` tells the cell of the point at a place of the list.
    pub fn label_all(
        &self,
        cells: impl Fn(usize) -> Option<u32>,
        places: &[[f32; 3]],
        mut label: impl FnMut(usize, Option<u32>),
    ) -> Vec<Measure> {
        let mut measures = vec![Measure::default(); self.planes.len()];
        // The last is of points of no plane: so that it takes no branch to leave them out.
        let none = self.planes.len();
        let mut sums = vec![OfPlane::default(); none + 1];
        let normals: Vec<DVec3> = self.planes.iter().map(|plane| plane.normal).chain([DVec3::ZERO]).collect();
        let per_unit = Units { length: 1.0 / self.units.length, square: 1.0 / self.units.square };
        for first in (0..places.len()).step_by(self.at_once) {
            for (at, place) in (first..places.len()).zip(&places[first..]).take(self.at_once) {
                let Some(of) = cells(at).and_then(|cell| self.cells.get(cell as usize)) else {
                    label(at, None);
                    continue;
                };
                let (off, is_near) = match &of.seen {
                    Seen::None => {
                        label(at, None);
                        continue;
                    }
                    Seen::One(near, off) => (*off, near.errors(*place, self.reach).is_some()),
                    Seen::Several(several) => match of_several(several, *place, self.reach) {
                        Some(off) => (off, true),
                        None => (Off { plane: 0, distance: 0.0 }, false),
                    },
                };
                label(at, is_near.then_some(off.plane));
                let plane = if is_near { off.plane as usize } else { none };
                if let (Some(sums), Some(normal)) = (sums.get_mut(plane), normals.get(plane)) {
                    sums.push(*place, &of.from, *normal, off.distance, per_unit);
                }
            }
            for (measure, sums) in measures.iter_mut().zip(&mut sums) {
                measure.add(&std::mem::take(sums).measure());
            }
        }
        measures
    }

    /// Where measured points of a plane are in the mean, and their root mean square distance from it, in metres; `None` without points.
    pub fn mean_and_rms(&self, measure: &Measure) -> Option<([f64; 3], f64)> {
        let (points, units, origin) = (measure.points as f64, self.units, self.origin.to_array());
        let mean = [0, 1, 2].map(|i| origin[i] + measure.sum[i] as f64 * units.length / points);
        (measure.points > 0).then(|| (mean, (measure.squares as f64 * units.square / points).sqrt()))
    }
}

/// The plane that a point is most probably of, where there are several.
#[inline]
fn of_several(several: &(Several, Vec<Option<Off>>), place: [f32; 3], reach: f32) -> Option<Off> {
    let (several, planes) = several;
    several.best(place, reach).and_then(|at| *planes.get(at)?)
}

/// Cells are no further from the first than this, in units, and points no further from their cell.
const FARTHEST: i64 = 1 << 56;
const NEAREST: i64 = 1 << 28;
/// So many squares, of which none is larger than the other, are summed up in 64 bits.
const LONGEST: usize = 1 << 12;
const LARGEST: f64 = (1_u64 << 50) as f64;
/// Added to numbers up to 2⁵¹ it rounds them to integers, which are in the lowest bits then.
const ROUNDING: f64 = 1.5 * (1_u64 << 52) as f64;

/// Points of one plane, not too many of them.
#[derive(Debug, Clone, Copy, Default)]
struct OfPlane {
    points: u64,
    sum: [i64; 3],
    squares: i64,
}

impl OfPlane {
    /// Adds a point: `from` is where the anchor of its cell is from the origin, and `distance` how far from the plane.
    #[inline]
    fn push(&mut self, place: [f32; 3], from: &[i64; 3], normal: DVec3, distance: f64, per_unit: Units) {
        let whole = |x: f64| (x + ROUNDING).to_bits().wrapping_sub(ROUNDING.to_bits()).cast_signed();
        let place = DVec3::from(place.map(f64::from));
        let distance = normal.dot(place) + distance;
        self.points += 1;
        for ((sum, from), x) in self.sum.iter_mut().zip(from).zip(place.to_array()) {
            // Places are whole numbers of a unit.
            *sum = sum.wrapping_add(from + whole(x * per_unit.length));
        }
        let square = (distance * distance * per_unit.square).min(LARGEST);
        self.squares = self.squares.wrapping_add(whole(square));
    }

    fn measure(&self) -> Measure {
        Measure { points: self.points, sum: self.sum.map(i128::from), squares: self.squares.into() }
    }
}
