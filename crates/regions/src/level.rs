//! The same cells at a coarser resolution.

use foldhash::fast::FixedState;
use hashbrown::HashMap;
use rayon::prelude::*;

use crate::places::Places;

/// Groups whose neighbours are found together, and kept in a list of their own: none is copied when more come, and each fits where little memory
/// is free.
const AT_ONCE: usize = 256;
/// Groups that touch one, of nearly all scenes no more in the mean: surfaces are some cells thick where points have errors.
const USUALLY_NEAR: usize = 16;

/// Cells in groups of 2ˡ × 2ˡ × 2ˡ, and which groups touch. Cells are in the order of a space-filling curve, so that the cells of a
/// group follow each other, and the groups of a level those of the next.
#[derive(Debug, Clone)]
pub(crate) struct Level {
    /// Group `i` has the cells from `starts[i]` to `starts[i + 1]`.
    starts: Vec<u32>,
    /// The group of each cell.
    of: Vec<u32>,
    /// What each touches, [some](AT_ONCE) to a list.
    near: Vec<Near>,
}

/// The groups that each of some touches.
#[derive(Debug, Clone, PartialEq)]
struct Near {
    /// The `i`th touches `groups[starts[i]..starts[i + 1]]`.
    starts: Vec<u32>,
    groups: Vec<u32>,
}

impl Near {
    /// Of none, with room for so many.
    fn with_capacity(count: usize) -> Self {
        let mut starts = Vec::with_capacity(count + 1);
        starts.push(0);
        Self { starts, groups: Vec::with_capacity(USUALLY_NEAR * count) }
    }

    /// Ends what the next one touches.
    fn end(&mut self) {
        self.starts.push(number(self.groups.len()));
    }
}

impl Level {
    /// All resolutions, the finest first, of cells that are sorted and of different keys. `wide` tells which are as large as a group of the
    /// next level, and alone in it; it may be empty.
    pub(crate) fn all(keys: &[[u32; 3]], wide: &[bool], levels: u32) -> Vec<Self> {
        let mut all = vec![Self::new((0..=number(keys.len())).collect())];
        // The upper bits of the keys, and where the children of each group begin; of all levels but the finest.
        let mut coarser: Vec<(Vec<[u32; 3]>, Vec<u32>)> = Vec::new();
        for _ in 1..levels {
            let found = runs(coarser.last().map_or(keys, |(below, _)| below));
            let below = |child: &u32| all.last().map_or(0, |below| below.starts[*child as usize]);
            all.push(Self::new(found.1.iter().map(below).collect()));
            coarser.push(found);
        }
        if let Some(top) = all.last_mut() {
            top.look_up(coarser.last().map_or(keys, |(top, _)| top));
        }
        for level in (1..all.len()).rev() {
            let (below, above) = all.split_at_mut(level);
            let own = level.checked_sub(2).map_or(keys, |below| &coarser[below].0);
            if let (Some(below), Some(above)) = (below.last_mut(), above.first()) {
                let parents = (above, &coarser[level - 1]);
                below.look_among_children(own, parents, if level == 1 { wide } else { &[] });
            }
        }
        all
    }

    /// Groups that begin at these cells, the last of which is after all.
    fn new(starts: Vec<u32>) -> Self {
        let mut of = Vec::with_capacity(starts.last().map_or(0, |cells| *cells as usize));
        for (group, ends) in (0..).zip(starts.windows(2)) {
            of.resize(of.len() + (ends[1] - ends[0]) as usize, group);
        }
        Self { starts, of, near: Vec::new() }
    }

    /// Finds the groups that touch, in a table of all.
    fn look_up(&mut self, keys: &[[u32; 3]]) {
        let index: HashMap<[u32; 3], u32, FixedState> = keys.iter().copied().zip(0..).collect();
        for keys in keys.chunks(AT_ONCE) {
            let mut near = Near::with_capacity(keys.len());
            for [x, y, z] in keys {
                for [dx, dy, dz] in steps() {
                    // Keys at the end of the range have no neighbour beyond it.
                    let beside =
                        (x.checked_add_signed(dx), y.checked_add_signed(dy), z.checked_add_signed(dz));
                    if let (Some(x), Some(y), Some(z)) = beside {
                        near.groups.extend(index.get(&[x, y, z]));
                    }
                }
                near.end();
            }
            self.near.push(near);
        }
    }

