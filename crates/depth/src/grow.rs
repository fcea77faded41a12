//! Regions of tiles that lie on one plane.

use std::ops::Range;

use terrace_stats::Moments;

use crate::around::{Arounds, TURNED};
use crate::flat::{Fitted, Flat, Noise};
use crate::pyramid::{LEVELS, Level, near};
use crate::strips::{STRIP, Strips, Told};
use crate::tile::Tile;

/// A seed's points may scatter by this, in units of the variance of their errors.
pub(crate) const SEED_CHI_SQUARED: f64 = 2.0;
/// A seed's orientation is known to this, in radians.
const SEED_TILT: f64 = 0.05;
/// A seed's points scatter across their longer direction by this share of the variance along it.
const SEED_WIDTH: f64 = 0.1;
/// This share of a seed, and of what it touches, is of no region yet.
const SEED_FREE: f64 = 0.5;
/// A plane is fitted and grown again so many times at most.
const ROUNDS: usize = 12;
/// Scatter of the tiles of a region that is usual where errors are all there is, and the most that is allowed for, both in units
/// of the variance of errors.
const USUAL_SPREAD: f64 = 0.1;
const MOST_SPREAD: f64 = 3.0;
/// Regions of fewer tiles or points are none.
const FEWEST_TILES: usize = 3;
const FEWEST_POINTS: f64 = 64.0;

/// Room for so many tiles of a region to begin with.
const MANY: usize = 256;

/// Tiles that lie on one plane and hang together.
#[derive(Debug, Clone)]
pub(crate) struct Region {
    pub(crate) tiles: Vec<u32>,
    pub(crate) fitted: Fitted,
    seed: Seed,
}

/// A group of tiles to begin with.
#[derive(Debug, Clone, Copy)]
struct Seed {
    level: usize,
    group: usize,
}

/// Tiles side by side.
struct Rectangle {
    columns: Range<usize>,
    rows: Range<usize>,
}

/// The tiles of an image.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Image<'t> {
    pub(crate) tiles: &'t [Option<Tile>],
    pub(crate) sums: &'t [Moments],
    pub(crate) levels: &'t [Level; LEVELS],
}

/// Regions on their way.
pub(crate) struct Growing<'a, 't> {
    image: Image<'t>,
    noise: Noise,
    /// Tiles may lie off by so many standard deviations of those that are in the region already; 0 where the errors of
    /// points are all there is.
    allowed: f64,
    arounds: &'a mut Arounds<'t>,
    /// By tile, all points, and those that are of no region yet.
    points: Vec<u32>,
    free: Vec<u32>,
    /// The tiles of each strip that are of no region yet, bit by bit.
    unowned: Vec<u8>,
    strips: &'a Strips,
    /// What a strip told of the plane that grows, and when.
    told: Vec<(u32, Told)>,
    /// The square of the sine of [`TURNED`].
    sine_squared: f64,
    /// By level and group, when it was last reached.
    reached: [Vec<u32>; LEVELS],
    clock: u32,
    /// Room for groups that are to be looked at.
    queue: Vec<usize>,
}

impl<'a, 't> Growing<'a, 't> {
    pub(crate) fn of(
        image: Image<'t>,
        strips: &'a Strips,
        arounds: &'a mut Arounds<'t>,
        allowed: f64,
    ) -> Self {
        let reached = image.levels.each_ref().map(|level| vec![0; level.around.len()]);
        // No image has as many pixels as 32 bits can count.
        let count = |sum: &Moments| u32::try_from(sum.count()).unwrap_or(u32::MAX);
        let points: Vec<u32> = image.sums.iter().map(count).collect();
        Self {
            image,
            noise: arounds.noise(),
            allowed,
            arounds,
            free: points.clone(),
            points,
            unowned: vec![u8::MAX; strips.len()],
            strips,
            told: vec![(0, Told::default()); strips.len()],
            sine_squared: TURNED.sin().powi(2),
            reached,
            clock: 0,
            queue: Vec::new(),
        }
    }

