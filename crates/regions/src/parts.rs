//! Regions that fall into parts.

use rayon::prelude::*;
use terrace_normals::symmetric_eigen;
use terrace_stats::{Stats, UncertainVector};

use crate::field::{COARSE, Field};
use crate::labels::{Piece, by_region};
use crate::level::{Level, number};

/// The planes of a scene hang together at a resolution when their largest parts hold this share of their points.
const HANG_TOGETHER: f64 = 0.85;
/// They fall apart into what is large enough for planes when that holds this share, the rest being crumbs, and the largest parts, or
/// wide ones, this: two halves may be two planes, and so may the floors of many rooms, but a few rows of points are one.
const FEW_CRUMBS: f64 = 0.85;
const IN_LARGEST: f64 = 0.4;
/// Wide parts are so many groups wide.
const WIDE: f64 = 8.0;
/// A plane hangs together by the groups that have this share of their points on it: a gap is narrower than the groups beside it
/// on one lattice, and wider on another.
const SOLID: f64 = 0.85;
/// And this share of the points of a usual group: noise leaves a few points of walls in the gap between two rooms.
const FILLED: f64 = 0.2;

/// Groups that are handed to a thread at once.
const AT_ONCE: usize = 1024;

/// The pieces of one region, group by group of a level.
struct Groups {
    /// In rising order.
    numbers: Vec<u32>,
    points: Vec<u64>,
    /// Whether nearly all points of a group are of the region, and not few.
    solid: Vec<bool>,
}

/// Parts of one region, the largest first.
struct Parts {
    /// By group, the part.
    of: Vec<usize>,
    points: Vec<u64>,
}

/// Takes apart the regions that fall into parts: the region of each piece then, and for each new number the region it was taken from.
/// The largest part keeps its number, others of at least `fewest` points and this share of the region's get new ones, smaller ones stay
/// with the largest.
///
/// What touches is told at the finest resolution at which the planes of the scene hang together: coplanar surfaces with a gap between
/// them are seen apart there, and points in rows with gaps between them are not. Cells that are as large as noise and spacing suggest, or
/// larger, tell it as well when planes fall apart there into a few large parts: it is in crumbs that they fall where points are too far
/// apart to touch. Groups that hold much else, at the borders of a part, are of the part they touch and lead to no other.
pub(crate) fn take_apart(
    field: &Field,
    pieces: &[Piece],
    regions: usize,
    fewest: f64,
    share: f64,
) -> (Vec<u32>, Vec<u32>) {
    let of_region = by_region(pieces, regions);
    let mut numbers: Vec<u32> = pieces.iter().map(|piece| piece.region).collect();
    let mut from: Vec<u32> = Vec::new();
    let apart = field.levels.iter().enumerate().find_map(|(resolution, level)| {
        let all = |group: usize| level.cells(group).map(|cell| field.cells[cell as usize].points).sum();
        let held: Vec<f64> = (0..level.len()).into_par_iter().with_min_len(AT_ONCE).map(all).collect();
        let found = of_region.par_iter().map_init(
            || vec![None; level.len()],
            |marks, of| {
                let groups =
                    Groups::of(level, &held, of.iter().map(|at| &pieces[*at as usize])).without_thin();
                let parts = groups.parts(level, marks);
                (groups, parts)
            },
        );
        let found: Vec<(Groups, Parts)> = found.collect();
        let sum = |of: &dyn Fn(&Parts) -> u64| found.iter().map(|(_, parts)| of(parts)).sum::<u64>() as f64;
        let (all, largest) = (sum(&Parts::all), sum(&|parts| parts.points.first().copied().unwrap_or(0)));
        let planes = sum(&|parts| parts.planes(parts.least(fewest, share)).map(|(_, points)| points).sum());
        let hang_together = largest >= HANG_TOGETHER * all;
        let wide = || {
            let of_each = of_region.par_iter().zip(&found).map(|(of, (groups, parts))| {
                let planes = parts.planes(parts.least(fewest, share)).count();
                let ranked = of.iter().filter_map(|at| {
                    let cell = pieces[*at as usize].cell as usize;
                    let place = groups.numbers.binary_search(&level.group(cell)).ok()?;
                    Some((field.keys[cell], parts.of[place]))
                });
                let width =
                    |cells: Option<Stats>| width(&cells?).map(|width| width / f64::from(1_u32 << resolution));
                let widths = by_part(ranked, planes).into_iter().map(width);
                let wide =
                    widths.zip(&parts.points).filter(|(width, _)| width.is_some_and(|width| width >= WIDE));
                wide.map(|(_, points)| *points).sum::<u64>()
            });
            of_each.sum::<u64>() as f64
        };
        let fall_apart =
            || planes >= FEW_CRUMBS * all && (largest >= IN_LARGEST * all || wide() >= IN_LARGEST * all);
        (hang_together || resolution >= COARSE && fall_apart()).then_some((level, found))
    });
    let Some((level, found)) = apart else { return (numbers, from) };
    for (of, (groups, parts)) in of_region.iter().zip(&found) {
        let Some(region) = of.first().map(|at| pieces[*at as usize].region) else { continue };
        let mut names: Vec<u32> = vec![region; parts.points.len()];
        for (rank, _) in parts.planes(parts.least(fewest, share)).skip(1) {
            from.push(region);
            // Parts are made of pieces, and those of cells, which are numbered with 32 bits.
            names[rank] = u32::try_from(regions + from.len() - 1).unwrap_or(region);
        }
        // Pieces follow each other along the curve, and so do groups.
        let mut rest = groups.numbers.iter().zip(&parts.of).peekable();
        for at in of {
            let group = level.group(pieces[*at as usize].cell as usize);
            while rest.next_if(|(number, _)| **number < group).is_some() {}
            if let Some((_, part)) = rest.peek().filter(|(number, _)| **number == group) {
                numbers[*at as usize] = names[**part];
            }
        }
    }
    (numbers, from)
}

