//! Points to runs: consecutive points in the same voxel, ordered by the part of the grid they are of.

use std::ops::Range;

use super::locate::{BATCH, Located, NOWHERE};
use super::{PointErrors, Taken, records};
use crate::block::{BlockKey, PARTS, part_of};
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

/// Runs in the order of the points, with the part of each.
pub(super) type Found = Vec<(Run, u8)>;

/// The runs of a section and their sums. Memory is kept from one to the next.
#[derive(Debug, Default)]
pub(super) struct Section {
    /// By part, then in the order of the points.
    runs: Vec<Run>,
    /// What each of them adds, in the same order: see [`records::write`].
    sums: Vec<f64>,
    /// How many runs and sums each part has.
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
        found.clear();
        self.taken = Taken::default();
        let mut located = Located::new();
        let mut places = places.map(|places| places.chunks_mut(BATCH));
        let mut open = Open::default();
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
            for (at, key) in (begin..).zip(&located.keys[..points.len()]) {
                if *key != open.key {
                    open.close(at, found);
                    open.begin(*key, at);
                }
            }
        }
        open.close(points.len(), found);
        self.sort(found, points, errors, lattice);
    }

    /// Puts the runs in the order of their parts, and what they add beside them: each part then reads on end.
    fn sort(&mut self, found: &[(Run, u8)], points: &[[f64; 3]], errors: &PointErrors<'_>, lattice: Lattice) {
        let mut next = [[0; 2]; PARTS];
        for (run, part) in found {
            let [runs, sums] = &mut next[usize::from(*part)];
            *runs += 1;
            *sums += run.len() * records::width(errors);
        }
        self.lengths.clear();
        self.lengths.extend_from_slice(&next);
        let mut total = [0; 2];
        for next in &mut next {
            let lengths = std::mem::replace(next, total);
            total = [total[0] + lengths[0], total[1] + lengths[1]];
        }
        self.runs.resize(total[0], Run::default());
        self.sums.resize(total[1], 0.0);
        for (run, part) in found {
            let [at, sums_at] = &mut next[usize::from(*part)];
            self.runs[*at] = *run;
            *at += 1;
            let len = run.len() * records::width(errors);
            let sums = &mut self.sums[*sums_at..*sums_at + len];
            *sums_at += len;
            let anchor = lattice.anchor_of(run.key);
            records::write(&points[run.points()], anchor, errors, run.points(), sums);
        }
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

    /// The runs of each part, to change, and what they add.
    pub(super) fn parts_mut(&mut self) -> impl Iterator<Item = (&mut [Run], &[f64])> {
        let (mut runs, mut sums) = (self.runs.as_mut_slice(), self.sums.as_slice());
        self.lengths.iter().map(move |lengths| {
            let (part, after) = std::mem::take(&mut runs).split_at_mut(lengths[0]);
            runs = after;
            let (of_part, after) = sums.split_at(lengths[1]);
            sums = after;
            (part, of_part)
        })
    }
}

/// The run that goes on, and the block it is in.
struct Open {
    key: VoxelKey,
    first: usize,
    block: Option<BlockKey>,
    part: u8,
}

impl Default for Open {
    fn default() -> Self {
        Self { key: NOWHERE, first: 0, block: None, part: 0 }
    }
}

impl Open {
    #[inline]
    fn begin(&mut self, key: VoxelKey, first: usize) {
        (self.key, self.first) = (key, first);
        let block = BlockKey::of(key);
        if self.block != Some(block) {
            self.block = Some(block);
            // There are few parts.
            #[allow(clippy::cast_possible_truncation)]
            let part = part_of(block.hash()) as u8;
            self.part = part;
        }
    }

    #[inline]
    fn close(&self, end: usize, found: &mut Found) {
        if self.key != NOWHERE {
            // A section has no more points than 16 bits can count.
            #[allow(clippy::cast_possible_truncation)]
            let (first, more) = (self.first as u16, (end - self.first - 1) as u16);
            found.push((Run { key: self.key, slot: 0, first, more }, self.part));
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
