//! Points to runs: consecutive points in the same voxel, ordered by the part of the grid they are of.

use super::locate::{BATCH, Located, NOWHERE};
use super::{PointErrors, Taken};
use crate::block::{BlockKey, PARTS, part_of};
use crate::key::key_of;
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
    /// Its points, counted within the section.
    #[inline]
    pub(super) fn points(&self) -> std::ops::Range<usize> {
        let first = usize::from(self.first);
        first..first + usize::from(self.more) + 1
    }
}

/// The runs of a section. Memory is kept from one to the next.
#[derive(Debug, Default)]
pub(super) struct Section {
    /// In the order of the points, with the part of each.
    found: Vec<(Run, u8)>,
    /// By part, then in the order of the points.
    runs: Vec<Run>,
    /// Those of part `i` are `starts[i]..starts[i + 1]`.
    starts: Vec<usize>,
    /// What became of the points, those in the runs being taken.
    pub(super) taken: Taken,
}

impl Section {
    /// Finds the runs of some points, and where each point is from the centre of its voxel.
    pub(super) fn find(
        &mut self,
        points: &[[f64; 3]],
        errors: &PointErrors<'_>,
        size: f64,
        places: Option<&mut [[f32; 3]]>,
    ) {
        self.found.clear();
        self.taken = Taken::default();
        let mut located = Located::new();
        let mut places = places.map(|places| places.chunks_mut(BATCH));
        let mut open = Open::default();
        for (batch, points) in points.chunks(BATCH).enumerate() {
            let begin = batch * BATCH;
            let errors = errors.part(begin..begin + points.len());
            let inside = located.locate(points, size);
            if !(inside && errors.are_valid()) {
                self.refuse(&mut located, points, &errors, size);
            }
            if let Some(places) = places.as_mut().and_then(Iterator::next) {
                places.copy_from_slice(&located.places[..points.len()]);
            }
            for (at, key) in (begin..).zip(&located.keys[..points.len()]) {
                if *key != open.key {
                    open.close(at, &mut self.found);
                    open.begin(*key, at);
                }
            }
        }
        open.close(points.len(), &mut self.found);
        self.sort();
    }

    /// Takes the points that cannot be inserted out of those located.
    #[cold]
    fn refuse(&mut self, located: &mut Located, points: &[[f64; 3]], errors: &PointErrors<'_>, size: f64) {
        for (at, point) in points.iter().enumerate() {
            let refusal = match key_of(*point, size) {
                Err(absent @ GridError::PointNotFinite { .. }) => Some(absent),
                key => errors.refusal(at).or(key.err()),
            };
            if let Some(refusal) = refusal {
                located.keys[at] = NOWHERE;
                located.places[at] = [0.0; 3];
                self.taken.refuse(refusal);
            }
        }
    }

    /// Puts the runs in the order of their parts.
    fn sort(&mut self) {
        self.starts.clear();
        self.starts.resize(PARTS + 1, 0);
        for (_, part) in &self.found {
            self.starts[usize::from(*part) + 1] += 1;
        }
        for part in 0..PARTS {
            self.starts[part + 1] += self.starts[part];
        }
        let mut next = [0; PARTS];
        next.copy_from_slice(&self.starts[..PARTS]);
        self.runs.clear();
        self.runs.resize(self.found.len(), Run::default());
        for (run, part) in &self.found {
            let next = &mut next[usize::from(*part)];
            self.runs[*next] = *run;
            *next += 1;
        }
    }

    /// The runs of each part.
    pub(super) fn parts(&self) -> impl Iterator<Item = &[Run]> {
        self.starts.windows(2).map(|ends| &self.runs[ends[0]..ends[1]])
    }

    /// The runs of each part, to change.
    pub(super) fn parts_mut(&mut self) -> impl Iterator<Item = &mut [Run]> {
        let mut rest = self.runs.as_mut_slice();
        self.starts.windows(2).map(move |ends| {
            let (part, after) = std::mem::take(&mut rest).split_at_mut(ends[1] - ends[0]);
            rest = after;
            part
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
    fn close(&self, end: usize, found: &mut Vec<(Run, u8)>) {
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
