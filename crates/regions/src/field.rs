//! All that is known of the cells before a region is grown.

use glam::DVec3;
use rayon::prelude::*;
use terrace_stats::Stats;

use crate::around::{Bounded, Turned};
use crate::cell::{Noise, Sums};
use crate::flat::Fitted;
use crate::level::{Level, along_curve};
use crate::sum::Sum;
use crate::{Cell, RegionsError};

/// Resolutions: that of the cells, and coarser ones, each with twice the edge of the one before.
pub(crate) const LEVELS: u32 = 4;
/// The level whose groups are as large as noise and spacing suggest for a cell.
pub(crate) const COARSE: usize = 1;
/// Cells within cubes of 2ᵏ cells have their sums about one anchor: near enough that squares lose nothing, and so large that few
/// neighbours are in another.
const CUBE: u32 = 6;
/// Work that is handed to a thread at once.
const AT_ONCE: usize = 1024;

/// The cells along a space-filling curve, at several resolutions, and the sums around each group.
#[derive(Debug)]
pub(crate) struct Field {
    /// The place of each among the given cells.
    pub(crate) order: Vec<u32>,
    pub(crate) cells: Vec<Sums>,
    /// What places of points of each cell are relative to.
    pub(crate) anchors: Vec<DVec3>,
    pub(crate) keys: Vec<[i32; 3]>,
    pub(crate) levels: Vec<Level>,
    middles: Vec<[f32; 3]>,
    anchored: Anchored,
    /// By level and group, what the sums of a group and of those it touches tell of the plane through them.
    pub(crate) bounded: Vec<Vec<Bounded>>,
    /// How the surface around each cell may be turned.
    pub(crate) turned: Vec<Turned>,
    /// The edge of a cell, in metres.
    pub(crate) edge: f64,
}

/// The sums of cells, about the anchor of the cube that each is in.
#[derive(Debug)]
struct Anchored {
    sums: Vec<Sum>,
    cube_of: Vec<u32>,
    anchors: Vec<DVec3>,
}

impl Field {
    /// # Errors
    /// [`RegionsError`] for a cell without points or whose sums are not finite, and for more cells than are numbered.
    pub(crate) fn of(cells: &[Cell], edge: f64) -> Result<Self, RegionsError> {
        if !(edge.is_normal() && edge > 0.0) {
            return Err(RegionsError::Edge { edge });
        }
        if u32::try_from(cells.len()).is_err() {
            return Err(RegionsError::TooMany { cells: cells.len() });
        }
        let (order, levels, anchored) = laid_out(cells);
        // Room for all at once: a list that grows is moved again and again.
        let mut sums = Vec::with_capacity(cells.len());
        sums.extend(order.iter().filter_map(|at| Sums::of(&cells[*at as usize].stats)));
        if sums.len() < cells.len() {
            let cell = cells.iter().position(|cell| Sums::of(&cell.stats).is_none()).unwrap_or(0);
            return Err(RegionsError::Cell { cell });
        }
        let keys: Vec<[i32; 3]> = order.iter().map(|at| cells[*at as usize].key).collect();
        let twice = keys.windows(2).filter(|pair| pair[0] == pair[1]).count();
        if twice > 0 {
            return Err(RegionsError::SameKey { cells: cells.len(), places: cells.len() - twice });
        }
        // In single precision, as places of points are.
        #[allow(clippy::cast_possible_truncation)]
        let middle = |(of, anchor): (&Sums, &DVec3)| (of.mean - anchor).to_array().map(|x| x as f32);
        let anchors: Vec<DVec3> = order.iter().map(|at| cells[*at as usize].stats.anchor().into()).collect();
        let middles = sums.iter().zip(&anchors).map(middle).collect();
        let bounded: Vec<Vec<Bounded>> =
            levels.iter().skip(1).map(|level| anchored.around(level, |sum| Bounded::of(&sum))).collect();
        let of_cells = |level| anchored.around(level, |sum| (Bounded::of(&sum), Turned::of(&sum, edge)));
        let (finest, turned): (Vec<Bounded>, Vec<Turned>) =
            levels.first().map(of_cells).unwrap_or_default().into_iter().unzip();
        let bounded = std::iter::once(finest).chain(bounded).collect();
        Ok(Self { order, anchors, turned, bounded, cells: sums, keys, levels, middles, anchored, edge })
    }

    /// Forgets what only growth asks for: it is a good share of all that is known of a cell.
    pub(crate) fn end_growth(&mut self) {
        (self.bounded, self.turned, self.anchored.sums) = (Vec::new(), Vec::new(), Vec::new());
    }

