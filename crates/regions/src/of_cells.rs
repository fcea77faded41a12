//! What the points of cells are of.

use crate::near::Nearby;

/// Shares of the points of a cell that change by less have settled.
const SETTLED: f64 = 0.02;

/// What the points of each cell are of, and what they may be of, along the curve. Apart, for cells are asked of their neighbours' parts only.
#[derive(Debug, Clone)]
pub(crate) struct OfCells {
    pub(crate) nearby: Vec<Nearby>,
    pub(crate) parts: Vec<Parts>,
}

/// The points of a cell that are of a region.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Part {
    pub(crate) region: u32,
    /// How many are expected to be.
    pub(crate) expected: f64,
    /// How many are more probably of it than of any other.
    pub(crate) labelled: f64,
}

impl Part {
    /// Whether the whole sample of a cell of so many points is of it: shares of the points are rounded.
    pub(crate) fn is_all_of(&self, points: f64) -> bool {
        self.labelled + 0.5 >= points
    }
}

/// By number of the region.
#[derive(Debug, Clone)]
pub(crate) enum Parts {
    None,
    One(Part),
    Several(Box<[Part]>),
}

/// How the parts of a cell differ from what they were before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Difference {
    None,
    /// More of its points are of one region than before, by what matters.
    Shares,
    /// Its points are of other regions.
    Regions,
}

/// Codes of cells with parts of no region, and of several. Regions are fewer than cells, three to each.
pub(crate) const NOTHING: u32 = u32::MAX;
pub(crate) const SEVERAL: u32 = u32::MAX - 1;

impl Parts {
    pub(crate) fn of(parts: &[Part]) -> Self {
        match parts {
            [] => Self::None,
            [one] => Self::One(*one),
            parts => Self::Several(parts.into()),
        }
    }

    pub(crate) fn as_slice(&self) -> &[Part] {
        match self {
            Self::None => &[],
            Self::One(part) => std::slice::from_ref(part),
            Self::Several(parts) => parts,
        }
    }

    /// That which the whole sample of a cell of so many points is of.
    pub(crate) fn whole(&self, points: f64) -> Option<&Part> {
        self.as_slice().iter().find(|part| part.is_all_of(points))
    }

    pub(crate) fn regions(&self) -> impl Iterator<Item = u32> {
        self.as_slice().iter().map(|part| part.region)
    }

    /// The region, if it is one, in four bytes: to look at many cells.
    pub(crate) fn code(&self) -> u32 {
        match self {
            Self::None => NOTHING,
            Self::One(part) => part.region,
            Self::Several(_) => SEVERAL,
        }
    }

    pub(crate) fn retain(&mut self, keep: impl Fn(u32) -> bool) {
        if !self.regions().all(&keep) {
            let kept: Vec<Part> = self.as_slice().iter().filter(|part| keep(part.region)).copied().collect();
            *self = Self::of(&kept);
        }
    }

    /// How these differ from those before, of a cell of so many points.
    pub(crate) fn differ(&self, before: &Self, points: f64) -> Difference {
        let (now, before) = (self.as_slice(), before.as_slice());
        if !now.iter().map(|part| part.region).eq(before.iter().map(|part| part.region)) {
            return Difference::Regions;
        }
        let moved = |(now, before): (&Part, &Part)| (now.expected - before.expected).abs() > SETTLED * points;
        if now.iter().zip(before).any(moved) { Difference::Shares } else { Difference::None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parts(of: &[(u32, f64)]) -> Parts {
        let part =
            |(region, expected): &(u32, f64)| Part { region: *region, expected: *expected, labelled: 0.0 };
        Parts::of(&of.iter().map(part).collect::<Vec<_>>())
    }

    #[test]
    fn parts_are_told_by_their_code() {
        assert_eq!(parts(&[]).code(), NOTHING);
        assert_eq!(parts(&[(7, 1.0)]).code(), 7);
        assert_eq!(parts(&[(7, 1.0), (9, 1.0)]).code(), SEVERAL);
    }

    #[test]
    fn other_regions_matter_more_than_other_shares_and_small_changes_not_at_all() {
        let before = parts(&[(1, 60.0), (2, 40.0)]);
        assert_eq!(parts(&[(1, 61.0), (2, 39.0)]).differ(&before, 100.0), Difference::None);
        assert_eq!(parts(&[(1, 63.0), (2, 37.0)]).differ(&before, 100.0), Difference::Shares);
        assert_eq!(parts(&[(1, 60.0), (3, 40.0)]).differ(&before, 100.0), Difference::Regions);
        assert_eq!(parts(&[(1, 60.0)]).differ(&before, 100.0), Difference::Regions);
        assert_eq!(parts(&[]).differ(&parts(&[]), 1.0), Difference::None);
    }

    #[test]
    fn what_is_taken_out_leaves_the_others() {
        let mut some = parts(&[(1, 60.0), (2, 40.0), (5, 1.0)]);
        some.retain(|region| region != 2);
        assert_eq!(some.regions().collect::<Vec<_>>(), [1, 5]);
        some.retain(|region| region == 5);
        assert!(matches!(some, Parts::One(_)));
        some.retain(|_| false);
        assert_eq!(some.code(), NOTHING);
    }
}
