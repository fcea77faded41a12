//! How many points of each cell are of which plane.

/// Some points of a cell, all of one plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Share {
    /// The place of the cell.
    pub cell: u32,
    /// The number of the plane.
    pub region: u32,
    /// How many there are.
    pub points: u32,
}

/// Shares in the order of so many cells, and of the planes in each: counted and put in their place, which takes half the memory of a sort.
pub(crate) fn in_order(cells: usize, shares: impl Iterator<Item = Share> + Clone) -> Vec<Share> {
    let mut next: Vec<u32> = vec![0; cells];
    for share in shares.clone() {
        next[share.cell as usize] += 1;
    }
    let mut begin = 0;
    for next in &mut next {
        begin += std::mem::replace(next, begin);
    }
    let mut all = vec![Share { cell: 0, region: 0, points: 0 }; begin as usize];
    for share in shares {
        let next = &mut next[share.cell as usize];
        all[*next as usize] = share;
        *next += 1;
    }
    all.chunk_by_mut(|a, b| a.cell == b.cell)
        .for_each(|of_cell| of_cell.sort_unstable_by_key(|share| share.region));
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn shares_are_those_that_are_sorted(
            given in prop::collection::btree_map((0..20_u32, 0..5_u32), 1..9_u32, 0..60)
                .prop_map(|of| of.into_iter().map(|((cell, region), points)| Share { cell, region, points }).collect::<Vec<_>>())
                .prop_shuffle(),
        ) {
            let mut sorted = given.clone();
            sorted.sort_by_key(|share| (share.cell, share.region));
            prop_assert_eq!(in_order(20, given.iter().copied()), sorted);
        }
    }
}
