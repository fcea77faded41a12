//! Which region each point is of.

use glam::DVec3;

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
    samples: impl Fn(usize) -> &'s [[f32; 3]],
) -> Vec<Piece> {
    let mut pieces: Vec<Piece> = Vec::new();
    for (cell, of) in (0_u32..).zip(of_cells) {
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
                let sum = (sums.mean - sums.anchor) * sums.points;
                pieces.push(piece(sum, sums.mean_square(&plane) * sums.points));
                continue;
            }
            let (mut count, mut sum, mut squares) = (0.0, DVec3::ZERO, 0.0);
            for place in samples(cell as usize) {
                if of.nearby.label(*place, reach) == Some(part.region) {
                    let place = DVec3::from(place.map(f64::from));
                    count += 1.0;
                    sum += place;
                    squares += plane.distance(sums.anchor + place).powi(2);
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
}

/// A cell, as its points are labelled.
#[derive(Debug, Clone)]
struct Place {
    anchor: DVec3,
    /// Where the anchor is from the origin, in units.
    from: [i64; 3],
    seen: Seen,
}

/// What points of a cell can be of. Regions are numbered as planes; those that are none have no number.
#[derive(Debug, Clone)]
enum Seen {
    None,
    One(Near),
    Several(Box<(Several, Vec<Option<u32>>)>),
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
        let (units, origin) =
            (Units::of(field.edge), field.cells.first().map_or(DVec3::ZERO, |cell| cell.anchor));
        let nowhere = Place { anchor: origin, from: [0; 3], seen: Seen::None };
        let mut cells: Vec<Place> = vec![nowhere; of_cells.len()];
        // Cells too far from the first for a number of 64 bits have the farthest there is.
        #[allow(clippy::cast_possible_truncation)]
        let whole = |x: f64| (x / units.length).round() as i64;
        for (((rank, given), of), sums) in (0..).zip(&field.order).zip(of_cells).zip(&field.cells) {
            let seen = match of.nearby {
                Nearby::None => Seen::None,
                Nearby::One(near) => {
                    number(rank, near.region).map_or(Seen::None, |region| Seen::One(Near { region, ..near }))
                }
                Nearby::Several(several) => {
                    let numbers: Vec<Option<u32>> =
                        several.near.iter().map(|near| number(rank, near.region)).collect();
                    if numbers.iter().all(Option::is_none) {
                        Seen::None
                    } else {
                        Seen::Several(Box::new((*several, numbers)))
                    }
                }
            };
            let from = (sums.anchor - origin).to_array().map(whole);
            cells[*given as usize] = Place { anchor: sums.anchor, from, seen };
        }
        // As places are.
        #[allow(clippy::cast_possible_truncation)]
        Self { reach: reach as f32, cells, origin, planes, units }
    }

    /// The number of the plane that a point is of; `None` for a point of no plane, and of a cell that does not exist. `cell` is its
    /// place among the cells, and `place` where the point is from the anchor of the cell's sums, in metres.
    #[inline]
    pub fn label(&self, cell: u32, place: [f32; 3]) -> Option<u32> {
        match &self.cells.get(cell as usize)?.seen {
            Seen::None => None,
            Seen::One(near) => near.errors(place, self.reach).map(|_| near.region),
            Seen::Several(several) => {
                let (several, numbers) = &**several;
                several.best(place, self.reach).and_then(|at| numbers[at])
            }
        }
    }

    /// Labels points one after the other, as [`label`](Self::label) does, and measures them: what is given back has a place for each
    /// plane. `cells` tells the cell of the point at a place of the list. Fastest where points of the same cell follow each other.
    pub fn label_all(
        &self,
        cells: impl Fn(usize) -> Option<u32>,
        places: &[[f32; 3]],
        mut label: impl FnMut(usize, Option<u32>),
    ) -> Vec<Measure> {
        let mut measures = vec![Measure::default(); self.planes.len()];
        let mut first = 0;
        while first < places.len() {
            let cell = cells(first);
            let most = places.len().min(first + LONGEST);
            let end = (first + 1..most).find(|at| cells(*at) != cell).unwrap_or(most);
            let run = first..end;
            first = end;
            let Some(of) = cell.and_then(|cell| self.cells.get(cell as usize)) else {
                run.for_each(|at| label(at, None));
                continue;
            };
            match &of.seen {
                Seen::None => run.for_each(|at| label(at, None)),
                Seen::One(near) => {
                    let mut of_run = self.begin(of, near.region);
                    for (at, place) in run.clone().zip(&places[run]) {
                        let is_near = near.errors(*place, self.reach).is_some();
                        of_run.push(*place, is_near, self.units);
                        label(at, is_near.then_some(near.region));
                    }
                    of_run.add_to(near.region, self.units, &mut measures);
                }
                Seen::Several(several) => {
                    let (several, numbers) = &**several;
                    for (at, place) in run.clone().zip(&places[run]) {
                        let region = several.best(*place, self.reach).and_then(|at| *numbers.get(at)?);
                        if let Some(region) = region {
                            let mut alone = self.begin(of, region);
                            alone.push(*place, true, self.units);
                            alone.add_to(region, self.units, &mut measures);
                        }
                        label(at, region);
                    }
                }
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

    #[inline]
    fn begin(&self, of: &Place, region: u32) -> OfRun {
        let Some(plane) = self.planes.get(region as usize) else { return OfRun::default() };
        let offset = plane.distance(of.anchor);
        OfRun { normal: plane.normal, offset, from: of.from, ..OfRun::default() }
    }
}

/// Points of one plane in a cell.
#[derive(Default)]
struct OfRun {
    /// That of the plane, and the distance of the anchor from it.
    normal: DVec3,
    offset: f64,
    /// Where the anchor is from the origin, in units.
    from: [i64; 3],
    points: u64,
    /// Sum of places from the anchor.
    sum: DVec3,
    squares: f64,
}

/// After so many points at most sums go to their plane: so far they are exact.
const LONGEST: usize = 128;
/// Added and taken away, it rounds smaller numbers to integers.
const ROUNDING: f64 = 1.5 * (1_u64 << 52) as f64;

impl OfRun {
    /// Adds a point, if it counts: without a branch, for most do.
    #[inline]
    fn push(&mut self, place: [f32; 3], counts: bool, units: Units) {
        let place = if counts { DVec3::from(place.map(f64::from)) } else { DVec3::ZERO };
        let distance = self.normal.dot(place) + self.offset;
        let square = (distance * distance * (1.0 / units.square) + ROUNDING) - ROUNDING;
        self.points += u64::from(counts);
        self.sum += place;
        self.squares += if counts { square } else { 0.0 };
    }

    #[inline]
    fn add_to(&self, region: u32, units: Units, measures: &mut [Measure]) {
        let Some(measure) = measures.get_mut(region as usize) else { return };
        // Whole numbers already, of no more than 53 bits.
        #[allow(clippy::cast_possible_truncation)]
        let whole = |x: f64| i128::from(x as i64);
        // Places that are whole numbers of a unit have such sums.
        let sum = (self.sum * (1.0 / units.length)).to_array().map(whole);
        // Fewer than 64 bits and those of a small number: no overflow.
        let sum = [0, 1, 2].map(|i| i128::from(self.from[i]) * i128::from(self.points) + sum[i]);
        measure.add(&Measure { points: self.points, sum, squares: whole(self.squares) });
    }
}
