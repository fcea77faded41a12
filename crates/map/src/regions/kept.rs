//! Labels of points that are kept.

use std::borrow::Cow;
use std::ops::Range;

use rayon::prelude::*;

use super::tallies::{Measures, Tallies};
use super::{AT_ONCE, Grown, label_each};
use crate::mapper::{Kept, Tags, View, cell_number, in_one_piece, number_of, tag};
use crate::packed::unpacked;

impl Grown<'_> {
    /// The labels of all points, of which these are kept, and what they measure, view by view. They are in the memory of their cells, if that
    /// is given away and in one piece.
    pub(super) fn label_kept(&self, kept: Cow<'_, [Kept]>) -> (Tags, Vec<Measures>) {
        match in_one_piece(kept) {
            Ok(kept) => self.label_in_place(kept),
            Err(kept) => self.label_beside(&kept),
        }
    }

    fn label_beside(&self, kept: &[Kept]) -> (Tags, Vec<Measures>) {
        let (labeller, unit) = (&self.found.labeller, self.unit);
        let mut tags = Tags::with_capacity(self.mapper.len());
        let points: Vec<usize> = kept.iter().map(|kept| kept.places.len()).collect();
        let by_view = self.by_view(&points, |part, range, tallies| {
            let tags = tags.more(range.len());
            let Kept { cells, places } = &kept[part];
            let cells = cells[range.clone()].par_chunks(AT_ONCE);
            let places = places[range].par_chunks(AT_ONCE);
            let all = cells.zip(places).zip(tags.par_chunks_mut(AT_ONCE));
            let begin = || tallies.borrow(labeller);
            all.for_each_init(begin, |tally, ((cells, places), tags)| {
                let cells = cells.iter().map(|cell| cell.map(cell_number));
                let points = cells.zip(unpacked(places, unit)).zip(tags);
                label_each(labeller, points, tally, |label, region| *label = tag(region));
            });
        });
        (tags, by_view)
    }

    fn label_in_place(&self, kept: Kept) -> (Tags, Vec<Measures>) {
        let (labeller, unit) = (&self.found.labeller, self.unit);
        let Kept { cells, places } = kept;
        let mut tags = Tags::of(cells);
        let by_view = self.by_view(&[places.len()], |_, range, tallies| {
            let places = places[range.clone()].par_chunks(AT_ONCE);
            let tags = tags.as_mut_slice()[range].par_chunks_mut(AT_ONCE);
            let begin = || tallies.borrow(labeller);
            tags.zip(places).for_each_init(begin, |tally, (tags, places)| {
                let points = tags.iter_mut().zip(unpacked(places, unit));
                let points = points.map(|(tag, place)| ((number_of(*tag), place), tag));
                label_each(labeller, points, tally, |label, region| *label = tag(region));
            });
        });
        (tags, by_view)
    }

    /// What the points of each view measure, once `label` has labelled those of a part at these places in it: views follow each other in
    /// parts of so many points.
    fn by_view(
        &self,
        parts: &[usize],
        mut label: impl FnMut(usize, Range<usize>, &Tallies),
    ) -> Vec<Measures> {
        let (tallies, mut part, mut first) = (Tallies::default(), 0, 0);
        let measures = |view: &View| {
            let mut left = view.points;
            while let Some(points) = parts.get(part).filter(|_| left > 0) {
                let end = (first + left).min(*points);
                label(part, first..end, &tallies);
                left -= end - first;
                (part, first) = if end == *points { (part + 1, 0) } else { (part, end) };
            }
            let mut measures = Measures::new();
            tallies.add_to(&mut measures);
            measures
        };
        self.mapper.views().iter().map(measures).collect()
    }
}
