//! All points of a few places of a scan that is too large to keep.

use crate::cell_sample::scrambled;

/// So many points are kept at most, of at least about so many voxels: a few thousand of each, so that few are at its sides.
const MOST: usize = 1 << 19;
const VOXELS: usize = 1 << 7;
/// Voxels are halved at most so often: points that are still in one are in one place.
const LEVELS: u32 = 60;
/// Where voxels begin, in edges: not where floors and walls often are, which would be shared by the voxels on both sides.
const OFF: [f64; 3] = [0.382, 0.236, 0.414];
/// Points whose voxels are told at once.
pub(crate) const BATCH: usize = 128;
/// Numbers up to 2⁵¹ become integers when this is added, rounded to the nearest, with the integer in the lowest bits.
const ROUNDING: f64 = 1.5 * (1_u64 << 52) as f64;
/// What is farther than so many edges shares its voxel with all beyond.
const FARTHEST: f64 = (1_u64 << 50) as f64;
/// Bits that tell voxels apart when they are counted, many more than are counted.
const MARKS: usize = 1 << 12;

/// The points of voxels that are drawn by their keys. A share of all points is as far from its neighbours as the share is small, and at last as
/// surfaces are from each other; here they are as close as they are.
///
/// When there are too many points, half of the voxels are dropped, or, where there are few voxels left, those of half the edge take their
/// place. What is left is as if it had been drawn so from the first point on.
#[derive(Debug, Clone)]
pub(crate) struct CloseUp {
    draws: Vec<Draw>,
    points: Vec<[f64; 3]>,
}

/// Voxels of which those are kept whose hash is up to a threshold.
#[derive(Debug, Clone, Copy)]
struct Draw {
    level: u32,
    per_edge: f64,
    threshold: u32,
}

impl CloseUp {
    /// Of the first points of a scan, absent ones among them.
    pub(crate) fn of(points: &[[f64; 3]]) -> Self {
        let present = points.iter().copied().filter(|p| p.iter().all(|x| x.is_finite()));
        let points: Vec<[f64; 3]> = present.collect();
        let reach = points.iter().flatten().fold(0.0_f64, |most, x| most.max(x.abs()));
        let all = Draw { level: 0, per_edge: 1.0 / reach, threshold: u32::MAX };
        let mut close_up = Self { draws: vec![all], points };
        close_up.shrink();
        close_up
    }

    /// Adds the next points.
    pub(crate) fn push_all(&mut self, points: &[[f64; 3]]) {
        let (mut keeps, mut hashes) = ([true; BATCH], [0; BATCH]);
        for points in points.chunks(BATCH) {
            keeps.fill(true);
            // The last is of the smallest voxels, and mostly keeps the least.
            for draw in self.draws.iter().rev() {
                draw.hash_all(points, &mut hashes);
                keeps.iter_mut().zip(&hashes).for_each(|(keeps, hash)| *keeps &= *hash <= draw.threshold);
                // Points come in order, and most of them are in no voxel that is kept.
                if !keeps.contains(&true) {
                    break;
                }
            }
            for (point, _) in points.iter().zip(&keeps).filter(|(_, keeps)| **keeps) {
                // Fewer voxels may be kept since.
                self.push(*point);
            }
        }
    }

    pub(crate) fn push(&mut self, point: [f64; 3]) {
        if point.iter().all(|x| x.is_finite()) && self.draws.iter().all(|draw| draw.keeps(&point)) {
            self.points.push(point);
            if self.points.len() > MOST {
                self.shrink();
            }
        }
    }

    /// One in so many of the points, drawn by their numbers.
    pub(crate) fn one_in(&self, so_many: u64) -> Vec<[f64; 3]> {
        let drawn =
            self.points.iter().zip(0..).filter(|(_, number)| scrambled(*number).is_multiple_of(so_many));
        drawn.map(|(point, _)| *point).collect()
    }

    fn shrink(&mut self) {
        while let Some(draw) = self.draws.last_mut().filter(|_| self.points.len() > MOST) {
            if draw.voxels(&self.points) >= 2 * VOXELS {
                draw.threshold /= 2;
                let draw = *draw;
                self.points.retain(|point| draw.keeps(point));
            } else if draw.level < LEVELS {
                let finer =
                    Draw { level: draw.level + 1, per_edge: 2.0 * draw.per_edge, threshold: u32::MAX };
                if draw.threshold == u32::MAX {
                    *draw = finer;
                } else {
                    self.draws.push(finer);
                }
            } else {
                self.points.truncate(MOST);
            }
        }
    }
}

impl Draw {
    fn keeps(&self, point: &[f64; 3]) -> bool {
        self.threshold == u32::MAX || self.hash(point) <= self.threshold
    }

