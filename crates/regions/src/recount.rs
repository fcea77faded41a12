//! How many points of wide cells are of which region, by all samples of their parts.

use std::ops::Range;

use rayon::prelude::*;

use crate::cube::Cube;
use crate::mixture::Mixture;
use crate::near::{Near, Nearby};
use crate::of_cells::{OfCells, Part, Parts};
use crate::samples::{Sample, Spot};

/// Cells that are handed to a thread at once.
const AT_ONCE: usize = 1024;

/// Memory that a thread works with.
#[derive(Default)]
struct Work<'s> {
    /// The cells that are counted, and where the samples of each end.
    cells: Vec<(usize, usize)>,
    /// The samples of their parts, and how many points these have.
    samples: Vec<Sample<'s>>,
    points: Vec<f64>,
    spots: Vec<Spot>,
    /// The places of these, one after the other, and where each sample begins.
    places: Vec<[f32; 3]>,
    starts: Vec<usize>,
    parts: Vec<Part>,
}

impl<'s, S: Fn(usize) -> Sample<'s> + Sync> Mixture<'_, S> {
    /// Counts what the points of wide cells are of once more, when it is known what is near them. Sixteen points of such a cell are enough
    /// to tell shares around, which are sums over many cells; its own points are told by the samples of its parts, up to eight times as
    /// many, and those of a part stand for its points alone.
    pub(crate) fn recount(&self, of_cells: &mut OfCells) {
        let OfCells { nearby, parts } = of_cells;
        let some = parts.par_chunks_mut(AT_ONCE).zip(nearby.par_chunks(AT_ONCE)).enumerate();
        some.for_each_init(Work::default, |work, (number, (parts, nearby))| {
            let first = number * AT_ONCE;
            work.unpack(self, first, nearby);
            let mut begin = 0;
            for number in 0..work.cells.len() {
                let (at, end) = work.cells[number];
                let points = self.field.cells[first + at].points;
                if let Some(counted) = work.counted(begin..end, &nearby[at], points, self.settings.reach) {
                    parts[at] = counted;
                }
                begin = end;
            }
        });
    }
}

impl<'s> Work<'s> {
    /// Finds the samples of the wide cells that something is near, the first of all cells being of this number: of many cells at once, so
    /// that the memory of one is not waited for before that of the next is asked for.
    fn unpack<S: Fn(usize) -> Sample<'s> + Sync>(
        &mut self,
        mixture: &Mixture<'_, S>,
        first: usize,
        nearby: &[Nearby],
    ) {
        let Self { cells, samples, points, spots, places, starts, .. } = self;
        let field = mixture.field;
        // As places are.
        #[allow(clippy::cast_possible_truncation)]
        let reach = mixture.settings.reach as f32;
        cells.clear();
        samples.clear();
        points.clear();
        for (at, nearby) in nearby.iter().enumerate() {
            let is_known = || match nearby {
                Nearby::None => true,
                Nearby::One(near) => {
                    Cube::of(field, first + at, field.anchors[first + at]).is_within(near, reach)
                }
                Nearby::Several(_) => false,
            };
            if field.is_wide(first + at) && !is_known() {
                let all = field.cells[first + at].points;
                for (sample, of_part) in (mixture.samples)(first + at).of_parts(all) {
                    samples.push(sample);
                    points.push(of_part);
                }
                cells.push((at, samples.len()));
            }
        }
        Sample::unpack(samples, spots, places, starts);
    }

    /// What so many points of a cell are of, by some of the samples; `None` without any.
    fn counted(&mut self, samples: Range<usize>, nearby: &Nearby, points: f64, reach: f64) -> Option<Parts> {
        let part = |near: &Near| Part { region: near.region, expected: 0.0, labelled: 0.0 };
        let parts = &mut self.parts;
        parts.clear();
        parts.extend(nearby.regions().iter().map(part));
        // As places are.
        #[allow(clippy::cast_possible_truncation)]
        let (mut all, single) = (0.0, reach as f32);
        for sample in samples {
            let places = &self.places[self.starts[sample]..self.starts[sample + 1]];
            let each = self.points[sample] / places.len() as f64;
            all += self.points[sample];
            // Nearly all are of the only region near, or beyond its reach.
            if let (Nearby::One(near), [part]) = (nearby, &mut parts[..]) {
                let within = places.iter().filter(|place| near.errors(**place, single).is_some()).count();
                part.labelled += within as f64 * each;
                continue;
            }
            for region in places.iter().filter_map(|place| nearby.label(*place, reach)) {
                if let Some(part) = parts.iter_mut().find(|part| part.region == region) {
                    part.labelled += each;
                }
            }
        }
        // The points of a part without a sample are of what those of the others are of.
        for part in parts.iter_mut() {
            part.labelled *= points / all;
            part.expected = part.labelled;
        }
        parts.retain(|part| part.labelled > 0.0);
        (all > 0.0).then(|| Parts::of(parts))
    }
}
