//! All that is known of the cells before a region is grown.

use std::sync::atomic::{AtomicBool, Ordering};

use glam::DVec3;
use rayon::prelude::*;
use terrace_normals::EigenvalueBounds;
use terrace_stats::{Stats, SymmetricMatrix3};

use crate::anchored::Anchored;
use crate::around::{Bounded, told};
use crate::cell::{Noise, Sums};
use crate::curve::{Curve, Order, along_curve};
use crate::flat::Fitted;
use crate::level::{Level, number};
use crate::shared::SharedNoise;
use crate::sum::Sum;
use crate::turned::Turned;
use crate::{Cell, Cells, RegionsError};

/// Resolutions: that of the cells, and coarser ones, each with twice the edge of the one before.
pub(crate) const LEVELS: u32 = 4;
/// The level whose groups are as large as noise and spacing suggest for a cell.
pub(crate) const COARSE: usize = 1;
/// Work that is handed to a thread at once.
const AT_ONCE: usize = 1024;
/// How many cells later the sums of one are needed whose memory is asked for.
const AHEAD: usize = 8;
/// Neighbourhoods that are looked at side by side: as many as the widest vectors hold.
const LANES: usize = 8;

/// Cells along a space-filling curve, at several resolutions: what [`find`](crate::find) goes out from. Made once, it is asked how points
/// scatter around each cell, where their errors are not known, and takes those that are found so.
///
/// ```
/// use terrace_regions::{Cell, Field};
/// use terrace_stats::{Stats, SymmetricMatrix3, UncertainVector};
///
/// // Two cells that touch, of three points each, and one far away.
/// let cells = [0, 1, 5].map(|x| {
///     let mut stats = Stats::new([f64::from(x) + 0.5, 0.5, 0.5]);
///     (0..3).for_each(|k| stats.push(&UncertainVector::exact([f64::from(x) + 0.3 * f64::from(k), 0.1, 0.2])));
///     Cell { key: [x, 0, 0], is_wide: false, stats }
/// });
/// let mut field = Field::of(&cells, 1.0)?;
/// assert_eq!(field.sums_around(|_, sums| sums.count()), [6, 6, 3]);
/// field.set_noise(|_| SymmetricMatrix3::diagonal([3e-4; 3]))?;
/// # Ok::<(), terrace_regions::RegionsError>(())
/// ```
#[derive(Debug)]
pub struct Field {
    /// The place of each among the given cells.
    pub(crate) order: Vec<u32>,
    pub(crate) cells: Vec<Sums>,
    /// What places of points of each cell are relative to.
    pub(crate) anchors: Vec<DVec3>,
    pub(crate) keys: Vec<[i32; 3]>,
    /// See [`Cells::are_parts`].
    pub(crate) are_parts: bool,
    /// What the curve goes out from.
    corner: [i32; 3],
    /// Whether each is as large as a group of the next level, and alone in it; empty where none is.
    wide: Vec<bool>,
    /// The resolutions, the finest first, once they are [laid out](Self::lay_out).
    pub(crate) levels: Vec<Level>,
    pub(crate) anchored: Anchored,
    /// What points of each cell have in common, a part of their errors; empty where they have nothing.
    shared: Vec<SharedNoise>,
    /// By level and group, what the sums of a group and of those it touches tell of the plane through them; while regions grow.
    pub(crate) bounded: Vec<Vec<Bounded>>,
    /// How the surface around each cell may be turned, likewise.
    pub(crate) turned: Vec<Turned>,
    /// The edge of a cell, in metres.
    pub(crate) edge: f64,
}

impl Field {
    /// Of cells with an edge in metres, of different keys; wide ones with twice that edge.
    ///
    /// # Errors
    /// [`RegionsError`] for an edge that is no length, for a cell without points or whose sums are not finite, for two cells at one place,
    /// and for more cells than are numbered.
    pub fn of(cells: &[Cell], edge: f64) -> Result<Self, RegionsError> {
        Self::of_each(cells, edge)
    }

    /// As [`of`](Self::of), for cells that are kept elsewhere.
    ///
    /// # Errors
    /// As [`of`](Self::of).
    pub fn of_each(given: &(impl Cells + ?Sized), edge: f64) -> Result<Self, RegionsError> {
        Self::of_ordered(given, edge, None)
    }

