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

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const UNIT: f64 = 1.0 / (1 << 15) as f64;

    fn sorted(places: impl Iterator<Item = [f32; 3]>) -> Vec<[u32; 3]> {
        let mut places: Vec<[u32; 3]> = places.map(|place| place.map(f32::to_bits)).collect();
        places.sort_unstable();
        places
    }

    proptest! {
        #[test]
        fn cells_have_the_sample_of_all_their_points_and_those_of_their_parts(
            places in prop::collection::vec((0..4_u32, prop::array::uniform3(-1.0..1.0_f32)), 0..200),
        ) {
            // Cells 2, 3 and 7 are of 1, cell 0 is of 4, and others have no parts.
            let (numbers, wholes) = ([2, 3, 7, 0], [1, 1, 1, 4]);
            let (mut apart, mut whole, mut points) = (Samples::new(UNIT), Samples::new(UNIT), [0; 4]);
            for (part, place) in &places {
                let part = *part as usize;
                points[part] += 1;
                apart.push(numbers[part], *place);
                whole.push(wholes[part], *place);
            }
            let part = |at: usize| PartOf { whole: wholes[at], part: numbers[at], points: points[at] };
            let together = apart.together([3, 2, 0, 1].map(part).to_vec());
            for of in 0..6 {
                prop_assert_eq!(sorted(together.sample(of).places()), sorted(whole.of(of)));
                let parts = || numbers.iter().zip(points).zip(wholes).filter(|(_, whole)| *whole == of);
                let all: u32 = parts().map(|((_, points), _)| points).sum();
                let sampled: Vec<([f32; 3], f64)> = together.sample(of).weighted(all.into()).collect();
                let expected = parts().flat_map(|((part, _), _)| apart.of(*part));
                prop_assert_eq!(sorted(sampled.iter().map(|(place, _)| *place)), sorted(expected));
                for ((part, points), _) in parts() {
                    let places: Vec<[f32; 3]> = apart.of(*part).collect();
                    let of_part = sampled.iter().filter(|(place, _)| places.contains(place));
                    let sum: f64 = of_part.map(|(_, each)| each).sum();
                    prop_assert!((sum - f64::from(points)).abs() < 1e-9);
                }
            }
        }
    }
}
