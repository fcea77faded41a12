//! Sums of cells that are quickly added.

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
    cube_of: Vec<u32>,
    anchors: Vec<DVec3>,
}

/// Cells within cubes of 2ᵏ cells have their sums about one anchor: near enough that squares lose nothing, and so large that few
/// neighbours are in another.
const CUBE: u32 = 6;

impl Anchored {
    /// The cubes of cells along the curve, without their sums; `anchor` tells that of a cell.
    pub(crate) fn cubes(keys: &[[u32; 3]], anchor: impl Fn(usize) -> DVec3) -> Self {
        let (mut cube_of, mut anchors) = (Vec::with_capacity(keys.len()), Vec::new());
        let mut last: Option<[u32; 3]> = None;
        for (cell, key) in keys.iter().enumerate() {
            let cube = key.map(|k| k >> CUBE);
            if last != Some(cube) {
                last = Some(cube);
                anchors.push(anchor(cell));
            }
            // Not more cubes than cells.
            cube_of.push(u32::try_from(anchors.len() - 1).unwrap_or(u32::MAX));
        }
        Self { sums: Vec::new(), cube_of, anchors }
    }

    /// What the sums of a cell are about.
    pub(crate) fn anchor_of(&self, cell: u32) -> DVec3 {
        self.anchors[self.cube_of[cell as usize] as usize]
    }

    /// The sums of a cell about that.
    pub(crate) fn sum(&self, cell: usize, stats: &Stats) -> Sum {
        Sum::of(stats, self.anchors[self.cube_of[cell] as usize])
    }

    /// Of a group alone.
    pub(crate) fn sum_of(&self, level: &Level, group: usize) -> Sum {
        let mut sum = Sum::ZERO;
        level.cells(group).for_each(|cell| sum.add(&self.sums[cell as usize]));
        sum
    }

    /// The sums of a group and of those it touches, about the anchor of its first cell, by those of groups alone.
    pub(crate) fn sum_around(&self, level: &Level, group: usize, own: impl Fn(usize) -> Sum) -> Sum {
        let cube = |group: usize| self.cube_of[level.cells(group).start as usize];
        let (mut sum, here) = (own(group), cube(group));
        for near in level.near(group) {
            let there = cube(*near as usize);
            if here == there {
                sum.add(&own(*near as usize));
            } else {
                let apart = self.anchors[there as usize] - self.anchors[here as usize];
                sum.add(&own(*near as usize).translated(apart));
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
        let around = move |cell| ask(cell, self.sum_around(cells, cell, |cell| self.sums[cell]));
        (0..cells.len()).into_par_iter().with_min_len(AT_ONCE).map(around)
    }

    /// What is asked of the sums of each group of a level and of those it touches.
    pub(crate) fn around<T: Send>(&self, level: &Level, ask: impl Fn(Sum) -> T + Sync) -> Vec<T> {
        // Groups are within a cube.
        let groups = || (0..level.len()).into_par_iter().with_min_len(AT_ONCE);
        let own: Vec<Sum> = groups().map(|group| self.sum_of(level, group)).collect();
        groups().map(|group| ask(self.sum_around(level, group, |group| own[group]))).collect()
    }

    /// The sums of all of some cells, about the anchor of the first.
    pub(crate) fn union(&self, cells: &[u32]) -> Option<Stats> {
        let anchor = self.anchor_of(*cells.first()?);
        let mut all = Sum::ZERO;
        for of_cube in cells.chunk_by(|a, b| self.cube_of[*a as usize] == self.cube_of[*b as usize]) {
            let mut sum = Sum::ZERO;
            for cell in of_cube {
                sum.add(&self.sums[*cell as usize]);
            }
            all.add(&sum.translated(self.anchor_of(of_cube[0]) - anchor));
        }
        Some(all.stats(anchor))
    }
}
