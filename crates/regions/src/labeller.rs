//! Which plane each point is of, and what the points of each plane measure.

use glam::DVec3;

use crate::cell::Sums;
use crate::cube::Cube;
use crate::ends::End;
use crate::field::Field;
use crate::flat::Flat;
use crate::near::{Group, Near, Nearby, Several, Within};
use crate::of_cells::OfCells;

/// Tells of which plane points are, one by one, by the cell and the place of each. Nothing is kept of the points themselves, so that
/// they can be read again and labelled as they come.
///
/// Most cells hold points of one plane, and few others or none. What all points of such a cell measure is known from its sums, so that
/// only the others are measured one by one.
#[derive(Debug, Clone)]
pub struct Labeller {
    reach: f32,
    /// As they were given.
    cells: Vec<Place>,
    /// What places of their points are from, along the curve.
    anchors: Vec<DVec3>,
    /// What is near the cells with several regions, or with one that not all points are of. Regions are numbered as planes.
    mixed: Vec<Near>,
    /// Where those end.
    ends: Vec<End>,
    /// What lengths are counted from.
    origin: DVec3,
    planes: Vec<Flat>,
    /// What all points of the cells measure whose samples are of one plane, by plane.
    whole: Vec<Total>,
    units: Units,
}

/// A cell, as its points are labelled.
#[derive(Debug, Clone, Copy)]
struct Place {
    /// The distance from the only plane near it: see [`Near`]. Where there is none, or several, it is not a number, and in no reach.
    normal: [f32; 3],
    offset: f32,
    /// The plane that all its sampled points are of.
    plane: u32,
    /// Its place along the curve.
    rank: u32,
    /// Where what is near begins among what is near mixed cells, and how much there is: nothing in others.
    mixed: (u32, u32),
}

/// The number of regions that are no plane.
const NONE: u32 = u32::MAX;

/// Labelled points of a plane, counted and measured. Sums are of whole numbers, so that it does not matter in which order points come,
/// and in which parts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Measure {
    /// How many there are.
    pub points: u64,
    /// What they measure beyond all points of the cells that are of the plane alone.
    beyond: Total,
}

impl Measure {
    /// Adds those of other points of the plane.
    pub fn add(&mut self, other: &Self) {
        self.points = self.points.wrapping_add(other.points);
        self.beyond.add(&other.beyond);
    }
}

/// Sums over points, in whole units.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
struct Total {
    /// How many there are, less those that were taken away.
    points: i64,
    /// Sum of where they are from the origin of the labeller.
    places: [i128; 3],
    /// Sum of their squared distances from the plane.
    squares: i128,
}

impl Total {
    /// Of all points of a cell.
    fn of(sums: &Sums, origin: DVec3, plane: &Flat, units: Units) -> Self {
        // Numbers of points are whole.
        #[allow(clippy::cast_possible_truncation)]
        let (points, whole) = (sums.points as i64, |x: f64| x.round() as i128);
        let places = ((sums.mean - origin) * (sums.points * units.per_length)).to_array().map(whole);
        let squares = whole(sums.mean_square(plane) * sums.points * units.per_square);
        Self { points, places, squares }
    }

    fn add(&mut self, other: &Self) {
        self.points = self.points.wrapping_add(other.points);
        self.squares = self.squares.wrapping_add(other.squares);
        for (sum, more) in self.places.iter_mut().zip(other.places) {
            *sum = sum.wrapping_add(more);
        }
    }

    /// Adds a point by where it is from the origin and how far from the plane: once, or −1 times to take it away.
    #[inline]
    fn push(&mut self, place: DVec3, distance: f64, units: Units, times: f64) {
        // To the nearest, without a call.
        #[allow(clippy::cast_possible_truncation)]
        let whole = |x: f64| (x + 0.5_f64.copysign(x)) as i64;
        self.points = self.points.wrapping_add(whole(times));
        for (sum, x) in self.places.iter_mut().zip(place.to_array()) {
            *sum = sum.wrapping_add(whole(x * (times * units.per_length)).into());
        }
        self.squares =
            self.squares.wrapping_add(whole(distance * distance * (times * units.per_square)).into());
    }
}

