//! Tiles in groups, at several resolutions.

use terrace_stats::Moments;

use crate::tiles::Tiling;

/// Resolutions: that of the tiles, and coarser ones, each with twice the edge of the one before.
pub(crate) const LEVELS: usize = 4;

/// Groups of 2ˡ × 2ˡ tiles and the sums of each with those around it.
#[derive(Debug, Clone, Default)]
pub(crate) struct Level {
    pub(crate) columns: usize,
    pub(crate) rows: usize,
    /// Row by row: of a group and the up to eight that touch it.
    pub(crate) around: Vec<Moments>,
}

impl Level {
    /// The groups that touch a group, and itself, in rising order.
    pub(crate) fn near(&self, group: usize) -> impl Iterator<Item = usize> + use<> {
        near(group, self.columns, self.rows)
    }
}

/// Places up to one step away in rows and columns, the place itself among them.
#[inline]
pub(crate) fn near(at: usize, columns: usize, rows: usize) -> impl Iterator<Item = usize> {
    let (column, row) = (at % columns, at / columns);
    let range = |at: usize, size: usize| at.saturating_sub(1)..(at + 2).min(size);
    let beside = range(column, columns);
    range(row, rows).flat_map(move |row| beside.clone().map(move |column| row * columns + column))
}

/// All levels, and the sums of groups that are not kept.
#[derive(Debug, Clone, Default)]
pub(crate) struct Pyramid {
    pub(crate) levels: [Level; LEVELS],
    own: [Vec<Moments>; 2],
    rows: Vec<Moments>,
}

impl Pyramid {
    pub(crate) fn fill(&mut self, tiles: &[Moments], tiling: Tiling) {
        pulp::Arch::new().dispatch(Fill { tiles, tiling, to: self });
    }
}

/// [`Pyramid::fill`]: a type, for a closure of this length would not become a part of what is dispatched to.
struct Fill<'a> {
    tiles: &'a [Moments],
    tiling: Tiling,
    to: &'a mut Pyramid,
}

impl pulp::WithSimd for Fill<'_> {
    type Output = ();

    #[allow(clippy::inline_always)]
    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let Pyramid { levels, own, rows } = self.to;
        let [finer, coarser] = own;
        let (mut width, mut height) = (self.tiling.columns, self.tiling.rows);
        let mut is_first = true;
        for level in levels {
            (level.columns, level.rows) = (width, height);
            let sums = if is_first { self.tiles } else { &finer[..] };
            around(sums, width, rows, &mut level.around);
            (width, height) = (width.div_ceil(2), height.div_ceil(2));
            coarser.clear();
            for pair in sums.chunks(2 * level.columns) {
                let (upper, lower) = pair.split_at(level.columns);
                // Below the last of an odd number of rows there is nothing.
                coarser.extend(upper.chunks(2).map(sum_of));
                let row = coarser.len() - width;
                for (sum, more) in coarser[row..].iter_mut().zip(lower.chunks(2)) {
                    for more in more {
                        sum.merge(more);
                    }
                }
            }
            std::mem::swap(finer, coarser);
            is_first = false;
        }
    }
}

#[allow(clippy::inline_always)]
#[inline(always)]
fn sum_of(all: &[Moments]) -> Moments {
    let mut sum = Moments::EMPTY;
    for more in all {
        sum.merge(more);
    }
    sum
}

/// Sums of three by three: first along rows, then of three rows.
#[allow(clippy::inline_always)]
#[inline(always)]
fn around(own: &[Moments], width: usize, along: &mut Vec<Moments>, to: &mut Vec<Moments>) {
    along.clear();
    for row in own.chunks(width) {
        let begin = along.len();
        along.extend_from_slice(row);
        let along = &mut along[begin..];
        for (sum, before) in along.iter_mut().skip(1).zip(row) {
            sum.merge(before);
        }
        for (sum, behind) in along.iter_mut().zip(row.iter().skip(1)) {
            sum.merge(behind);
        }
    }
    to.clear();
    to.extend_from_slice(along);
    for (sum, above) in to.iter_mut().skip(width).zip(&*along) {
        sum.merge(above);
    }
    for (sum, below) in to.iter_mut().zip(along.iter().skip(width)) {
        sum.merge(below);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use terrace_stats::SymmetricMatrix3;

    proptest! {
        #[test]
        fn sums_around_are_those_of_brute_force((columns, rows) in (1..14_usize, 1..14_usize), salt in 0..97_usize) {
            let ones = SymmetricMatrix3([1.0; 6]);
            let own = |at: usize| Moments::from_sums((at * 31 + salt) as u64 % 97, [at as f64, 0.5, 0.0], ones, ones);
            let tiles: Vec<Moments> = (0..columns * rows).map(own).collect();
            let mut pyramid = Pyramid::default();
            // Memory that was used before changes nothing.
            pyramid.fill(&[Moments::EMPTY; 6], Tiling { columns: 3, rows: 2 });
            pyramid.fill(&tiles, Tiling { columns, rows });
            for (l, level) in pyramid.levels.iter().enumerate() {
                prop_assert_eq!(level.columns, columns.div_ceil(1 << l));
                prop_assert_eq!(level.around.len(), level.columns * level.rows);
                for (group, found) in level.around.iter().enumerate() {
                    let (column, row) = (group % level.columns, group / level.columns);
                    let touches = |at: usize| {
                        ((at % columns) >> l).abs_diff(column) <= 1 && ((at / columns) >> l).abs_diff(row) <= 1
                    };
                    let mut expected = Moments::EMPTY;
                    (0..tiles.len()).filter(|at| touches(*at)).for_each(|at| expected.merge(&tiles[at]));
                    // Sums of whole numbers and halves: exact in any order.
                    prop_assert_eq!(*found, expected);
                }
            }
        }
    }
}
