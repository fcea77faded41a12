//! Samples of several cells together.

use super::{Sample, Samples};

/// A cell that is a part of a larger one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct PartOf {
    /// The number of the larger cell, with others.
    pub whole: u32,
    /// Its own.
    pub part: u32,
    /// How many points it has.
    pub points: u32,
}

/// The samples of cells that are made of others: one of up to sixteen points of each, and beside it those of its parts, which tell more.
/// See [`Samples::together`].
#[derive(Debug, Clone)]
pub struct Together<'s> {
    samples: Samples,
    of: &'s Samples,
    /// The number of each part there, and how many points it has; by the cell that it is a part of.
    parts: Vec<(u32, u32)>,
    /// Where the parts of a cell begin, and those of the last end.
    starts: Vec<u32>,
}

impl<'s> Together<'s> {
    pub(super) fn of(all: &'s Samples, mut parts: Vec<PartOf>) -> Self {
        parts.sort_unstable();
        let mut samples = Samples { stripes: Default::default(), unit: all.unit };
        let mut starts = vec![0];
        for (at, PartOf { whole, part, .. }) in (0..).zip(&parts) {
            // Where those before end, of which some may have no parts.
            starts.resize(*whole as usize + 1, at);
            samples.merge(*whole, all, *part);
        }
        // Cells are numbered with 32 bits.
        starts.push(u32::try_from(parts.len()).unwrap_or(u32::MAX));
        let parts = parts.iter().map(|of| (of.part, of.points)).collect();
        Self { samples, of: all, parts, starts }
    }

    /// The sample of the larger cell of this number; empty for one without parts.
    pub fn sample(&self, whole: u32) -> Sample<'_> {
        self.samples.sample(whole).with_parts(whole, self)
    }

    /// The samples of the parts of a cell, and how many points each part has.
    pub(super) fn parts(&self, whole: u32) -> impl Iterator<Item = (Sample<'_>, f64)> {
        let at = whole as usize;
        let range = self.starts.get(at).zip(self.starts.get(at + 1));
        let parts = range.and_then(|(first, end)| self.parts.get(*first as usize..*end as usize));
        parts.unwrap_or(&[]).iter().map(|(part, points)| (self.of.sample(*part), f64::from(*points)))
    }
}