    /// Grows regions until no certain place is left: from the largest groups of tiles that are flat to the smallest, the surest of each
    /// size first.
    pub(crate) fn all(&mut self) -> Vec<Region> {
        let mut regions: Vec<Region> = Vec::new();
        for level in (0..LEVELS).rev() {
            for (_, group, plane) in self.seeds(level) {
                let seed = Seed { level, group };
                // Since it was judged, a region may have taken it.
                if self.is_free(seed) {
                    regions.extend(self.settled(seed, plane, 0.0, 0));
                }
            }
        }
        regions
    }

    /// Grows regions once more, each from its own plane, those with most points first, as far as they do not have most of their tiles
    /// from others.
    pub(crate) fn again(&mut self, mut regions: Vec<Region>) -> Vec<Region> {
        regions.sort_by(|a, b| b.fitted.points.total_cmp(&a.fitted.points));
        let mut again = Vec::with_capacity(regions.len());
        for region in &regions {
            if self.have_room(region.tiles.iter().map(|tile| *tile as usize)) {
                let plane = region.fitted.plane;
                let spread = self.spread(&region.tiles, &plane);
                again.extend(self.settled(region.seed, plane, spread, region.tiles.len()));
            }
        }
        again
    }

    /// Groups that can begin a region, with how sure their orientation is and their planes, the surest first.
    fn seeds(&mut self, level: usize) -> Vec<(f64, usize, Flat)> {
        let may_begin = |group: &usize| {
            let bound = self.arounds.bound(level, *group);
            bound.is_some_and(|bound| bound <= SEED_TILT) && self.is_free(Seed { level, group: *group })
        };
        let groups: Vec<usize> = (0..self.reached[level].len()).filter(may_begin).collect();
        self.arounds.fit(level, groups.iter().copied());
        let judged = |group: usize| {
            let fitted = self.arounds.get(level, group)?;
            let is_sure = fitted.tilt <= SEED_TILT && fitted.is_flat(SEED_CHI_SQUARED, SEED_WIDTH);
            is_sure.then_some((fitted.tilt, group, fitted.plane))
        };
        let mut seeds: Vec<_> = groups.into_iter().filter_map(judged).collect();
        seeds.sort_by(|a, b| a.0.total_cmp(&b.0));
        seeds
    }

    fn is_free(&self, seed: Seed) -> bool {
        let has_room = |steps| {
            let Rectangle { columns, rows } = self.rectangle(seed, steps);
            self.have_room(rows.flat_map(|row| self.row(row, &columns)))
        };
        has_room(0) && has_room(1)
    }

    /// The tiles of a group and of those up to so many steps from it.
    fn rectangle(&self, Seed { level, group }: Seed, steps: usize) -> Rectangle {
        let [tiles, groups] = [0, level].map(|level| &self.image.levels[level]);
        let (column, row) = (group % groups.columns, group / groups.columns);
        let range =
            |at: usize, end: usize| at.saturating_sub(steps) << level..((at + steps + 1) << level).min(end);
        Rectangle { columns: range(column, tiles.columns), rows: range(row, tiles.rows) }
    }

    /// Tiles of a row.
    fn row(&self, row: usize, columns: &Range<usize>) -> Range<usize> {
        let first = row * self.image.levels[0].columns;
        first + columns.start..first + columns.end
    }

    fn have_room(&self, tiles: impl Iterator<Item = usize>) -> bool {
        let (mut free, mut all) = (0, 0);
        for tile in tiles {
            all += self.points[tile];
            free += self.free[tile];
        }
        free > 0 && f64::from(free) >= SEED_FREE * f64::from(all)
    }