/// Of the cells of the first parts, by their keys and parts, how their keys scatter.
fn by_part(cells: impl Iterator<Item = ([i32; 3], usize)>, parts: usize) -> Vec<Option<Stats>> {
    let mut stats: Vec<Option<Stats>> = vec![None; parts];
    for (key, part) in cells {
        if let Some(stats) = stats.get_mut(part) {
            let key = key.map(f64::from);
            stats.get_or_insert(Stats::new(key)).push(&UncertainVector::exact(key));
        }
    }
    stats
}

/// Across its length, as if it were a rectangle.
fn width(cells: &Stats) -> Option<f64> {
    let [_, across, _] = symmetric_eigen(&cells.covariance()?).values;
    // A strip of the width w scatters by w² / 12.
    Some((12.0 * across).max(0.0).sqrt())
}

impl Parts {
    /// The points of all.
    fn all(&self) -> u64 {
        self.points.iter().sum()
    }

    /// The points that make a part a plane, beside the largest: so many, and this share of all; where all are more than the largest and a few
    /// others, this share of as many as would be all then.
    fn least(&self, fewest: f64, share: f64) -> f64 {
        let largest = self.points.first().copied().unwrap_or(0) as f64;
        fewest.max(share * (self.all() as f64).min(largest / IN_LARGEST))
    }

    /// Ranks and points of the parts that are planes of their own: the largest, and what has so many points.
    fn planes(&self, least: f64) -> impl Iterator<Item = (usize, u64)> {
        let parts = self.points.iter().copied().enumerate();
        parts.take_while(move |(rank, points)| *rank == 0 || *points as f64 >= least)
    }
}