    /// As [`of_each`](Self::of_each), for cells whose order was found before; one that is not theirs, or of cells of which some are wide, is
    /// found anew.
    ///
    /// # Errors
    /// As [`of`](Self::of).
    pub fn of_ordered(
        given: &(impl Cells + ?Sized),
        edge: f64,
        order: Option<Order>,
    ) -> Result<Self, RegionsError> {
        if !(edge.is_normal() && edge > 0.0) {
            return Err(RegionsError::Edge { edge });
        }
        let cells = given.count();
        if u32::try_from(cells).is_err() {
            return Err(RegionsError::TooMany { cells });
        }
        let (is_wide, stats) = (|at: usize| given.is_wide(at), |at: usize| given.stats(at));
        // Of a wide cell that of the first cell it is in the place of.
        let first = |at: usize| if is_wide(at) { given.key(at).map(|k| k & !1) } else { given.key(at) };
        let some_wide = (0..cells).any(&is_wide);
        let known = order.filter(|known| !some_wide && known.0.order.len() == cells);
        let is_known = known.is_some();
        let curve = known.map_or_else(|| Curve::of(cells, first), |known| known.0);
        let order = &curve.order;
        let wide: Vec<bool> =
            order.iter().take_while(|_| some_wide).map(|at| is_wide(*at as usize)).collect();
        let anchored = Anchored::cubes(&curve.along, |rank| stats(order[rank] as usize).anchor().into());
        let (strange, other) = (AtomicBool::new(false), AtomicBool::new(false));
        // Each cell is looked at once: they are not in the order of the curve.
        let of_cell = |rank: usize| {
            if let Some(later) = order.get(rank + AHEAD) {
                given.fetch(*later as usize);
            }
            let at = order[rank] as usize;
            if is_known && given.key(at) != curve.key(rank) {
                other.store(true, Ordering::Relaxed);
            }
            let stats = stats(at);
            let sums = Sums::of(&stats).unwrap_or_else(|| {
                strange.store(true, Ordering::Relaxed);
                Sums::NOTHING
            });
            (sums, DVec3::from(stats.anchor()))
        };
        let of_cells = (0..cells).into_par_iter().with_min_len(AT_ONCE).map(of_cell);
        let (sums, anchors) = of_cells.unzip();
        if other.into_inner() {
            return Self::of_each(given, edge);
        }
        let corner = curve.corner;
        let (order, keys) = curve.into_order_and_keys();
        if strange.into_inner() {
            let strange = (0..cells).find(|at| Sums::of(&stats(*at)).is_none());
            return Err(RegionsError::Cell { cell: strange.unwrap_or(0) });
        }
        let is_wide = |rank: usize| wide.get(rank) == Some(&true);
        let is_twice = |(rank, pair): &(usize, &[[i32; 3]])| {
            let same = pair[0] == pair[1];
            same || (is_wide(*rank) || is_wide(rank + 1))
                && pair[0].map(|k| k >> 1) == pair[1].map(|k| k >> 1)
        };
        let twice = keys.windows(2).enumerate().filter(is_twice).count();
        if twice > 0 {
            return Err(RegionsError::SameKey { cells, places: cells - twice });
        }
        let (shared, bounded, turned) = (Vec::new(), Vec::new(), Vec::new());
        let levels = Vec::new();
        Ok(Self {
            order,
            cells: sums,
            anchors,
            keys,
            are_parts: given.are_parts(),
            corner,
            wide,
            levels,
            anchored,
            shared,
            bounded,
            turned,
            edge,
        })
    }

    /// Finds which cells touch, at all resolutions, where that is not known yet. Not before it is asked for: the memory of what the cells were
    /// made of may be free by then.
    fn lay_out(&mut self) {
        if self.levels.is_empty() {
            let along: Vec<[u32; 3]> = self.keys.iter().map(|key| along_curve(*key, self.corner)).collect();
            self.levels = Level::all(&along, &self.wide, LEVELS);
        }
    }

    /// Asks of each cell, by its place among those that were given, what is to be known of the sums of its points and those of the
    /// cells that share a face, an edge or a corner with it, about the anchor of its own; on all threads of the rayon pool. Finds which cells
    /// touch, the first time.
    pub fn sums_around<T: Copy + Send>(&mut self, ask: impl Fn(usize, &Stats) -> T + Sync + Send) -> Vec<T> {
        self.sums_around_several(|[cell], [sums]| [cell.map(|cell| ask(cell, sums))]).flatten().collect()
    }

