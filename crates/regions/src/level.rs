//! The same cells at a coarser resolution.

use foldhash::fast::FixedState;
use hashbrown::HashMap;

/// Cells in groups of 2ˡ × 2ˡ × 2ˡ, and which groups touch.
#[derive(Debug, Clone)]
pub(crate) struct Level {
    /// The group of each cell.
    of: Vec<u32>,
    /// Group `i` has the cells `cells[starts[i]..starts[i + 1]]`.
    starts: Vec<usize>,
    cells: Vec<u32>,
    /// And touches `near[near_starts[i]..near_starts[i + 1]]`.
    near_starts: Vec<usize>,
    near: Vec<u32>,
}

impl Level {
    /// Groups cells by the upper bits of their keys. Groups are numbered by the first of their cells.
    pub(crate) fn of(keys: &[[i32; 3]], level: u32) -> Self {
        let mut index: HashMap<[i32; 3], u32, FixedState> = HashMap::default();
        let mut groups: Vec<[i32; 3]> = Vec::new();
        let mut of = Vec::with_capacity(keys.len());
        for key in keys {
            let group = key.map(|k| k >> level);
            of.push(*index.entry(group).or_insert_with(|| {
                groups.push(group);
                number(groups.len() - 1)
            }));
        }
        let mut starts = vec![0_usize; groups.len() + 1];
        for group in &of {
            starts[*group as usize + 1] += 1;
        }
        for group in 0..groups.len() {
            starts[group + 1] += starts[group];
        }
        let mut next = starts.clone();
        let mut cells = vec![0; keys.len()];
        for (cell, group) in of.iter().enumerate() {
            let place = &mut next[*group as usize];
            cells[*place] = number(cell);
            *place += 1;
        }
        let mut near_starts = vec![0];
        let mut near = Vec::new();
        for [x, y, z] in &groups {
            for step in (0..27).filter(|step| *step != 13) {
                let (dx, dy, dz) = (step / 9 - 1, step / 3 % 3 - 1, step % 3 - 1);
                // Keys at the end of the range have no neighbour beyond it.
                let beside = (x.checked_add(dx), y.checked_add(dy), z.checked_add(dz));
                if let (Some(x), Some(y), Some(z)) = beside {
                    near.extend(index.get(&[x, y, z]));
                }
            }
            near_starts.push(near.len());
        }
        Self { of, starts, cells, near_starts, near }
    }

    /// Number of groups.
    pub(crate) fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// The group of a cell.
    pub(crate) fn group(&self, cell: usize) -> u32 {
        self.of[cell]
    }

    /// The cells of a group, in rising order.
    pub(crate) fn cells(&self, group: usize) -> &[u32] {
        &self.cells[self.starts[group]..self.starts[group + 1]]
    }

    /// The groups that share a face, an edge or a corner with a group.
    pub(crate) fn near(&self, group: usize) -> &[u32] {
        &self.near[self.near_starts[group]..self.near_starts[group + 1]]
    }

    /// The cells of a group and of those it touches.
    pub(crate) fn around(&self, group: usize) -> impl Iterator<Item = u32> {
        let groups = std::iter::once(number(group)).chain(self.near(group).iter().copied());
        groups.flat_map(|group| self.cells(group as usize).iter().copied())
    }
}

#[allow(clippy::cast_possible_truncation, reason = "fewer cells than 2³²: `Field::of` sees to it")]
fn number(place: usize) -> u32 {
    place as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::collection::btree_set;
    use proptest::prelude::*;

    #[test]
    fn no_cells_are_no_groups() {
        let level = Level::of(&[], 1);
        assert_eq!((level.len(), level.near.len()), (0, 0));
    }

    #[test]
    fn negative_keys_are_grouped_as_positive_ones() {
        let level = Level::of(&[[-1, 0, 0], [-2, 0, 0], [0, 0, 0], [1, 0, 0]], 1);
        assert_eq!(level.of, [0, 0, 1, 1]);
        assert_eq!(level.near(0), [1]);
    }

    #[test]
    fn the_end_of_the_range_has_neighbours_on_one_side() {
        let level = Level::of(&[[i32::MAX, 0, 0], [i32::MAX - 1, 0, 0], [i32::MIN, 0, 0]], 0);
        assert_eq!(level.near(0), [1]);
        assert_eq!(level.near(2), []);
    }

    proptest! {
        #[test]
        fn groups_are_those_of_brute_force(
            keys in btree_set(prop::array::uniform3(-9..9_i32), 0..60),
            level in 0..4_u32,
        ) {
            let keys: Vec<[i32; 3]> = keys.into_iter().collect();
            let found = Level::of(&keys, level);
            let group = |k: &[i32; 3]| k.map(|x| x.div_euclid(1 << level));
            for (cell, key) in keys.iter().enumerate() {
                let own = found.group(cell) as usize;
                let members: Vec<u32> = (0..).zip(&keys).filter(|(_, k)| group(k) == group(key)).map(|(i, _)| i).collect();
                prop_assert_eq!(found.cells(own), &members[..]);
                let mut around: Vec<u32> = found.around(own).collect();
                around.sort_unstable();
                let touches = |k: &[i32; 3]| (0..3).all(|i| (group(k)[i] - group(key)[i]).abs() <= 1);
                let expected: Vec<u32> = (0..).zip(&keys).filter(|(_, k)| touches(k)).map(|(i, _)| i).collect();
                prop_assert_eq!(around, expected);
            }
        }
    }
}
