//! Regions of tiles that lie on one plane.

use terrace_stats::Moments;

use crate::around::Arounds;
use crate::flat::{Fitted, Flat, Noise, is_along, least_tilt};
use crate::pyramid::{LEVELS, Level, near};
use crate::tile::Tile;

/// A seed's points may scatter by this, in units of the variance of their errors.
const SEED_CHI_SQUARED: f64 = 2.0;
/// A seed's orientation is known to this, in radians.
const SEED_TILT: f64 = 0.05;
/// A seed's points scatter across their longer direction by this share of the variance along it.
const SEED_WIDTH: f64 = 0.1;
/// This share of a seed, and of what it touches, is of no region yet.
const SEED_FREE: f64 = 0.5;
/// The mean squared distance of a tile's points from the plane, in units of the variance of their errors, and what few
/// points tell, in standard errors of that.
const SLACK: f64 = 1.5;
const SIGNIFICANT: f64 = 3.0;
/// The surface at a tile may be turned against the plane by this, in radians, and by so many standard errors.
const TURNED: f64 = 0.3;
const TURNED_ERRORS: f64 = 3.0;
/// A plane is fitted and grown again so many times at most.
const ROUNDS: usize = 12;
/// Scatter of the tiles of a region that is usual where errors are all there is, and the most that is allowed for, both in units
/// of the variance of errors.
const USUAL_SPREAD: f64 = 0.1;
const MOST_SPREAD: f64 = 3.0;
/// Regions of fewer tiles or points are none.
const FEWEST_TILES: usize = 3;
const FEWEST_POINTS: f64 = 64.0;

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
    /// Whether a tile is of a region already.
    owned: Vec<bool>,
    /// By level and group, when it was last reached.
    reached: [Vec<u32>; LEVELS],
    clock: u32,
}

impl<'a, 't> Growing<'a, 't> {
    pub(crate) fn of(image: Image<'t>, arounds: &'a mut Arounds<'t>, allowed: f64) -> Self {
        let reached = image.levels.each_ref().map(|level| vec![0; level.around.len()]);
        let owned = vec![false; image.tiles.len()];
        Self { image, noise: arounds.noise(), allowed, arounds, owned, reached, clock: 0 }
    }

    /// Grows regions until no certain place is left: from the largest groups of tiles that are flat to the smallest, the surest of each
    /// size first.
    pub(crate) fn all(&mut self) -> Vec<Region> {
        let mut regions: Vec<Region> = Vec::new();
        for level in (0..LEVELS).rev() {
            let mut seeds: Vec<(f64, usize, Flat)> = (0..self.reached[level].len())
                .filter_map(|group| {
                    let fitted = self.judge(Seed { level, group })?;
                    Some((fitted.tilt, group, fitted.plane))
                })
                .collect();
            seeds.sort_by(|a, b| a.0.total_cmp(&b.0));
            for (_, group, plane) in seeds {
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
            let tiles = region.tiles.iter().copied();
            if self.have_room(tiles) {
                let plane = region.fitted.plane;
                let spread = self.spread(&region.tiles, &plane);
                again.extend(self.settled(region.seed, plane, spread, region.tiles.len()));
            }
        }
        again
    }

    /// The plane at a seed; `None` when it cannot begin a region.
    fn judge(&mut self, seed: Seed) -> Option<Fitted> {
        let around = &self.image.levels[seed.level].around[seed.group];
        let bound = least_tilt(around, self.noise, SEED_CHI_SQUARED)?;
        if bound > SEED_TILT || !self.is_free(seed) {
            return None;
        }
        let fitted = self.arounds.get(seed.level, seed.group)?;
        let is_sure = fitted.tilt <= SEED_TILT && fitted.is_flat(SEED_CHI_SQUARED, SEED_WIDTH);
        is_sure.then_some(*fitted)
    }

    fn is_free(&self, seed: Seed) -> bool {
        let level = &self.image.levels[seed.level];
        let around = level.near(seed.group).flat_map(|group| self.tiles_of(seed.level, group));
        self.have_room(self.tiles_of(seed.level, seed.group)) && self.have_room(around)
    }

    /// The tiles of a group.
    fn tiles_of(&self, level: usize, group: usize) -> impl Iterator<Item = u32> + use<> {
        let (columns, rows) = (self.image.levels[0].columns, self.image.levels[0].rows);
        let wide = self.image.levels[level].columns;
        let (column, row) = ((group % wide) << level, (group / wide) << level);
        let range = move |at: usize, end: usize| at..(at + (1 << level)).min(end);
        // An image has fewer tiles than 32 bits can count.
        #[allow(clippy::cast_possible_truncation)]
        range(row, rows)
            .flat_map(move |row| range(column, columns).map(move |column| (row * columns + column) as u32))
    }

    fn have_room(&self, tiles: impl Iterator<Item = u32>) -> bool {
        let (mut free, mut all) = (0.0, 0.0);
        for tile in tiles {
            let points = self.image.sums[tile as usize].weight();
            all += points;
            free += if self.owned[tile as usize] { 0.0 } else { points };
        }
        free > 0.0 && free >= SEED_FREE * all
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
            spread = self.spread(&tiles, &plane);
            let stays = tiles.len() == before;
            before = tiles.len();
            found = Some(Region { tiles, fitted, seed });
            if stays {
                break;
            }
        }
        let found = found.filter(|region| region.fitted.points >= FEWEST_POINTS)?;
        for tile in &found.tiles {
            self.owned[*tile as usize] = true;
        }
        Some(found)
    }

    /// The free tiles on the plane that hang together with the seed, group by group at its resolution.
    fn flood(&mut self, seed: Seed, plane: &Flat, spread: f64) -> Vec<u32> {
        self.clock += 1;
        let level = &self.image.levels[seed.level];
        let mut queue: Vec<usize> = level.near(seed.group).collect();
        for group in &queue {
            self.reached[seed.level][*group] = self.clock;
        }
        let mut tiles: Vec<u32> = Vec::new();
        let mut next = 0;
        while let Some(group) = queue.get(next).copied() {
            next += 1;
            let before = tiles.len();
            for tile in self.tiles_of(seed.level, group) {
                if !self.owned[tile as usize] && self.lies_on(tile as usize, plane, spread) {
                    tiles.push(tile);
                }
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
        tiles
    }

    fn lies_on(&mut self, at: usize, plane: &Flat, spread: f64) -> bool {
        let Some(tile) = &self.image.tiles[at] else { return false };
        let variance = tile.variance(self.noise, plane.normal);
        let errors = SLACK * (1.0 + SIGNIFICANT * (2.0 / tile.points).sqrt());
        if tile.mean_square(plane) > variance * (errors + self.allowed * self.allowed * spread) {
            return false;
        }
        // Nearly all tiles are told by their sums.
        is_along(&self.image.levels[0].around[at], plane, TURNED.sin().powi(2))
            || self.arounds.get(0, at).is_none_or(|around| {
                around.is_row() || plane.angle(&around.plane) <= TURNED + TURNED_ERRORS * around.tilt
            })
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