    /// As [`sums_around`](Self::sums_around), of `N` cells side by side: 4 and 8 are good numbers for what is fitted to their sums. The last
    /// may be fewer; what is told of none is left out.
    pub fn sums_around_several<const N: usize, T: Copy + Send>(
        &mut self,
        ask: impl Fn([Option<usize>; N], &[Stats; N]) -> [T; N] + Sync + Send,
    ) -> impl ExactSizeIterator<Item = T> {
        const { assert!(N > 0, "cells are asked for some at a time") };
        self.lay_out();
        let of_cells = |first: usize, sums: &[Sum; N]| {
            let cell = |lane: usize| self.order.get(first + lane).map(|given| *given as usize);
            let own = |lane: usize| {
                let (cell, Some(anchor)) = (first + lane, self.anchors.get(first + lane)) else {
                    return Stats::new([0.0; 3]);
                };
                sums[lane].stats(self.anchored.anchor_of(number(cell))).with_anchor(anchor.to_array())
            };
            ask(std::array::from_fn(cell), &std::array::from_fn(own))
        };
        let around = |level| self.anchored.around_cells(level, &self.cells, of_cells).collect();
        let found: Vec<[T; N]> = self.levels.first().map(around).unwrap_or_default();
        let mut ranks: Vec<u32> = vec![0; self.order.len()];
        for (rank, given) in (0..).zip(&self.order) {
            ranks[*given as usize] = rank;
        }
        ranks.into_iter().map(move |rank| found.as_flattened()[rank as usize])
    }

    /// Takes other errors of points: `noise` tells the sum of their covariances in a cell, by its place among those that were given.
    ///
    /// # Errors
    /// [`RegionsError::Cell`] when that is not finite.
    pub fn set_noise(
        &mut self,
        noise: impl Fn(usize) -> SymmetricMatrix3 + Sync,
    ) -> Result<(), RegionsError> {
        let Self { order, cells, .. } = self;
        let of_each = cells.par_iter_mut().zip(&*order).with_min_len(AT_ONCE);
        let strange = of_each.filter_map(|(sums, given)| {
            let noise = noise(*given as usize);
            sums.set_noise(noise);
            (!noise.is_finite()).then_some(*given as usize)
        });
        strange.min().map_or(Ok(()), |cell| Err(RegionsError::Cell { cell }))
    }

    /// Adds errors that points of a cell have in common: `shared` tells those of a cell, by its place among those that were given. They are
    /// errors of points like others, but points that lie off by them are off together. To be told once, before regions grow.
    ///
    /// # Errors
    /// [`RegionsError::Cell`] when they are not finite.
    pub fn add_shared_noise(
        &mut self,
        shared: impl Fn(usize) -> SharedNoise + Sync,
    ) -> Result<(), RegionsError> {
        let of_each = self.order.par_iter().with_min_len(AT_ONCE);
        self.shared = of_each.map(|given| shared(*given as usize)).collect();
        for (sums, shared) in self.cells.iter_mut().zip(&self.shared) {
            sums.add_noise(&shared.of_points);
        }
        let strange = self.order.iter().zip(&self.shared).filter(|(_, shared)| !shared.is_finite());
        strange
            .map(|(given, _)| *given as usize)
            .min()
            .map_or(Ok(()), |cell| Err(RegionsError::Cell { cell }))
    }

    /// By how much the mean square of errors that points of a cell have in common may be off, as a standard deviation, in m².
    pub(crate) fn uncertainty_of_shared(&self, cell: usize, direction: DVec3) -> f64 {
        self.shared.get(cell).map_or(0.0, |shared| shared.uncertainty(direction))
    }

    /// Finds what only growth asks for.
    pub(crate) fn begin_growth(&mut self) {
        self.lay_out();
        let Some((cells, coarser)) = self.levels.split_first() else { return };
        let (edge, anchored) = (self.edge, &self.anchored);
        let told = |_, sums: &[Sum; LANES]| told(sums, edge);
        let (bounded, turned): (Vec<_>, Vec<_>) = anchored.around_cells(cells, &self.cells, told).unzip();
        let (mut finest, mut turned) = (bounded.into_flattened(), turned.into_flattened());
        finest.truncate(cells.len());
        turned.truncate(cells.len());
        let of_group = |sum: Sum| Bounded::of(&sum, &EigenvalueBounds::of(&sum.covariance()), edge);
        let mut bounded = vec![finest];
        let mut below: Option<(&Level, Vec<Sum>)> = None;
        for level in coarser {
            let own = match below {
                None => anchored.of_groups(level, &self.cells),
                Some((below, of_below)) => Anchored::of_level(level, below, &of_below),
            };
            bounded.push(anchored.around(level, &self.cells, &own, of_group));
            below = Some((level, own));
        }
        (self.bounded, self.turned) = (bounded, turned);
    }

