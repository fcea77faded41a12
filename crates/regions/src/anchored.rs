//! Sums of cells that are quickly added.

use std::borrow::Borrow;

use glam::DVec3;
use rayon::prelude::*;
use terrace_stats::Stats;

use crate::level::Level;
use crate::sum::Sum;

/// Work that is handed to a thread at once.
const AT_ONCE: usize = 1024;

/// The sums of cells, about the anchor of the cube that each is in.
#[derive(Debug)]
pub(crate) struct Anchored {
    pub(crate) sums: Vec<Sum>,
    /// The cubes along the curve.
    cubes: Vec<Cube>,
}

/// Cells that follow each other, with their sums about one anchor.
#[derive(Debug, Clone, Copy)]
struct Cube {
    /// The first of them, and that after the last.
    cells: [u32; 2],
    anchor: DVec3,
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
    /// The cubes of cells along the curve, without their sums; `anchor` tells that of a cell.
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
        Self { sums: Vec::new(), cubes }
    }

    /// The cube of a cell: there are few.
    fn cube_of(&self, cell: u32) -> &Cube {
        &self.cubes[self.cubes.partition_point(|cube| cube.cells[1] <= cell)]
    }

    /// What the sums of a cell are about.
    pub(crate) fn anchor_of(&self, cell: u32) -> DVec3 {
        self.cube_of(cell).anchor
    }

    /// Of a group alone.
    pub(crate) fn sum_of(&self, level: &Level, group: usize) -> Sum {
        let mut sum = Sum::ZERO;
        level.cells(group).for_each(|cell| sum.add(&self.sums[cell as usize]));
        sum
    }

    /// The sums of a group and of those it touches, about the anchor of its first cell, by those of groups alone.
    pub(crate) fn sum_around<S: Borrow<Sum>>(
        &self,
        level: &Level,
        group: usize,
        own: impl Fn(usize) -> S,
    ) -> Sum {
        let first = |group: usize| level.cells(group).start;
        let here = self.cube_of(first(group));
        let mut sum = *own(group).borrow();
        for near in level.near(group).iter().map(|near| *near as usize) {
            if here.holds(first(near)) {
                sum.add(own(near).borrow());
            } else {
                let apart = self.anchor_of(first(near)) - here.anchor;
                sum.add(&own(near).borrow().translated(apart));
            }
        }
        sum
    }

    /// What is asked of the sums of each cell and of those it touches, by their level.
    pub(crate) fn around_cells<'a, T: Send>(
        &'a self,
        cells: &'a Level,
        ask: impl Fn(usize, Sum) -> T + Sync + Send + 'a,
    ) -> impl IndexedParallelIterator<Item = T> + 'a {
        let around = move |cell| ask(cell, self.sum_around(cells, cell, |cell| &self.sums[cell]));
        (0..cells.len()).into_par_iter().with_min_len(AT_ONCE).map(around)
    }

    /// What is asked of the sums of each group of a level and of those it touches.
    pub(crate) fn around<T: Send>(&self, level: &Level, ask: impl Fn(Sum) -> T + Sync) -> Vec<T> {
        // Groups are within a cube.
        let groups = || (0..level.len()).into_par_iter().with_min_len(AT_ONCE);
        let own: Vec<Sum> = groups().map(|group| self.sum_of(level, group)).collect();
        groups().map(|group| ask(self.sum_around(level, group, |group| &own[group]))).collect()
    }

    /// The sums of all of some cells, about the anchor of the first.
    pub(crate) fn union(&self, cells: &[u32]) -> Option<Stats> {
        let anchor = self.anchor_of(*cells.first()?);
        let mut all = Sum::ZERO;
        let mut left = cells;
        while let Some(first) = left.first() {
            let cube = self.cube_of(*first);
            let (of_cube, rest) =
                left.split_at(left.iter().position(|cell| !cube.holds(*cell)).unwrap_or(left.len()));
            let mut sum = Sum::ZERO;
            for cell in of_cube {
                sum.add(&self.sums[*cell as usize]);
            }
            all.add(&sum.translated(cube.anchor - anchor));
            left = rest;
        }
        Some(all.stats(anchor))
    }
}