/// What lengths and squares of them are counted in: powers of two, a small share of a cell.
#[derive(Debug, Clone, Copy)]
struct Units {
    per_length: f64,
    per_square: f64,
}

impl Units {
    fn of(edge: f64) -> Self {
        // The exponent bits alone are the power of two below.
        let below = f64::from_bits(edge.to_bits() & (0x7ff << 52));
        let length = below * (-24_f64).exp2();
        Self { per_length: 1.0 / length, per_square: 1.0 / (length * length * 16.0) }
    }
}

/// Labels of so many points on end are counted apart: to count one takes as long as several, if it has to wait for the one before.
const LANES: usize = 4;

/// What points measure that are labelled, plane by plane. It is as large as there are planes, and meant to be used for one part of the
/// points after the other: a place has many planes, and a part of it few.
#[derive(Debug, Clone, Default)]
pub struct Tally {
    counts: Vec<[u64; LANES]>,
    beyond: Vec<Total>,
}

impl Tally {
    /// What the points of each plane measure.
    fn each(&self) -> impl Iterator<Item = Measure> {
        let sums = self.counts.iter().zip(&self.beyond);
        sums.map(|(counts, beyond)| Measure { points: counts.iter().sum(), beyond: *beyond })
    }

    /// Hands out the numbers of the planes that points were of, and what they measure; the tally is as new.
    pub fn take(&mut self, mut take: impl FnMut(u32, Measure)) {
        let Self { counts, beyond } = self;
        for (plane, (counts, beyond)) in (0..).zip(counts.iter_mut().zip(beyond)) {
            let measure = Measure { points: counts.iter().sum(), beyond: *beyond };
            if measure != Measure::default() {
                take(plane, measure);
                (*counts, *beyond) = ([0; LANES], Total::default());
            }
        }
    }
}

impl Labeller {
    /// `number` is that of the plane which points of a region are of in a cell, if it is one; `anchors` are those of the field.
    pub(crate) fn of(
        field: &Field,
        anchors: Vec<DVec3>,
        of_cells: OfCells,
        reach: f64,
        mut number: impl FnMut(u32, u32) -> Option<u32>,
        planes: Vec<Flat>,
    ) -> Self {
        // As places are.
        #[allow(clippy::cast_possible_truncation)]
        let single = reach as f32;
        let (units, origin) = (Units::of(field.edge), anchors.first().copied().unwrap_or(DVec3::ZERO));
        let unknown = Place { normal: [0.0; 3], offset: f32::NAN, plane: NONE, rank: 0, mixed: (0, 0) };
        let mut cells: Vec<Place> = vec![unknown; of_cells.parts.len()];
        let mut whole = vec![Total::default(); planes.len()];
        let OfCells { nearby, parts } = of_cells;
        // Counted first: lists that grow are copied into new memory again and again.
        let (mut most_near, mut most_ends) = (1, 0);
        for ((nearby, parts), sums) in nearby.iter().zip(&parts).zip(&field.cells) {
            match nearby {
                Nearby::One(_) => most_near += usize::from(parts.whole(sums.points).is_none()),
                Nearby::Several(Several { near, ends }) => {
                    (most_near, most_ends) = (most_near + near.len(), most_ends + ends.len());
                }
                Nearby::None => {}
            }
        }
        let (mut mixed, mut ends) = (Vec::with_capacity(most_near), Vec::with_capacity(most_ends));
        let of_cells = nearby.into_iter().zip(&parts);
        for (((rank, given), (nearby, parts)), sums) in
            (0..).zip(&field.order).zip(of_cells).zip(&field.cells)
        {
            let mut number = |region: u32| number(rank, region).unwrap_or(NONE);
            let to = &mut cells[*given as usize];
            to.rank = rank;
            let plane = parts.whole(sums.points).map_or(NONE, |part| number(part.region));
            if let (Some(flat), Some(whole)) = (planes.get(plane as usize), whole.get_mut(plane as usize)) {
                to.plane = plane;
                whole.add(&Total::of(sums, origin, flat, units));
            }
            if let Nearby::One(near) = &nearby
                && to.plane != NONE
            {
                (to.normal, to.offset) = (near.normal, near.offset);
                continue;
            }
            let first = mixed.len();
            let cube = Cube::of(field, rank as usize, anchors[rank as usize]);
            for near in nearby.regions().iter().filter(|near| !cube.is_beyond(near, single)) {
                let at = near.ends.0.saturating_add(place_of(&ends));
                mixed.push(Near { region: number(near.region), ends: (at, near.ends.1), ..*near });
            }
            match mixed[first..] {
                [near] if near.region == plane && plane != NONE => {
                    (to.normal, to.offset) = (near.normal, near.offset);
                    mixed.truncate(first);
                    continue;
                }
                ref left if left.iter().all(|near| near.region == NONE) => {
                    mixed.truncate(first);
                    continue;
                }
                _ => {}
            }
            to.mixed = (place_of(&mixed[..first]), place_of(&mixed[first..]));
            if let Nearby::Several(several) = nearby {
                ends.extend(several.ends);
            }
        }
        Self { reach: single, cells, anchors, mixed, ends, origin, planes, whole, units }
    }

