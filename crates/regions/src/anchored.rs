//! Sums of cells that are quickly added.

use glam::DVec3;
use rayon::prelude::*;
use terrace_stats::Stats;

use crate::cell::Sums;
use crate::level::{Level, number};
use crate::sum::Sum;

/// Work that is handed to a thread at once.
const AT_ONCE: usize = 1024;
/// So many groups touch one, unless some are wide.
const MOST_NEAR: usize = 26;
/// Cells of a window: their sums stay in the cache of a processor.
const WINDOW: usize = 4096;

/// The cubes along the curve: sums of cells are added about the anchor of the one that each is in.
#[derive(Debug)]
pub(crate) struct Anchored(Vec<Cube>);

/// Cells that follow each other, with their sums about one anchor.
#[derive(Debug, Clone, Copy)]
struct Cube {
    /// The first of them, and that after the last.
    cells: [u32; 2],
    anchor: DVec3,
}

/// Cells that follow each other with their sums, as they are asked for one cell after the other: most of what a cell touches is near it.
#[derive(Default)]
struct Window {
    first: usize,
    sums: Vec<Sum>,
}

impl Window {
    /// Takes the cells in whose midst a cell is.
    fn move_to(&mut self, cell: usize, anchored: &Anchored, cells: &[Sums]) {
        if self.sums.is_empty() || cell / WINDOW != self.first / WINDOW {
            self.first = cell / WINDOW * WINDOW;
            self.sums.clear();
            let of_window = (self.first..).zip(&cells[self.first..]).take(WINDOW);
            self.sums.extend(of_window.map(|(cell, sums)| sums.about(anchored.anchor_of(number(cell)))));
        }
    }

    /// That of a cell, if it is in the window.
    #[inline]
    fn get(&self, cell: usize) -> Option<&Sum> {
        self.sums.get(cell.wrapping_sub(self.first))
    }
}

impl Cube {
    fn holds(&self, cell: u32) -> bool {
        (self.cells[0]..self.cells[1]).contains(&cell)
    }
}

/// Cells within cubes of 2ᵏ cells have their sums about one anchor: near enough that squares lose nothing, and so large that few
/// neighbours are in another.
const CUBE: u32 = 6;

impl Anchored {
    /// The cubes of cells along the curve; `anchor` tells that of a cell.
    pub(crate) fn cubes(keys: &[[u32; 3]], anchor: impl Fn(usize) -> DVec3) -> Self {
        let mut cubes: Vec<Cube> = Vec::new();
        let mut first = 0;
        for of_cube in keys.chunk_by(|a, b| a.map(|k| k >> CUBE) == b.map(|k| k >> CUBE)) {
            let end = first + of_cube.len();
            // Cells are numbered with 32 bits.
            let cells = [first, end].map(|cell| u32::try_from(cell).unwrap_or(u32::MAX));
            cubes.push(Cube { cells, anchor: anchor(first) });
            first = end;
        }
        Self(cubes)
    }

    /// The cube of a cell: there are few.
    fn cube_of(&self, cell: u32) -> &Cube {
        &self.0[self.0.partition_point(|cube| cube.cells[1] <= cell)]
    }

    /// What the sums of a cell are about.
    pub(crate) fn anchor_of(&self, cell: u32) -> DVec3 {
        self.cube_of(cell).anchor
    }

    /// Of a group alone.
    pub(crate) fn sum_of(&self, level: &Level, cells: &[Sums], group: usize) -> Sum {
        let (of_group, anchor) = (level.cells(group), self.anchor_of(level.cells(group).start));
        pulp::Arch::new().dispatch(Union { all: cells, cells: of_group, anchor })
    }