    /// Finds the groups that touch among the children of the parents that do: those around the children of one parent fill at most
    /// 4 × 4 × 4 places.
    fn look_among_children(
        &mut self,
        keys: &[[u32; 3]],
        (parents, (keys_of_parents, children)): (&Self, &(Vec<[u32; 3]>, Vec<u32>)),
        wide: &[bool],
    ) {
        let child = |parent: usize| children[parent]..children[parent + 1];
        let is_wide = |group: u32| wide.get(group as usize) == Some(&true);
        let of_some = |first: usize| {
            let groups = first..(first + AT_ONCE).min(keys.len());
            let mut near = Near::with_capacity(groups.len());
            // That of the first, and those after it.
            let before = children.partition_point(|child| *child as usize <= first) - 1;
            for parent in
                (before..parents.len()).take_while(|parent| (child(*parent).start as usize) < groups.end)
            {
                let mut places = Places::around(keys_of_parents[parent]);
                for other in std::iter::once(number(parent)).chain(parents.near(parent).iter().copied()) {
                    for group in child(other as usize) {
                        if wide.is_empty() {
                            places.put(group, keys[group as usize]);
                        } else {
                            places.put_any(group, keys[group as usize], is_wide(group));
                        }
                    }
                }
                for group in child(parent).filter(|group| groups.contains(&(*group as usize))) {
                    places.touching(group, keys[group as usize], is_wide, &mut near.groups);
                    near.end();
                }
            }
            // What is not used is free for others.
            near.groups.shrink_to_fit();
            near
        };
        self.near = (0..keys.len()).into_par_iter().step_by(AT_ONCE).map(of_some).collect();
    }

    /// Number of groups.
    pub(crate) fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// The group of a cell.
    pub(crate) fn group(&self, cell: usize) -> u32 {
        self.of[cell]
    }

    /// The cells of a group.
    pub(crate) fn cells(&self, group: usize) -> std::ops::Range<u32> {
        self.starts[group]..self.starts[group + 1]
    }

    /// The groups that share a face, an edge or a corner with a group.
    pub(crate) fn near(&self, group: usize) -> &[u32] {
        let (near, at) = (&self.near[group / AT_ONCE], group % AT_ONCE);
        &near.groups[near.starts[at] as usize..near.starts[at + 1] as usize]
    }
}

/// The steps to the 26 neighbours.
fn steps() -> impl Iterator<Item = [i32; 3]> {
    (0..27).filter(|step| *step != 13).map(|step| [step / 9 - 1, step / 3 % 3 - 1, step % 3 - 1])
}

/// The groups of twice the edge, and where the children of each begin.
fn runs(keys: &[[u32; 3]]) -> (Vec<[u32; 3]>, Vec<u32>) {
    let (mut groups, mut starts): (Vec<[u32; 3]>, Vec<u32>) = (Vec::new(), Vec::new());
    for (child, key) in (0..).zip(keys) {
        let group = key.map(|k| k >> 1);
        if groups.last() != Some(&group) {
            groups.push(group);
            starts.push(child);
        }
    }
    starts.push(number(keys.len()));
    (groups, starts)
}