    /// The number of the plane that a point is of; `None` for a point of no plane, and of a cell that does not exist. `cell` is its
    /// place among the cells, and `place` where the point is from the anchor of the cell's sums, in metres.
    #[inline]
    pub fn label(&self, cell: u32, place: [f32; 3]) -> Option<u32> {
        let cell = self.cells.get(cell as usize)?;
        if cell.is_near(place, self.reach) { Some(cell.plane) } else { self.of_mixed(cell, place) }
    }

    /// Labels points one after the other, as [`label`](Self::label) does, and measures them: what is given back has a place for each
    /// plane. A point is its cell, its place there, and what `label` is to know of it.
    pub fn label_all<P>(
        &self,
        points: impl Iterator<Item = (Option<u32>, [f32; 3], P)>,
        label: impl FnMut(P, Option<u32>),
    ) -> Vec<Measure> {
        let mut tally = self.tally();
        self.label_into(points, &mut tally, label);
        tally.each().collect()
    }

    /// A tally of no points.
    pub fn tally(&self) -> Tally {
        let planes = self.planes.len();
        Tally { counts: vec![[0; LANES]; planes], beyond: vec![Total::default(); planes] }
    }

    /// As [`label_all`](Self::label_all), for points that are a few of many: they are added to those of a tally, whose size is that of all
    /// planes. One that was made by another labeller knows fewer planes, or more.
    pub fn label_into<P>(
        &self,
        points: impl Iterator<Item = (Option<u32>, [f32; 3], P)>,
        tally: &mut Tally,
        label: impl FnMut(P, Option<u32>),
    ) {
        // The same operations, in fewer instructions where the processor can.
        pulp::Arch::new().dispatch(LabelEach { labeller: self, points, tally, label });
    }