    /// A number that looks drawn at random, the same for all points of a voxel.
    // Into what it is dispatched to. Without a call or a branch: several at a time.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    fn hash(&self, point: &[f64; 3]) -> u32 {
        let [x, y, z] = *point;
        let (x, y, z) = (self.key(x, OFF[0]), self.key(y, OFF[1]), self.key(z, OFF[2]));
        let mix = x.wrapping_mul(0x9e37_79b9_7f4a_7c15)
            ^ y.wrapping_mul(0xbf58_476d_1ce4_e5b9)
            ^ z.wrapping_mul(0x94d0_49bb_1331_11eb)
            ^ u64::from(self.level);
        let mix = (mix ^ mix >> 32).wrapping_mul(0xd6e8_feb8_6659_fd93);
        (mix >> 32) as u32
    }

    /// The voxel of a coordinate.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    fn key(&self, x: f64, off: f64) -> u64 {
        let at = (x * self.per_edge + off).clamp(-FARTHEST, FARTHEST);
        let nearest = (at + ROUNDING) - ROUNDING;
        let floor = nearest - if nearest > at { 1.0 } else { 0.0 };
        (floor + ROUNDING).to_bits().wrapping_sub(ROUNDING.to_bits())
    }

    /// Those of up to [`BATCH`] points.
    fn hash_all(&self, points: &[[f64; 3]], to: &mut [u32; BATCH]) {
        // The same instructions, for more numbers at a time where the processor can.
        pulp::Arch::new().dispatch(Hashes { draw: *self, points, to });
    }

    /// How many voxels hold points, as far as [`MARKS`] tell them apart.
    fn voxels(&self, points: &[[f64; 3]]) -> usize {
        let mut seen = [false; MARKS];
        let mut hashes = [0; BATCH];
        for points in points.chunks(BATCH) {
            self.hash_all(points, &mut hashes);
            // The lowest bits: thresholds are of the highest.
            hashes[..points.len()].iter().for_each(|hash| seen[*hash as usize % MARKS] = true);
        }
        seen.iter().filter(|seen| **seen).count()
    }
}

struct Hashes<'a> {
    draw: Draw,
    points: &'a [[f64; 3]],
    to: &'a mut [u32; BATCH],
}

impl pulp::WithSimd for Hashes<'_> {
    type Output = ();

    // Into what it is dispatched to.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let Self { draw, points, to } = self;
        for (to, point) in to.iter_mut().zip(points) {
            *to = draw.hash(point);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sheet(side: u32, spacing: f64) -> Vec<[f64; 3]> {
        let place = |k: u32| spacing * (f64::from(k) + 0.25);
        (0..side * side).map(|k| [place(k % side), place(k / side), 0.0]).collect()
    }

    #[test]
    #[allow(clippy::cast_possible_truncation, reason = "a few thousand")]
    fn points_of_kept_voxels_are_all_there_whenever_they_come() {
        let points = sheet(2048, 0.01);
        let (first, rest) = points.split_at(1 << 20);
        let mut close_up = CloseUp::of(first);
        let mut one_by_one = close_up.clone();
        close_up.push_all(rest);
        for point in rest {
            one_by_one.push(*point);
        }
        assert_eq!(close_up.points, one_by_one.points);
        assert!(close_up.points.len() <= MOST && close_up.points.len() > MOST / 8);
        let kept: Vec<_> =
            points.iter().filter(|point| close_up.draws.iter().all(|draw| draw.keeps(point))).collect();
        assert_eq!(kept, close_up.points.iter().collect::<Vec<_>>());
        let last = close_up.draws.last().unwrap();
        assert!(last.voxels(&close_up.points) >= VOXELS / 2);
        // Nearly all have their four neighbours.
        let set: std::collections::HashSet<_> =
            close_up.points.iter().map(|p| [0, 1].map(|i| (p[i] / 0.01).floor() as i64)).collect();
        let whole = |[x, y]: &[i64; 2]| {
            [[1, 0], [-1, 0], [0, 1], [0, -1]].iter().all(|[i, j]| set.contains(&[x + i, y + j]))
        };
        let share = set.iter().filter(|key| whole(key)).count() as f64 / set.len() as f64;
        assert!(share > 0.8, "{share}");
    }

    #[test]
    fn a_noisy_floor_at_the_height_zero_is_not_split() {
        let mut points = sheet(1200, 0.01);
        for (k, point) in (0_u32..).zip(&mut points) {
            point[2] = if k * 7 % 3 == 0 { 1e-4 } else { -1e-4 };
        }
        let close_up = CloseUp::of(&points);
        let above = close_up.points.iter().filter(|p| p[2] > 0.0).count() as f64;
        assert!((above / close_up.points.len() as f64 - 1.0 / 3.0).abs() < 0.01);
        let draw = close_up.draws.last().unwrap();
        assert!(close_up.points.iter().all(|p| draw.keeps(&[p[0], p[1], -p[2]])));
    }

    #[test]
    fn points_in_one_place_and_absent_ones_come_to_an_end() {
        for point in [[0.0; 3], [1.0, -2.0, 3.0], [1e300; 3], [f64::NAN; 3]] {
            let mut close_up = CloseUp::of(&vec![point; MOST + 1]);
            for _ in 0..10 {
                close_up.push(point);
            }
            assert!(close_up.points.len() <= MOST);
        }
    }
}
