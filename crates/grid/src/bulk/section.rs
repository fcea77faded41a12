//! Points in the order of the parts of the grid they are of.

use super::locate::{BATCH, Located, NOWHERE};
use super::{PointErrors, Taken, split};
use crate::GridError;
use crate::ahead::Ahead;
use crate::block::PARTS;
use crate::key::Lattice;

/// Points of a section. Their numbers fit into 16 bits.
pub(super) const SECTION: usize = 1 << 15;

/// So many points further on in a part its memory is asked for: the next line.
const NEXT: usize = 3;

/// The part of points that are in no voxel: behind all.
const NO_PART: u8 = {
    assert!(PARTS < 256, "a part is told in a byte");
    #[allow(clippy::cast_possible_truncation)]
    let part = PARTS as u8;
    part
};

/// Some points one after the other, put in the order of their parts: each part then reads on end. Memory is kept from one to the next.
#[derive(Debug, Default)]
pub(super) struct Section {
    /// By part, then in their order.
    points: Vec<[f64; 3]>,
    /// Their errors, if each has its own, in the same order.
    errors: Vec<f64>,
    /// Which point of the section each is.
    numbers: Vec<u16>,
    /// The slot of each in its part, once known.
    slots: Vec<u32>,
    /// How many points each part has.
    lengths: Vec<usize>,
    /// What became of the points, those in parts being taken.
    pub(super) taken: Taken,
}

/// What a part has of a section, to be added.
#[derive(Debug)]
pub(super) struct Portion<'s> {
    pub(super) points: &'s [[f64; 3]],
    pub(super) errors: PointErrors<'s>,
    pub(super) numbers: &'s [u16],
    pub(super) slots: &'s mut [u32],
}

impl Portion<'_> {
    /// The same, some points at a time.
    pub(super) fn batches(&mut self) -> impl Iterator<Item = Portion<'_>> {
        let (errors, length) = (self.errors, self.points.len());
        let begins = (0..length).step_by(BATCH);
        let slots = self.slots.chunks_mut(BATCH);
        let of_points = self.points.chunks(BATCH).zip(self.numbers.chunks(BATCH));
        begins.zip(of_points).zip(slots).map(move |((begin, (points, numbers)), slots)| Portion {
            points,
            errors: errors.part(begin..begin + points.len()),
            numbers,
            slots,
        })
    }
}

/// Where the points of a section are to go. Memory is kept from one to the next.
#[derive(Debug, Default)]
pub(super) struct Targets {
    parts: Vec<u8>,
    targets: Vec<u16>,
}

impl Targets {
    /// Tells the part of each point, and where it is from the centre of its voxel; returns how many points each part has.
    fn split(
        &mut self,
        points: &[[f64; 3]],
        errors: &PointErrors<'_>,
        lattice: Lattice,
        places: Option<&mut [[i16; 3]]>,
        taken: &mut Taken,
    ) -> [usize; PARTS + 1] {
        self.parts.clear();
        let mut lengths = [0; PARTS + 1];
        let (mut located, mut parts) = (Located::new(), [0; BATCH]);
        let mut places = places.map(|places| places.chunks_mut(BATCH));
        let ahead = Ahead::new();
        let mut rest = points;
        for (batch, points) in points.chunks(BATCH).enumerate() {
            let begin = batch * BATCH;
            let errors = errors.part(begin..begin + points.len());
            let all = located.locate(points, lattice) && errors.are_valid();
            if !all {
                located.refuse(points, &errors, lattice, taken);
            }
            if let Some(places) = places.as_mut().and_then(Iterator::next) {
                places.copy_from_slice(&located.places[..points.len()]);
            }
            let (keys, parts) = (&located.keys[..points.len()], &mut parts[..points.len()]);
            split::parts(keys, parts);
            if !all {
                let refused = keys.iter().zip(&mut *parts).filter(|(key, _)| **key == NOWHERE);
                refused.for_each(|(_, part)| *part = NO_PART);
            }
            rest = &rest[points.len()..];
            for (at, part) in parts.iter().enumerate() {
                if let Some(later) = rest.get(at) {
                    ahead.fetch(later);
                }
                lengths[usize::from(*part)] += 1;
            }
            self.parts.extend_from_slice(parts);
        }
        lengths
    }

