//! Which plane each point is of, and what the points of each plane measure.

mod laid;
mod tally;

use glam::DVec3;

use crate::ends::End;
use crate::flat::Flat;
use crate::near::{Group, Near, Within};

use self::tally::{LANES, Total, Units, mark};
pub use self::tally::{Measure, Tally};

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

impl Labeller {
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
        let mut measures = vec![Measure::default(); self.planes.len()];
        tally.take(|plane, measure| measures[plane as usize] = measure);
        measures
    }

    /// The same for points that are told by other cells: `of` tells for each of those its place among the cells of this one, that it is or is
    /// a part of; `None` where it has none.
    #[must_use]
    pub fn by_parts(self, of: impl IntoIterator<Item = Option<u32>>) -> Self {
        let cell = |of: Option<u32>| self.cells.get(of? as usize).copied();
        let cells = of.into_iter().map(|of| cell(of).unwrap_or(Place::UNKNOWN)).collect();
        Self { cells, ..self }
    }

    /// A tally of no points.
    pub fn tally(&self) -> Tally {
        Tally::of(self.planes.len())
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
    fn label_other(
        &self,
        cell: &Place,
        x: f32,
        y: f32,
        z: f32,
        (beyond, marks): (&mut [Total], &mut [bool]),
    ) -> Option<u32> {
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
                    mark(marks, plane);
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
        let Self { labeller, points, tally: Tally { counts, beyond, marks }, mut label } = self;
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
                labeller.label_other(cell, x, y, z, (beyond, marks))
            };
            if let Some(count) = plane.and_then(|plane| counts.get_mut(plane as usize)) {
                count[at % LANES] += 1;
            }
            label(point, plane);
        }
    }
}

impl Place {
    /// Of a cell near which there is nothing.
    const UNKNOWN: Self = Self { normal: [0.0; 3], offset: f32::NAN, plane: NONE, rank: 0, mixed: (0, 0) };

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
