//! Points to runs: consecutive points in the same voxel, ordered by the part of the grid they are of.

use std::ops::Range;

use super::locate::{BATCH, Located, NOWHERE};
use super::records::WithRecords;
use super::{PointErrors, Taken, records, split};
use crate::block::PARTS;
use crate::key::Lattice;
use crate::{GridError, VoxelKey};

/// Points of a section. Their numbers fit into 16 bits.
pub(super) const SECTION: usize = 1 << 15;

/// Consecutive points of a section in the same voxel.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Run {
    pub(super) key: VoxelKey,
    /// Its slot in its part, once known.
    pub(super) slot: u32,
    first: u16,
    /// One less than the number of its points.
    more: u16,
}

impl Run {
    /// Number of its points.
    #[inline]
    pub(super) fn len(&self) -> usize {
        usize::from(self.more) + 1
    }

    /// Its points, counted within the section.
    #[inline]
    pub(super) fn points(&self) -> Range<usize> {
        let first = usize::from(self.first);
        first..first + self.len()
    }
}

/// Runs in the order of the points, with the part of each. Memory is kept from one section to the next.
#[derive(Debug)]
pub(super) struct Found {
    runs: Vec<(Run, u8)>,
    /// How many runs and points each part has.
    lengths: [[usize; 2]; PARTS],
}

impl Found {
    pub(super) fn new() -> Self {
        Self { runs: Vec::new(), lengths: [[0; 2]; PARTS] }
    }
}

/// The runs of a section and their points. Memory is kept from one to the next.
#[derive(Debug, Default)]
pub(super) struct Section {
    /// By part, then in the order of the points.
    runs: Vec<Run>,
    /// What is known of their points, in the same order: see [`WithRecords`].
    records: Vec<f64>,
    /// How many runs each part has, and how many numbers are known of their points.
    lengths: Vec<[usize; 2]>,
    /// What became of the points, those in the runs being taken.
    pub(super) taken: Taken,
}

impl Section {
    /// Finds the runs of some points, and where each point is from the centre of its voxel.
    pub(super) fn find(
        &mut self,
        points: &[[f64; 3]],
        errors: &PointErrors<'_>,
        lattice: Lattice,
        places: Option<&mut [[i16; 3]]>,
        found: &mut Found,
    ) {
        found.runs.clear();
        found.lengths = [[0; 2]; PARTS];
        self.taken = Taken::default();
        let (mut located, mut parts) = (Located::new(), [0; BATCH]);
        let mut places = places.map(|places| places.chunks_mut(BATCH));
        let mut open = Open { key: NOWHERE, part: 0, first: 0 };
        for (batch, points) in points.chunks(BATCH).enumerate() {
            let begin = batch * BATCH;
            let errors = errors.part(begin..begin + points.len());
            let inside = located.locate(points, lattice);
            if !(inside && errors.are_valid()) {
                located.refuse(points, &errors, lattice, &mut self.taken);
            }
            if let Some(places) = places.as_mut().and_then(Iterator::next) {
                places.copy_from_slice(&located.places[..points.len()]);
            }
            let keys = &located.keys[..points.len()];
            split::parts(keys, &mut parts);
            for ((first, key), part) in (begin..).zip(keys).zip(&parts) {
                if *key != open.key {
                    open.close(first, found);
                    open = Open { key: *key, part: *part, first };
                }
            }
        }
        open.close(points.len(), found);
        records::dispatch(errors, Sorting { section: self, found, points, lattice });
    }

    /// The runs of each part.
    pub(super) fn parts(&self) -> impl Iterator<Item = &[Run]> {
        let mut rest = self.runs.as_slice();
        self.lengths.iter().map(move |[runs, _]| {
            let (part, after) = rest.split_at(*runs);
            rest = after;
            part
        })
    }

    /// The runs of each part, to change, and what is known of their points.
    pub(super) fn parts_mut(&mut self) -> impl Iterator<Item = (&mut [Run], &[f64])> {
        let (mut runs, mut sums) = (self.runs.as_mut_slice(), self.records.as_slice());
        self.lengths.iter().map(move |lengths| {
            let (part, after) = std::mem::take(&mut runs).split_at_mut(lengths[0]);
            runs = after;
            let (of_part, after) = sums.split_at(lengths[1]);
            sums = after;
            (part, of_part)
        })
    }
}

/// Runs that are to be put in the order of their parts, with what is known of their points beside them: each part then reads on end.
struct Sorting<'a> {
    section: &'a mut Section,
    found: &'a Found,
    points: &'a [[f64; 3]],
    lattice: Lattice,
}

impl WithRecords for Sorting<'_> {
    fn with_records<const W: usize>(self, record: impl Fn([f64; 3], usize) -> [f64; W]) {
        let Self { section, found, points, lattice } = self;
        let Section { runs, records, lengths, .. } = section;
        let (mut next, mut total) = (found.lengths, [0; 2]);
        for next in &mut next {
            let lengths = std::mem::replace(next, total);
            total = [total[0] + lengths[0], total[1] + lengths[1]];
        }
        lengths.clear();
        lengths.extend(found.lengths.map(|[runs, points]| [runs, W * points]));
        runs.resize(total[0], Run::default());
        records.resize(W * total[1], 0.0);
        let records = records.as_chunks_mut().0;
        for (run, part) in &found.runs {
            let [next_run, next_point] = &mut next[usize::from(*part)];
            runs[*next_run] = *run;
            *next_run += 1;
            let anchor = lattice.anchor_of(run.key);
            for at in run.points() {
                records[*next_point] = record([0, 1, 2].map(|i| points[at][i] - anchor[i]), at);
                *next_point += 1;
            }
        }
    }
}

/// The run that goes on.
struct Open {
    key: VoxelKey,
    part: u8,
    first: usize,
}

impl Open {
    #[inline]
    fn close(&self, end: usize, found: &mut Found) {
        if self.key != NOWHERE {
            let [runs, points] = &mut found.lengths[usize::from(self.part)];
            *runs += 1;
            *points += end - self.first;
            // A section has no more points than 16 bits can count.
            #[allow(clippy::cast_possible_truncation)]
            let (first, more) = (self.first as u16, (end - self.first - 1) as u16);
            found.runs.push((Run { key: self.key, slot: 0, first, more }, self.part));
        }
    }
}

impl Taken {
    pub(super) fn refuse(&mut self, refusal: GridError) {
        if matches!(refusal, GridError::PointNotFinite { .. }) {
            self.not_finite += 1;
        } else {
            self.refused += 1;
            self.first_refusal.get_or_insert(refusal);
        }
    }
}