impl Groups {
    /// `held` are the points of each group of the level, whatever they are of.
    fn of<'p>(level: &Level, held: &[f64], pieces: impl Iterator<Item = &'p Piece>) -> Self {
        let mut of: Vec<(u32, u64)> =
            pieces.map(|piece| (level.group(piece.cell as usize), u64::from(piece.points))).collect();
        of.sort_unstable_by_key(|(group, _)| *group);
        of.dedup_by(|next, first| {
            let same = next.0 == first.0;
            first.1 += if same { next.1 } else { 0 };
            same
        });
        let solid =
            of.iter().map(|(group, points)| *points as f64 >= SOLID * held[*group as usize]).collect();
        let (numbers, points) = of.into_iter().unzip();
        Self { numbers, points, solid }
    }

    /// Groups with few points, by what is usual among these, lead to no other part.
    fn without_thin(mut self) -> Self {
        let (mut all, half) = (self.points.clone(), self.points.len() / 2);
        let usual = if all.is_empty() { 0 } else { *all.select_nth_unstable(half).1 } as f64;
        for (solid, points) in self.solid.iter_mut().zip(&self.points) {
            *solid &= *points as f64 >= FILLED * usual;
        }
        self
    }

    /// `marks` holds nothing, before and after: meanwhile the places of groups that are of no part yet.
    fn parts(&self, level: &Level, marks: &mut [Option<u32>]) -> Parts {
        for (place, group) in (0..).zip(&self.numbers) {
            marks[*group as usize] = Some(place);
        }
        let mut of: Vec<Option<usize>> = vec![None; self.numbers.len()];
        let mut parts = 0;
        let mut begin = |marks: &mut [Option<u32>], of: &mut [Option<usize>], queue: &mut Vec<u32>, start| {
            of[start] = Some(parts);
            parts += 1;
            marks[self.numbers[start] as usize] = None;
            queue.clear();
            queue.push(number(start));
        };
        let (mut queue, mut ends) = (Vec::with_capacity(of.len()), Vec::new());
        for start in 0..of.len() {
            if self.solid[start] && of[start].is_none() {
                begin(marks, &mut of, &mut queue, start);
                self.spread(level, marks, &mut of, &mut queue, |place| self.solid[place], &mut ends);
            }
        }
        // From here on all may be reached, so that nothing ends.
        let none = &mut Vec::new();
        self.spread(level, marks, &mut of, &mut ends, |_| true, none);
        for start in 0..of.len() {
            if of[start].is_none() {
                begin(marks, &mut of, &mut queue, start);
                self.spread(level, marks, &mut of, &mut queue, |_| true, none);
            }
        }
        let of: Vec<usize> = of.into_iter().flatten().collect();
        let mut points: Vec<u64> = vec![0; parts];
        for (part, of_group) in of.iter().zip(&self.points) {
            points[*part] += of_group;
        }
        // Stable: among equals the one that was found first.
        let mut ranks: Vec<usize> = (0..points.len()).collect();
        ranks.sort_by_key(|part| std::cmp::Reverse(points[*part]));
        let mut rank_of = vec![0; points.len()];
        for (rank, part) in ranks.iter().enumerate() {
            rank_of[*part] = rank;
        }
        Parts {
            of: of.into_iter().map(|part| rank_of[part]).collect(),
            points: ranks.into_iter().map(|part| points[part]).collect(),
        }
    }

    /// Gives the groups that touch those of the queue, and may, the part of those, and so on. Of all that were reached, those that touch a
    /// group of no part which may not are appended to `ends`: only from these it can be reached later.
    fn spread(
        &self,
        level: &Level,
        marks: &mut [Option<u32>],
        of: &mut [Option<usize>],
        queue: &mut Vec<u32>,
        may: impl Fn(usize) -> bool,
        ends: &mut Vec<u32>,
    ) {
        let mut next = 0;
        while let Some(place) = queue.get(next).copied() {
            next += 1;
            let (part, mut is_end) = (of[place as usize], false);
            for near in level.near(self.numbers[place as usize] as usize) {
                let mark = &mut marks[*near as usize];
                let Some(place) = *mark else { continue };
                if may(place as usize) {
                    *mark = None;
                    of[place as usize] = part;
                    queue.push(place);
                } else {
                    is_end = true;
                }
            }
            if is_end {
                ends.push(place);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::Curve;
    use proptest::prelude::*;

    fn piece(cell: u32, points: u32) -> Piece {
        Piece { region: 0, cell, points }
    }

    /// Groups as sets that hang together, with their points, the most first; by merging sets until none touch.
    fn brute_force(keys: &[[i32; 3]], points: &[u32], level: u32) -> Vec<(u64, Vec<[i32; 3]>)> {
        let mut sets: Vec<(u64, Vec<[i32; 3]>)> = keys
            .iter()
            .zip(points)
            .map(|(key, points)| (u64::from(*points), vec![key.map(|k| k >> level)]))
            .collect();
        let touch = |a: &[[i32; 3]], b: &[[i32; 3]]| {
            a.iter().any(|a| b.iter().any(|b| (0..3).all(|i| (a[i] - b[i]).abs() <= 1)))
        };
        while let Some((a, b)) = (0..sets.len())
            .flat_map(|b| (0..b).map(move |a| (a, b)))
            .find(|(a, b)| touch(&sets[*a].1, &sets[*b].1))
        {
            let (points, groups) = sets.remove(b);
            sets[a].0 += points;
            sets[a].1.extend(groups);
        }
        for (_, groups) in &mut sets {
            groups.sort_unstable();
            groups.dedup();
        }
        sets.sort_unstable();
        sets
    }

    proptest! {
        #[test]
        fn parts_are_those_of_brute_force(
            cells in prop::collection::btree_map(prop::array::uniform3(-9..9_i32), 1..9_u32, 1..40),
            level in 0..3_u32,
        ) {
            let cells: Vec<([i32; 3], u32)> = cells.into_iter().collect();
            let Curve { along: sorted, order, .. } = Curve::of(cells.len(), |at| cells[at].0);
            let (keys, points): (Vec<[i32; 3]>, Vec<u32>) = order.iter().map(|at| cells[*at as usize]).unzip();
            let coarse = Level::all(&sorted, &[], level + 1).pop().unwrap();
            let pieces: Vec<Piece> = (0..).zip(&points).map(|(cell, points)| piece(cell, *points)).collect();
            let held: Vec<f64> = (0..coarse.len())
                .map(|group| coarse.cells(group).map(|cell| f64::from(points[cell as usize])).sum())
                .collect();
            let groups = Groups::of(&coarse, &held, pieces.iter());
            let mut marks = vec![None; coarse.len()];
            let parts = groups.parts(&coarse, &mut marks);
            prop_assert!(marks.iter().all(Option::is_none));
            prop_assert!(parts.points.is_sorted_by(|a, b| a >= b));
            let mut found: Vec<(u64, Vec<[i32; 3]>)> =
                parts.points.iter().map(|points| (*points, Vec::new())).collect();
            for (group, part) in groups.numbers.iter().zip(&parts.of) {
                let first = coarse.cells(*group as usize).start;
                found[*part].1.push(keys[first as usize].map(|k| k >> level));
            }
            for (_, groups) in &mut found {
                groups.sort_unstable();
            }
            found.sort_unstable();
            prop_assert_eq!(found, brute_force(&keys, &points, level));
        }
    }
    /// Sheets of 12 by 12 groups with gaps of two, and one point in each group between the first two.
    #[test]
    fn sheets_beside_each_other_are_wide_parts_though_noise_is_between_them() {
        let mut cells: Vec<([i32; 3], u32)> = (0..4 * 144)
            .map(|k| ([k % 12 + 14 * (k / 144), k / 12 % 12, 0], 20))
            .chain((0..24).map(|k| ([12 + k % 2, k / 2, 0], 1)))
            .collect();
        cells.sort_unstable();
        let Curve { along: sorted, order, .. } = Curve::of(cells.len(), |at| cells[at].0);
        let points: Vec<u32> = order.iter().map(|at| cells[*at as usize].1).collect();
        let level = Level::all(&sorted, &[], 1).pop().unwrap();
        let pieces: Vec<Piece> = (0..).zip(&points).map(|(cell, points)| piece(cell, *points)).collect();
        let held: Vec<f64> = points.iter().map(|points| f64::from(*points)).collect();
        let parts = |groups: Groups| groups.parts(&level, &mut vec![None; level.len()]);
        let touching = parts(Groups::of(&level, &held, pieces.iter()));
        assert_eq!(touching.points, vec![2 * 2880 + 24, 2880, 2880]);
        let apart = parts(Groups::of(&level, &held, pieces.iter()).without_thin());
        assert_eq!(apart.points.iter().sum::<u64>(), 4 * 2880 + 24);
        assert!(apart.points.iter().all(|points| (2880..=2904).contains(points)), "{:?}", apart.points);
        let ranked = pieces
            .iter()
            .map(|piece| (cells[order[piece.cell as usize] as usize].0, apart.of[piece.cell as usize]));
        for stats in by_part(ranked, 4) {
            assert!((11.5..13.0).contains(&width(&stats.unwrap()).unwrap()));
        }
        // Each holds a quarter: of many, that is a plane, and of few a tenth is.
        assert_eq!(apart.planes(apart.least(20.0, 0.1)).count(), 4);
    }

    #[test]
    fn rows_are_as_wide_as_a_group() {
        for diagonal in [0, 1] {
            let row = (0..60).map(|k| ([k, diagonal * k, 0], 0));
            let found = by_part(row, 1).into_iter().flatten().map(|cells| width(&cells).unwrap());
            assert!(found.map(|width| assert!(width < 1.0)).count() == 1);
        }
    }

    #[test]
    fn groups_that_hold_much_else_lead_to_no_other_part() {
        // A row of nine cells, of which the fifth is half of something else, and a tenth apart.
        let keys: Vec<[u32; 3]> = [0, 1, 2, 3, 4, 5, 6, 7, 8, 12].map(|x| [x, 0, 0]).to_vec();
        let Curve { along: keys, .. } = Curve::of(keys.len(), |at| keys[at].map(u32::cast_signed));
        let level = Level::all(&keys, &[], 1).pop().unwrap();
        let pieces: Vec<Piece> = (0..10).map(|cell| piece(cell, 10)).collect();
        let parts_of = |held: [f64; 10]| {
            let parts = Groups::of(&level, &held, pieces.iter()).parts(&level, &mut [None; 10]);
            (parts.of, parts.points)
        };
        let mut held = [10.0; 10];
        assert_eq!(parts_of(held), (vec![0, 0, 0, 0, 0, 0, 0, 0, 0, 1], vec![90, 10]));
        held[4] = 20.0;
        assert_eq!(parts_of(held), (vec![0, 0, 0, 0, 0, 1, 1, 1, 1, 2], vec![50, 40, 10]));
        // Where no group is of the region alone, all that touches is one part.
        assert_eq!(parts_of([20.0; 10]), (vec![0, 0, 0, 0, 0, 0, 0, 0, 0, 1], vec![90, 10]));
    }
}