    /// Forgets what only growth asks for: it is a good share of all that is known of a cell.
    pub(crate) fn end_growth(&mut self) {
        (self.bounded, self.turned) = (Vec::new(), Vec::new());
    }

    /// The edge of a group of the level that suits noise and spacing, in metres.
    pub(crate) fn coarse_edge(&self) -> f64 {
        self.edge * f64::from(1_u32 << COARSE)
    }

    /// Whether a cell has twice the edge.
    pub(crate) fn is_wide(&self, cell: usize) -> bool {
        self.wide.get(cell) == Some(&true)
    }

    /// The edge of the cell that a point of some cells is in, in the mean, in metres.
    pub(crate) fn mean_edge(&self, cells: &[u32]) -> f64 {
        if self.wide.is_empty() {
            return self.edge;
        }
        let (mut all, mut in_wide) = (0.0, 0.0);
        for cell in cells.iter().map(|cell| *cell as usize) {
            let points = self.cells[cell].points;
            all += points;
            in_wide += if self.is_wide(cell) { points } else { 0.0 };
        }
        self.edge * (1.0 + in_wide / all)
    }

    /// Errors of points in units of a squared edge.
    pub(crate) fn in_units(&self, noise: Noise) -> Noise {
        noise.in_units(self.edge)
    }

    /// The plane of some cells.
    pub(crate) fn fit(&self, cells: &[u32], noise: Noise) -> Option<Fitted> {
        Fitted::of(self.anchored.union(&self.cells, cells)?, noise)
    }

    /// The mean of the points of a cell, from its anchor: a place to look at where no other is known.
    // In single precision, as places of points are.
    #[allow(clippy::cast_possible_truncation)]
    pub(crate) fn middle(&self, cell: usize) -> Option<[f32; 3]> {
        let (sums, anchor) = (self.cells.get(cell)?, self.anchors.get(cell)?);
        Some((sums.mean - anchor).to_array().map(|x| x as f32))
    }

    /// The sums of a group and of those it touches: taken anew, for few are asked for.
    pub(crate) fn stats_around(&self, level: usize, group: usize) -> Stats {
        let level = &self.levels[level];
        let sum = self.anchored.sum_around(level, &self.cells, group, |_| None);
        sum.stats(self.anchored.anchor_of(level.cells(group).start))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use terrace_stats::UncertainVector;

    /// A cell of one point, for each key once.
    fn of_keys(keys: &[[i32; 3]], wide: Option<usize>) -> Vec<Cell> {
        let mut keys = keys.to_vec();
        keys.sort_unstable();
        keys.dedup();
        // In an order that is neither that of the keys nor along the curve.
        keys.sort_by_key(|key| key[0].wrapping_mul(7919) ^ key[1].wrapping_mul(104_729) ^ key[2]);
        let of = |(at, key): (usize, &[i32; 3])| {
            let is_wide = wide == Some(at);
            // Far from the others.
            let key = if is_wide { [100; 3] } else { *key };
            let mut stats = Stats::new(key.map(f64::from));
            stats.push(&UncertainVector::exact(key.map(|k| f64::from(k) + 0.25)));
            Cell { key, is_wide, stats }
        };
        keys.iter().enumerate().map(of).collect()
    }

    fn told(field: &Result<Field, RegionsError>) -> String {
        format!("{field:?}")
    }

    proptest! {
        #[test]
        fn an_order_that_was_found_before_changes_nothing_whatever_it_is_of(
            keys in prop::collection::vec(prop::array::uniform3(-9..9_i32), 0..60),
            others in prop::collection::vec(prop::array::uniform3(-9..9_i32), 0..60),
            wide in prop::option::of(0..60_usize),
        ) {
            let (cells, others) = (of_keys(&keys, wide), of_keys(&others, None));
            let order = |of: &[Cell]| Some(Order::of(of.len(), |at| of[at].key));
            let expected = told(&Field::of(&cells, 1.0));
            let backwards: Vec<Cell> = cells.iter().rev().copied().collect();
            for of in [&cells, &others, &backwards] {
                prop_assert_eq!(told(&Field::of_ordered(&cells[..], 1.0, order(of))), expected.clone());
            }
        }
    }
}