#[allow(clippy::cast_possible_truncation, reason = "fewer cells than 2³²: `Field::of` sees to it")]
pub(crate) fn number(place: usize) -> u32 {
    place as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::Curve;
    use proptest::collection::btree_set;
    use proptest::prelude::*;

    fn levels(keys: &[[i32; 3]]) -> (Vec<Level>, Vec<u32>) {
        let curve = Curve::of(keys.len(), |at| keys[at]);
        (all(&curve.along, &[]), curve.order)
    }

    /// The same on one thread as on two.
    fn all(keys: &[[u32; 3]], wide: &[bool]) -> Vec<Level> {
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| Level::all(keys, wide, 4))
        };
        let [one, two] = [1, 2].map(on);
        for (one, two) in one.iter().zip(&two) {
            assert_eq!(one.near, two.near);
        }
        one
    }

    /// What each cell touches is what it shares a face, an edge or a corner with; of a cell it is told whether it is wide.
    fn assert_touch_as_by_brute_force(cells: &[([i32; 3], bool)]) {
        let Curve { along: sorted, order, .. } = Curve::of(cells.len(), |at| cells[at].0);
        let along: Vec<([i32; 3], bool)> = order.iter().map(|at| cells[*at as usize]).collect();
        let is_wide: Vec<bool> = along.iter().map(|(_, wide)| *wide).collect();
        let levels = all(&sorted, &is_wide);
        for (cell, (key, wide)) in (0..).zip(&along) {
            let ends = |key: i32, wide: bool| [key, key + 1 + i32::from(wide)];
            let touches = |other: &([i32; 3], bool)| {
                (0..3).all(|i| {
                    let ([a, b], [c, d]) = (ends(key[i], *wide), ends(other.0[i], other.1));
                    a <= d && c <= b
                })
            };
            let others = (0..).zip(&along).filter(|(at, other)| *at != cell && touches(other));
            let expected: Vec<u32> = others.map(|(at, _)| at).collect();
            let mut near = levels[0].near(cell as usize).to_vec();
            near.sort_unstable();
            assert_eq!(near, expected);
        }
    }

    #[test]
    fn what_touches_is_found_where_lists_end() {
        // A surface two cells thick, wide on one side: more groups than one list holds, on both of the finest levels.
        let cell = |k: i32| [k % 60, k / 60 % 60, k / 3600 + k * 7 % 3];
        let narrow = (0..7200).map(cell).filter(|[x, ..]| *x < 40).map(|key| (key, false));
        let wide = (0..7200).map(cell).filter(|[x, ..]| *x >= 40).map(|key| (key.map(|k| k & !1), true));
        let cells: std::collections::BTreeSet<([i32; 3], bool)> = narrow.chain(wide).collect();
        let cells: Vec<_> = cells.into_iter().collect();
        let parents: std::collections::BTreeSet<_> =
            cells.iter().map(|(key, _)| key.map(|k| k >> 1)).collect();
        assert!(parents.len() > 3 * AT_ONCE);
        assert_touch_as_by_brute_force(&cells);
    }

    #[test]
    fn no_cells_are_no_groups() {
        let (levels, order) = levels(&[]);
        assert!(order.is_empty() && levels.iter().all(|level| level.len() == 0 && level.near.is_empty()));
    }

    #[test]
    fn the_ends_of_the_range_have_neighbours_on_one_side() {
        let keys = [[i32::MAX, 0, 0], [i32::MAX - 1, 0, 0], [i32::MIN, 0, 0]];
        let (levels, order) = levels(&keys);
        assert_eq!(order, [2, 1, 0]);
        assert_eq!([levels[0].near(0), levels[0].near(1), levels[0].near(2)], [&[][..], &[2], &[1]]);
    }

    proptest! {
        /// Those of a group that is one wide cell are none of their own.
        #[test]
        fn cells_that_touch_are_those_of_brute_force_where_some_are_wide(
            keys in btree_set(prop::array::uniform3(-5..5_i32), 0..60),
            wide in btree_set(prop::array::uniform3(-3..3_i32), 0..12),
        ) {
            let mut cells: Vec<([i32; 3], bool)> = wide.iter().map(|key| (key.map(|k| 2 * k), true)).collect();
            let alone = |key: &[i32; 3]| !wide.contains(&key.map(|k| k >> 1));
            cells.extend(keys.iter().filter(|key| alone(key)).map(|key| (*key, false)));
            assert_touch_as_by_brute_force(&cells);
        }

        #[test]
        fn groups_are_those_of_brute_force(
            keys in btree_set(prop::array::uniform3(-9..9_i32), 0..60),
            far in any::<bool>(),
        ) {
            let mut given: Vec<[i32; 3]> = keys.into_iter().rev().collect();
            if far {
                given.push([1 << 30, -(1 << 29), 5]);
            }
            let (levels, order) = levels(&given);
            let keys: Vec<[i32; 3]> = order.iter().map(|at| given[*at as usize]).collect();
            for (l, found) in (0..).zip(&levels) {
                let group = |k: &[i32; 3]| k.map(|x| x.div_euclid(1 << l));
                for (cell, key) in keys.iter().enumerate() {
                    let own = found.group(cell) as usize;
                    let members: Vec<u32> = (0..).zip(&keys).filter(|(_, k)| group(k) == group(key)).map(|(i, _)| i).collect();
                    prop_assert_eq!(found.cells(own).collect::<Vec<u32>>(), members);
                    let groups = std::iter::once(number(own)).chain(found.near(own).iter().copied());
                    let mut around: Vec<u32> = groups.flat_map(|group| found.cells(group as usize)).collect();
                    around.sort_unstable();
                    let touches = |k: &[i32; 3]| (0..3).all(|i| (group(k)[i] - group(key)[i]).abs() <= 1);
                    let expected: Vec<u32> = (0..).zip(&keys).filter(|(_, k)| touches(k)).map(|(i, _)| i).collect();
                    prop_assert_eq!(around, expected);
                }
            }
        }
    }
}