    /// The edge of a group of the level that suits noise and spacing, in metres.
    pub(crate) fn coarse_edge(&self) -> f64 {
        self.edge * f64::from(1_u32 << COARSE)
    }

    /// The plane of some cells.
    pub(crate) fn fit(&self, cells: &[u32], noise: Noise) -> Option<Fitted> {
        Fitted::of(self.anchored.union(cells)?, noise)
    }

    /// The mean of the points of a cell, from its anchor: a place to look at where no other is known.
    pub(crate) fn middle(&self, cell: usize) -> &[[f32; 3]] {
        self.middles.get(cell..=cell).unwrap_or(&[])
    }

    /// The sums of a group and of those it touches: taken anew, for few are asked for.
    pub(crate) fn stats_around(&self, level: usize, group: usize) -> Stats {
        let level = &self.levels[level];
        let sum = self.anchored.sum_around(level, group, |group| self.anchored.sum_of(level, group));
        sum.stats(self.anchored.anchor_of(level.cells(group).start))
    }
}

/// For each cell the sums of its points and those of the up to 26 cells that share a face, an edge or a corner with it.
/// The keys of cells are to be different.
pub fn sums_around(cells: &[Cell]) -> Vec<Stats> {
    let (order, levels, anchored) = laid_out(cells);
    let mut sums: Vec<Stats> = cells.iter().map(|cell| cell.stats).collect();
    if let Some(level) = levels.first() {
        for ((rank, given), sum) in (0..).zip(&order).zip(anchored.around(level, |sum| sum)) {
            let sums = &mut sums[*given as usize];
            *sums = sum.stats(anchored.anchor_of(rank)).with_anchor(sums.anchor());
        }
    }
    sums
}

fn laid_out(cells: &[Cell]) -> (Vec<u32>, Vec<Level>, Anchored) {
    let keys: Vec<[i32; 3]> = cells.iter().map(|cell| cell.key).collect();
    let (keys, order) = along_curve(&keys);
    let anchored = Anchored::of(cells, &keys, &order);
    (order, Level::all(&keys, LEVELS), anchored)
}

impl Anchored {
    fn of(cells: &[Cell], keys: &[[u32; 3]], order: &[u32]) -> Self {
        let (mut cube_of, mut anchors) = (Vec::with_capacity(order.len()), Vec::new());
        let mut last: Option<[u32; 3]> = None;
        for (key, at) in keys.iter().zip(order) {
            let cube = key.map(|k| k >> CUBE);
            if last != Some(cube) {
                last = Some(cube);
                anchors.push(DVec3::from(cells[*at as usize].stats.anchor()));
            }
            // Not more cubes than cells.
            cube_of.push(u32::try_from(anchors.len() - 1).unwrap_or(u32::MAX));
        }
        let sum = |(at, cube): (&u32, &u32)| Sum::of(&cells[*at as usize].stats, anchors[*cube as usize]);
        let sums = order.par_iter().zip(&cube_of).with_min_len(AT_ONCE).map(sum).collect();
        Self { sums, cube_of, anchors }
    }

    fn anchor_of(&self, cell: u32) -> DVec3 {
        self.anchors[self.cube_of[cell as usize] as usize]
    }

    fn sum_of(&self, level: &Level, group: usize) -> Sum {
        let mut sum = Sum::ZERO;
        level.cells(group).for_each(|cell| sum.add(&self.sums[cell as usize]));
        sum
    }

    /// The sums of a group and of those it touches, about the anchor of its first cell, by those of groups alone.
    fn sum_around(&self, level: &Level, group: usize, own: impl Fn(usize) -> Sum) -> Sum {
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

    /// What is asked of the sums of each group of a level and of those it touches.
    fn around<T: Send>(&self, level: &Level, ask: impl Fn(Sum) -> T + Sync) -> Vec<T> {
        // Groups are within a cube; those of the finest level are the cells.
        let summed: Vec<Sum>;
        let own = if level.len() == self.sums.len() {
            &self.sums
        } else {
            let groups = (0..level.len()).into_par_iter().with_min_len(AT_ONCE);
            summed = groups.map(|group| self.sum_of(level, group)).collect();
            &summed
        };
        let around = |group| ask(self.sum_around(level, group, |group| own[group]));
        (0..level.len()).into_par_iter().with_min_len(AT_ONCE).map(around).collect()
    }

    /// The sums of all of some cells, about the anchor of the first.
    fn union(&self, cells: &[u32]) -> Option<Stats> {
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
