//! What the points of planes measure.

use glam::DVec3;

use crate::cell::Sums;
use crate::flat::Flat;

/// Labelled points of a plane, counted and measured. Sums are of whole numbers, so that it does not matter in which order points come,
/// and in which parts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Measure {
    /// How many there are.
    pub points: u64,
    /// What they measure beyond all points of the cells that are of the plane alone.
    pub(super) beyond: Total,
}

impl Measure {
    /// Adds those of other points of the plane.
    pub fn add(&mut self, other: &Self) {
        self.points = self.points.wrapping_add(other.points);
        self.beyond.add(&other.beyond);
    }
}

/// Half of what 64 bits hold.
const LARGE: f64 = (1_u64 << 62) as f64;

/// Sums over points, in whole units.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Total {
    /// How many there are, less those that were taken away.
    pub(super) points: i64,
    /// Sum of where they are from the origin of the labeller.
    pub(super) places: [i128; 3],
    /// Sum of their squared distances from the plane.
    pub(super) squares: i128,
}

impl Total {
    /// Of all points of a cell.
    pub(super) fn of(sums: &Sums, origin: DVec3, plane: &Flat, units: Units) -> Self {
        // Numbers of points are whole.
        #[allow(clippy::cast_possible_truncation)]
        let (points, whole) = (sums.points as i64, |x: f64| {
            // Nearly all are of 64 bits, which takes no call.
            if x.abs() < LARGE { i128::from((x + 0.5_f64.copysign(x)) as i64) } else { x.round() as i128 }
        });
        let places = ((sums.mean - origin) * (sums.points * units.per_length)).to_array().map(whole);
        let squares = whole(sums.mean_square(plane) * sums.points * units.per_square);
        Self { points, places, squares }
    }

    pub(super) fn add(&mut self, other: &Self) {
        self.points = self.points.wrapping_add(other.points);
        self.squares = self.squares.wrapping_add(other.squares);
        for (sum, more) in self.places.iter_mut().zip(other.places) {
            *sum = sum.wrapping_add(more);
        }
    }

    /// Adds a point by where it is from the origin and how far from the plane: once, or −1 times to take it away.
    #[inline]
    pub(super) fn push(&mut self, place: DVec3, distance: f64, units: Units, times: f64) {
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
pub(super) struct Units {
    pub(super) per_length: f64,
    pub(super) per_square: f64,
}

impl Units {
    pub(super) fn of(edge: f64) -> Self {
        // The exponent bits alone are the power of two below.
        let below = f64::from_bits(edge.to_bits() & (0x7ff << 52));
        let length = below * (-24_f64).exp2();
        Self { per_length: 1.0 / length, per_square: 1.0 / (length * length * 16.0) }
    }
}

/// Labels of so many points on end are counted apart: to count one takes as long as several, if it has to wait for the one before.
pub(super) const LANES: usize = 4;

/// Planes that are looked at together when it is asked what was counted.
const TOGETHER: usize = 16;

/// What points measure that are labelled, plane by plane. It is as large as there are planes, and meant to be used for one part of the
/// points after the other: a place has many planes, and a part of it few.
#[derive(Debug, Clone, Default)]
pub struct Tally {
    pub(super) counts: Vec<[u64; LANES]>,
    pub(super) beyond: Vec<Total>,
    /// For some planes on end whether anything may be beyond the cells of one.
    pub(super) marks: Vec<bool>,
}

impl Tally {
    /// Of no points of so many planes.
    pub(super) fn of(planes: usize) -> Self {
        let marks = vec![false; planes.div_ceil(TOGETHER)];
        Self { counts: vec![[0; LANES]; planes], beyond: vec![Total::default(); planes], marks }
    }

    /// Hands out the numbers of the planes that points were of, and what they measure; the tally is as new.
    pub fn take(&mut self, mut take: impl FnMut(u32, Measure)) {
        let Self { counts, beyond, marks } = self;
        // A place may have ten thousand planes, and a view of it sees a few: most are looked at by their counts alone, several at a time.
        let some = counts.chunks_mut(TOGETHER).zip(beyond.chunks_mut(TOGETHER)).zip(marks);
        for (first, ((counts, beyond), mark)) in (0..).step_by(TOGETHER).zip(some) {
            if !*mark && counts.as_flattened().iter().fold(0, |any, count| any | count) == 0 {
                continue;
            }
            *mark = false;
            for (plane, (counts, beyond)) in (first..).zip(counts.iter_mut().zip(beyond)) {
                let measure = Measure { points: counts.iter().sum(), beyond: *beyond };
                if measure != Measure::default() {
                    take(plane, measure);
                    (*counts, *beyond) = ([0; LANES], Total::default());
                }
            }
        }
    }
}

/// Notes that something of a plane is beyond its cells.
// Into what `LabelEach` is dispatched to.
#[allow(clippy::inline_always)]
#[inline(always)]
pub(super) fn mark(marks: &mut [bool], plane: u32) {
    if let Some(mark) = marks.get_mut(plane as usize / TOGETHER) {
        *mark = true;
    }
}
