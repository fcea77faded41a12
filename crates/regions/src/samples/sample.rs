//! The sample of one cell.

use super::spot::Spot;
use super::stripe::{FEW, More, ROOM, all_of};
use super::together::Together;
use super::units::Unit;

/// A point of a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SampledPoint {
    /// Where it is from the anchor of the cell's sums, in metres, as samples know it.
    pub place: [f32; 3],
    /// How many halvings of a sample it endures, from 0 to 31: its scrambled place is below 2³²⁻ʰ for so many as h.
    pub endures: u8,
}

/// Some points of a cell: see [`Samples`](crate::Samples).
#[derive(Debug, Clone, Copy)]
pub struct Sample<'s> {
    few: &'s [Spot; FEW],
    more: &'s More,
    /// So many of the first, and of the others.
    count: u16,
    unit: Unit,
    /// Which cell it is of those that are made of others, if it is one.
    whole: u32,
    among: Option<&'s Together<'s>>,
}

impl<'s> Sample<'s> {
    /// That of a cell without points.
    pub const EMPTY: Self = Self {
        few: &[Spot::ZERO; FEW],
        more: &[Spot::ZERO; ROOM - FEW],
        count: 0,
        unit: Unit::ONE,
        whole: 0,
        among: None,
    };

    /// Of so many places, in two parts.
    pub(super) fn of(few: &'s [Spot; FEW], more: &'s More, count: u16, unit: Unit) -> Self {
        Self { few, more, count, unit, ..Self::EMPTY }
    }

    /// Where the points are, from the anchor of the cell's sums, in metres.
    pub fn places(&self) -> impl Iterator<Item = [f32; 3]> + Clone + use<'s> {
        self.points().map(|point| point.place)
    }

    /// The points.
    pub fn points(&self) -> impl Iterator<Item = SampledPoint> + Clone + use<'s> {
        let unit = self.unit;
        let point = move |spot: &Spot| SampledPoint { place: unit.place(*spot), endures: spot.endures() };
        self.few.iter().chain(self.more).take(self.count.into()).map(point)
    }

    /// The samples of the parts of a cell, or its own if it has no parts, each with the number of points that it is of: those of the cell
    /// are so many. None if its own is empty.
    pub(crate) fn of_parts(&self, points: f64) -> impl Iterator<Item = (Self, f64)> + use<'s> {
        let whole = self.whole;
        let alone = self.among.is_none().then_some((*self, points));
        let parts = self.among.filter(|_| !self.is_empty()).into_iter();
        let all = alone.into_iter().chain(parts.flat_map(move |among| among.parts(whole)));
        all.filter(|(sample, _)| !sample.is_empty())
    }

    /// The places of all these, each with the number of points that it stands for.
    pub(crate) fn weighted(&self, points: f64) -> impl Iterator<Item = ([f32; 3], f64)> + use<'s> {
        self.of_parts(points).flat_map(|(sample, points)| {
            let each = points / f64::from(sample.count);
            sample.places().map(move |place| (place, each))
        })
    }

    /// Of a cell that is made of others.
    pub(super) fn with_parts<'t>(self, whole: u32, among: &'t Together<'t>) -> Sample<'t>
    where
        's: 't,
    {
        Sample { whole, among: Some(among), ..self }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// All that there may be, and how many of them are points.
    pub(super) fn spots(&self) -> ([Spot; ROOM], usize) {
        (all_of(self.few, self.more), self.count.into())
    }

    /// Appends the points to a list.
    #[inline]
    fn append(&self, to: &mut Vec<Spot>) {
        // All that there may be: a number that is known beforehand is faster than a smaller one.
        let after = to.len() + usize::from(self.count);
        to.extend_from_slice(self.few);
        to.extend_from_slice(self.more);
        to.truncate(after);
    }

    /// Puts the places of samples one after the other, one place of zeroes for a sample without, and tells where each begins and the last
    /// ends. `spots` is memory to work with: many are unpacked at once.
    pub(crate) fn unpack(
        samples: &[Self],
        spots: &mut Vec<Spot>,
        places: &mut Vec<[f32; 3]>,
        starts: &mut Vec<usize>,
    ) {
        spots.clear();
        starts.clear();
        for sample in samples {
            starts.push(spots.len());
            sample.append(spots);
            if sample.is_empty() {
                spots.push(Spot::ZERO);
            }
        }
        starts.push(spots.len());
        places.resize(spots.len(), [0.0; 3]);
        let mut first = 0;
        // Mostly all have one unit.
        for of_unit in samples.chunk_by(|a, b| a.unit == b.unit) {
            let range = starts[first]..starts[first + of_unit.len()];
            first += of_unit.len();
            if let Some(sample) = of_unit.first() {
                sample.unit.places(&spots[range.clone()], &mut places[range]);
            }
        }
    }
}