    /// The number of the plane that a point is of, if it is not of the only plane near its cell; measures what the sums of the cell do
    /// not tell. Few points need it.
    // Into what `LabelEach` is dispatched to.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    fn label_other(&self, cell: &Place, x: f32, y: f32, z: f32, beyond: &mut [Total]) -> Option<u32> {
        let found = self.of_mixed(cell, [x, y, z]);
        let plane = found.unwrap_or(NONE);
        if plane != cell.plane {
            // Its cell knows of no place that is not finite.
            let finite = |x: f32| if x.is_finite() { f64::from(x) } else { 0.0 };
            let from = DVec3::new(finite(x), finite(y), finite(z));
            for (plane, times) in [(cell.plane, -1.0), (plane, 1.0)] {
                let at = plane as usize;
                if let (Some(sums), Some(flat), Some(anchor)) =
                    (beyond.get_mut(at), self.planes.get(at), self.anchors.get(cell.rank as usize))
                {
                    let place = *anchor + from;
                    sums.push(place - self.origin, flat.distance(place), self.units, times);
                }
            }
        }
        found
    }

    /// The number of the plane that a point of a mixed cell is of.
    #[inline]
    fn of_mixed(&self, cell: &Place, place: [f32; 3]) -> Option<u32> {
        let (first, count) = (cell.mixed.0 as usize, cell.mixed.1 as usize);
        let group = Group { near: self.mixed.get(first..first + count)?, ends: &self.ends };
        let at = match group.within(place, self.reach) {
            Within::None => return None,
            Within::One(at) => at,
            Within::Several => group.best(place, self.reach)?,
        };
        let plane = group.near.get(at)?.region;
        (plane != NONE).then_some(plane)
    }

    /// Where the labelled points of a plane are in the mean, and their root mean square distance from it, in metres; `None` without
    /// points. `measure` is that of all points of the cells, each of them labelled once.
    pub fn mean_and_rms(&self, plane: usize, measure: &Measure) -> Option<([f64; 3], f64)> {
        let mut sums = *self.whole.get(plane)?;
        sums.add(&measure.beyond);
        let (points, Units { per_length, per_square }) = (sums.points as f64, self.units);
        let mean = self.origin + DVec3::from(sums.places.map(|sum| sum as f64)) / (points * per_length);
        // Roundings of the sums of cells may leave a little less than nothing.
        let square = (sums.squares as f64 / (points * per_square)).max(0.0);
        (sums.points > 0).then(|| (mean.to_array(), square.sqrt()))
    }
}

/// [`Labeller::label_into`], point by point.
struct LabelEach<'a, I, L> {
    labeller: &'a Labeller,
    points: I,
    tally: &'a mut Tally,
    label: L,
}

impl<P, I, L> pulp::WithSimd for LabelEach<'_, I, L>
where
    I: Iterator<Item = (Option<u32>, [f32; 3], P)>,
    L: FnMut(P, Option<u32>),
{
    type Output = ();

    // Into what it is dispatched to.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let Self { labeller, points, tally: Tally { counts, beyond }, mut label } = self;
        for (at, (cell, [x, y, z], point)) in points.enumerate() {
            let Some(cell) = cell.and_then(|cell| labeller.cells.get(cell as usize)) else {
                label(point, None);
                continue;
            };
            let plane = if cell.is_near([x, y, z], labeller.reach) {
                Some(cell.plane)
            } else if cell.is_unknown() {
                None
            } else {
                labeller.label_other(cell, x, y, z, beyond)
            };
            if let Some(count) = plane.and_then(|plane| counts.get_mut(plane as usize)) {
                count[at % LANES] += 1;
            }
            label(point, plane);
        }
    }
}

/// The place after the last of a list.
fn place_of<T>(list: &[T]) -> u32 {
    // Of each of the cells, which are numbered with 32 bits, some few: memory would be at its end before.
    u32::try_from(list.len()).unwrap_or(NONE)
}

impl Place {
    /// Whether its points are of no plane, and it of none.
    #[inline]
    fn is_unknown(&self) -> bool {
        self.plane == NONE && self.mixed.1 == 0
    }

    #[inline]
    fn is_near(&self, [x, y, z]: [f32; 3], reach: f32) -> bool {
        let [a, b, c] = self.normal;
        // As `Near::errors` has it.
        (a * x + b * y + c * z + self.offset).abs() <= reach
    }
}