    /// Grows and fits until the number of tiles stays; they are of no other region then.
    fn settled(&mut self, seed: Seed, mut plane: Flat, mut spread: f64, mut before: usize) -> Option<Region> {
        let mut found: Option<Region> = None;
        for _ in 0..ROUNDS {
            let tiles = self.flood(seed, &plane, spread);
            if tiles.len() < FEWEST_TILES {
                return None;
            }
            let mut sum = Moments::EMPTY;
            for tile in &tiles {
                sum.merge(&self.image.sums[*tile as usize]);
            }
            let fitted = Fitted::of(&sum, self.noise)?;
            plane = fitted.plane;
            // Times nothing, where errors are all there is.
            if self.allowed > 0.0 {
                spread = self.spread(&tiles, &plane);
            }
            let stays = tiles.len() == before;
            before = tiles.len();
            found = Some(Region { tiles, fitted, seed });
            if stays {
                break;
            }
        }
        let found = found.filter(|region| region.fitted.points >= FEWEST_POINTS)?;
        let columns = self.image.levels[0].columns;
        for tile in found.tiles.iter().map(|tile| *tile as usize) {
            self.free[tile] = 0;
            let (strip, lane) = self.strips.place(tile % columns, tile / columns);
            self.unowned[strip] &= !(1 << lane);
        }
        Some(found)
    }

    /// The free tiles on the plane that hang together with the seed, group by group at its resolution.
    fn flood(&mut self, seed: Seed, plane: &Flat, spread: f64) -> Vec<u32> {
        self.clock += 1;
        let level = &self.image.levels[seed.level];
        let mut queue = std::mem::take(&mut self.queue);
        queue.clear();
        queue.extend(level.near(seed.group));
        for group in &queue {
            self.reached[seed.level][*group] = self.clock;
        }
        let mut tiles: Vec<u32> = Vec::with_capacity(MANY);
        let mut next = 0;
        while let Some(group) = queue.get(next).copied() {
            next += 1;
            let before = tiles.len();
            let Rectangle { columns, rows } = self.rectangle(Seed { group, ..seed }, 0);
            for row in rows {
                self.add_row(row, &columns, plane, spread, &mut tiles);
            }
            if tiles.len() > before {
                let reached = &mut self.reached[seed.level];
                for near in near(group, level.columns, level.rows) {
                    if reached[near] != self.clock {
                        reached[near] = self.clock;
                        queue.push(near);
                    }
                }
            }
        }
        self.queue = queue;
        tiles
    }

    /// Adds the free tiles of a row of a group that lie on the plane.
    fn add_row(
        &mut self,
        row: usize,
        columns: &Range<usize>,
        plane: &Flat,
        spread: f64,
        tiles: &mut Vec<u32>,
    ) {
        let (strip, first) = self.strips.place(columns.start, row);
        let begin = self.row(row, columns).start - first;
        if self.told[strip].0 != self.clock {
            let more = self.allowed * self.allowed * spread;
            let told = self.strips.told(strip, plane, more, self.sine_squared);
            self.told[strip] = (self.clock, told);
        }
        let Told { near, along } = self.told[strip].1;
        let of_group = (u8::MAX >> (STRIP - columns.len())) << first;
        let mut left = near & self.unowned[strip] & of_group;
        while left != 0 {
            let lane = left.trailing_zeros();
            left &= left - 1;
            let tile = begin + lane as usize;
            if along >> lane & 1 == 1 || self.arounds.is_along(tile, plane) {
                // An image has fewer tiles than 32 bits can count.
                #[allow(clippy::cast_possible_truncation)]
                tiles.push(tile as u32);
            }
        }
    }

    /// How far the means of tiles scatter about the plane beyond their errors, as a variance in units of those of points.
    fn spread(&self, tiles: &[u32], plane: &Flat) -> f64 {
        let (mut sum, mut points) = (0.0, 0.0);
        for tile in tiles.iter().filter_map(|tile| self.image.tiles[*tile as usize].as_ref()) {
            let off = plane.distance(tile.mean);
            sum += tile.points * off * off / tile.variance(self.noise, plane.normal) - 1.0;
            points += tile.points;
        }
        (sum / points - USUAL_SPREAD).clamp(0.0, MOST_SPREAD)
    }
}