    /// Tells where each point is to go.
    fn order(&mut self, lengths: &[usize; PARTS + 1]) {
        let (mut next, mut total) = (*lengths, 0);
        for next in &mut next {
            total += std::mem::replace(next, total);
        }
        self.targets.clear();
        self.targets.extend(self.parts.iter().map(|part| {
            let next = &mut next[usize::from(*part)];
            // No more than points of a section.
            #[allow(clippy::cast_possible_truncation)]
            let target = *next as u16;
            *next += 1;
            target
        }));
    }
}

impl Section {
    /// Puts points, no more than [`SECTION`], in order, and tells where each is from the centre of its voxel.
    pub(super) fn sort(
        &mut self,
        points: &[[f64; 3]],
        errors: &PointErrors<'_>,
        lattice: Lattice,
        places: Option<&mut [[i16; 3]]>,
        to: &mut Targets,
    ) {
        self.taken = Taken::default();
        let lengths = to.split(points, errors, lattice, places, &mut self.taken);
        to.order(&lengths);
        self.lengths.clear();
        self.lengths.extend_from_slice(&lengths[..PARTS]);
        self.numbers.resize(points.len(), 0);
        for (number, target) in (0..).zip(&to.targets) {
            self.numbers[usize::from(*target)] = number;
        }
        self.points.resize(points.len(), [0.0; 3]);
        put(points, &to.targets, &mut self.points);
        self.errors.resize(errors.width() * points.len(), 0.0);
        match errors {
            PointErrors::None | PointErrors::Same(_) => {}
            PointErrors::Each(sigmas) => put(sigmas, &to.targets, &mut self.errors),
            PointErrors::Axes(sigmas) => put(sigmas, &to.targets, self.errors.as_chunks_mut().0),
            PointErrors::Covariances(all) => put(all, &to.targets, self.errors.as_chunks_mut().0),
        }
        self.slots.resize(points.len(), 0);
    }

    /// What each part is to add, with errors of the kind they were told in.
    pub(super) fn portions<'s>(&'s mut self, kind: PointErrors<'s>) -> impl Iterator<Item = Portion<'s>> {
        let Self { points, errors, numbers, slots, lengths, .. } = self;
        let (points, numbers, errors) = (points.as_slice(), numbers.as_slice(), errors.as_slice());
        let (mut begin, mut rest) = (0, slots.as_mut_slice());
        lengths.iter().map(move |length| {
            let range = begin..begin + length;
            begin = range.end;
            let (slots, after) = std::mem::take(&mut rest).split_at_mut(*length);
            rest = after;
            let errors = kind.of_numbers(errors).part(range.clone());
            Portion { points: &points[range.clone()], errors, numbers: &numbers[range], slots }
        })
    }

    /// Which points of the section each part has, and their slots there.
    pub(super) fn found(&self) -> impl Iterator<Item = (&[u16], &[u32])> {
        let mut begin = 0;
        self.lengths.iter().map(move |length| {
            let range = begin..begin + length;
            begin = range.end;
            (&self.numbers[range.clone()], &self.slots[range])
        })
    }
}

/// Puts each where it is to go. There are as many places far from each other as parts: what comes next to each is asked for.
fn put<T: Copy>(from: &[T], targets: &[u16], to: &mut [T]) {
    let ahead = Ahead::new();
    for (what, target) in from.iter().zip(targets) {
        let target = usize::from(*target);
        to[target] = *what;
        if let Some(next) = to.get(target + NEXT) {
            ahead.fetch(next);
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