    /// The sums of a group and of those it touches, about the anchor of its first cell, by those of groups alone: as they are kept, or
    /// else made anew.
    pub(crate) fn sum_around<'s>(
        &self,
        level: &Level,
        cells: &[Sums],
        group: usize,
        kept: impl Fn(usize) -> Option<&'s Sum>,
    ) -> Sum {
        let first = |group: usize| level.cells(group).start;
        let here = self.cube_of(first(group));
        let made = |group: usize| self.sum_of(level, cells, group);
        let own = |group: usize| kept(group).copied().unwrap_or_else(|| made(group));
        let mut sum = own(group);
        for near in level.near(group).iter().map(|near| *near as usize) {
            if !here.holds(first(near)) {
                let apart = self.anchor_of(first(near)) - here.anchor;
                sum.add(&own(near).translated(apart));
            } else if let Some(kept) = kept(near) {
                sum.add(kept);
            } else {
                sum.add(&made(near));
            }
        }
        sum
    }

    /// What is asked of the sums of `N` cells on end, each with those it touches, by their level, and of the number of the first; after the
    /// last cell sums are those of nothing.
    pub(crate) fn around_cells<'a, const N: usize, T: Send>(
        &'a self,
        level: &'a Level,
        cells: &'a [Sums],
        ask: impl Fn(usize, &[Sum; N]) -> T + Sync + Send + 'a,
    ) -> impl IndexedParallelIterator<Item = T> + 'a {
        let arch = pulp::Arch::new();
        let around = move |window: &mut Window, first: usize| {
            let mut sums = [Sum::ZERO; N];
            for (group, sum) in (first * N..level.len()).zip(&mut sums) {
                window.move_to(group, self, cells);
                let kept = |cell| window.get(cell);
                *sum = arch.dispatch(Around { anchored: self, level, cells, group, kept: &kept });
            }
            ask(first * N, &sums)
        };
        let all = (0..level.len().div_ceil(N)).into_par_iter();
        all.with_min_len(AT_ONCE / N).map_init(Window::default, around)
    }

    /// What is asked of the sums of each group of a level and of those it touches, by those of each alone.
    pub(crate) fn around<T: Send>(
        &self,
        level: &Level,
        cells: &[Sums],
        own: &[Sum],
        ask: impl Fn(Sum) -> T + Sync,
    ) -> Vec<T> {
        let arch = pulp::Arch::new();
        let kept = |group: usize| own.get(group);
        let around = |group| ask(arch.dispatch(Around { anchored: self, level, cells, group, kept: &kept }));
        (0..level.len()).into_par_iter().with_min_len(AT_ONCE).map(around).collect()
    }

    /// The sums of each group of a level, by those of cells.
    pub(crate) fn of_groups(&self, level: &Level, cells: &[Sums]) -> Vec<Sum> {
        let groups = (0..level.len()).into_par_iter().with_min_len(AT_ONCE);
        groups.map(|group| self.sum_of(level, cells, group)).collect()
    }

    /// The sums of each group of a level, by those of the level below.
    pub(crate) fn of_level(level: &Level, below: &Level, of_below: &[Sum]) -> Vec<Sum> {
        let of_group = |group: usize| {
            let (mut sum, cells) = (Sum::ZERO, level.cells(group));
            // Groups are within a cube, and have cells.
            let parts = below.group(cells.start as usize)..=below.group(cells.end as usize - 1);
            parts.for_each(|part| sum.add(&of_below[part as usize]));
            sum
        };
        (0..level.len()).into_par_iter().with_min_len(AT_ONCE).map(of_group).collect()
    }

    /// The sums of all of some cells, about the anchor of the first.
    pub(crate) fn union(&self, all: &[Sums], cells: &[u32]) -> Option<Stats> {
        let anchor = self.anchor_of(*cells.first()?);
        let (mut sum, arch) = (Sum::ZERO, pulp::Arch::new());
        let mut left = cells;
        // Cube by cube: about an anchor that is far away, squares of many cells lose digits.
        while let Some(first) = left.first() {
            let cube = self.cube_of(*first);
            let end = left.iter().position(|cell| !cube.holds(*cell)).unwrap_or(left.len());
            let (of_cube, rest) = left.split_at(end);
            let own = arch.dispatch(Union { all, cells: of_cube.iter().copied(), anchor: cube.anchor });
            sum.add(&own.translated(cube.anchor - anchor));
            left = rest;
        }
        Some(sum.stats(anchor))
    }
}

/// [`Anchored::sum_around`] with the widest instructions there are: the same additions, of more numbers at a time.
struct Around<'a, K> {
    anchored: &'a Anchored,
    level: &'a Level,
    cells: &'a [Sums],
    group: usize,
    kept: &'a K,
}

impl<'s, K: Fn(usize) -> Option<&'s Sum>> pulp::WithSimd for Around<'_, K> {
    type Output = Sum;

    // Into what it is dispatched to.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> Sum {
        let Self { anchored, level, cells, group, kept } = self;
        let (near, here) = (level.near(group), anchored.cube_of(level.cells(group).start));
        let known = |group: usize| kept(group).filter(|_| here.holds(level.cells(group).start));
        // Nearly always all are kept, and about the same anchor: then nothing comes between the additions.
        let (mut all, mut count) = ([&Sum::ZERO; MOST_NEAR], 0);
        for (sum, known) in all.iter_mut().zip(near.iter().map_while(|near| known(*near as usize))) {
            *sum = known;
            count += 1;
        }
        match (kept(group), all.get(..count)) {
            (Some(own), Some(all)) if count == near.len() => {
                let mut sum = *own;
                for near in all {
                    sum.add(near);
                }
                sum
            }
            _ => anchored.sum_around(level, cells, group, kept),
        }
    }
}

/// Sums of cells about an anchor, likewise.
struct Union<'a, I> {
    all: &'a [Sums],
    cells: I,
    anchor: DVec3,
}

impl<I: Iterator<Item = u32>> pulp::WithSimd for Union<'_, I> {
    type Output = Sum;

    // Into what it is dispatched to.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> Sum {
        let mut sum = Sum::ZERO;
        for cell in self.cells {
            sum.add(&self.all[cell as usize].about(self.anchor));
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{field, square};

    /// A sheet over the corner of several cubes, and a wall: some of what touches is about another anchor, and some in no window.
    #[test]
    fn sums_around_are_those_of_one_addition_after_the_other() {
        let mut points = square(|x, y| [6.0 * x - 2.0, 6.0 * y - 3.0, 0.3 * x]);
        points.extend(square(|x, y| [0.1, 6.0 * x - 2.0, 6.0 * y]));
        let field = field(&points);
        let (cells, cubes) = (field.cells.len(), field.anchored.0.len());
        assert!(cells > WINDOW && cubes > 3, "{cells} cells in {cubes} cubes");
        let level = &field.levels[0];
        let none = |_| None;
        let each: Vec<Sum> = field.anchored.around_cells(level, &field.cells, |_, [sum]| *sum).collect();
        for (cell, around) in each.iter().enumerate() {
            assert_eq!(*around, field.anchored.sum_around(level, &field.cells, cell, none));
        }
        let level = &field.levels[1];
        let own = field.anchored.of_groups(level, &field.cells);
        for (group, around) in field.anchored.around(level, &field.cells, &own, |sum| sum).iter().enumerate()
        {
            assert_eq!(*around, field.anchored.sum_around(level, &field.cells, group, none));
        }
    }
}
