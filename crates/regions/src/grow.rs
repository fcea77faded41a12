//! Regions grown from the most certain places.

use crate::Step;
use crate::cell::Noise;
use crate::field::{COARSE, Field};
use crate::flat::{Fitted, Flat};

/// A seed's points may scatter by this, in units of the variance of their errors.
const SEED_CHI_SQUARED: f64 = 2.0;
/// A seed's orientation is known to this, in radians.
const SEED_TILT: f64 = 0.05;
/// A seed's points scatter across their longer direction by this share of the variance along it.
const SEED_WIDTH: f64 = 0.1;
/// This share of a seed, and of what it touches, is of no region yet.
const SEED_FREE: f64 = 0.5;
/// The mean squared distance of a cell's points from the plane, in units of the variance of their errors: a cell cut by its
/// faces holds the tail of the errors alone.
const SLACK: f64 = 1.5;
/// What few points tell, in standard errors of that mean square.
const SIGNIFICANT: f64 = 3.0;
/// The surface at a cell may be turned against the plane by this, in radians, and by so many standard errors.
const TURNED: f64 = 0.3;
const TURNED_ERRORS: f64 = 3.0;
/// A plane is fitted and grown again so many times at most.
const ROUNDS: usize = 20;
/// Scatter of the cells of a region that is usual where errors are all there is, and the most that is allowed for, both in units
/// of the variance of errors.
const USUAL_SPREAD: f64 = 0.1;
const MOST_SPREAD: f64 = 3.0;
/// Regions of fewer cells or points are none.
const FEWEST_CELLS: usize = 3;
const FEWEST_POINTS: f64 = 20.0;

/// Cells that lie on one plane and hang together.
#[derive(Debug, Clone)]
pub(crate) struct Region {
    pub(crate) cells: Vec<u32>,
    pub(crate) fitted: Fitted,
}

/// How regions are grown.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Growth {
    pub(crate) noise: Noise,
    /// Cells may lie off by so many standard deviations of those that are in the region already; 0 where the errors of
    /// points are all there is, and no surface or sensor is bent.
    pub(crate) spread: f64,
    /// A step that is left out.
    pub(crate) without: Option<Step>,
}

/// A group of cells to begin with.
struct Seed {
    tilt: f64,
    level: usize,
    group: u32,
}

/// Grows regions until no certain place is left.
///
/// # Algorithm
/// Seeds are the neighbourhoods, at every resolution, whose points lie as flat as their errors say; the one whose orientation
/// is surest is grown first, whatever its resolution: so a place is seen at the coarsest one at which it is flat. From its
/// group, neighbours are taken whose points have the mean square distance from the plane that their errors explain and whose
/// own neighbourhood is not turned against it; then the plane is fitted to the sums of all, and all is grown again from the
/// seed, until it stays.
pub(crate) fn grow(field: &Field, growth: Growth) -> Vec<Region> {
    let mut growing = Growing {
        field,
        growth,
        owned: vec![false; field.cells.len()],
        reached: field.levels.iter().map(|level| vec![0; level.len()]).collect(),
        clock: 0,
    };
    let mut regions: Vec<Region> = Vec::new();
    for seed in seeds(field, growth) {
        if let Some(region) = growing.region(&seed) {
            for cell in &region.cells {
                growing.owned[*cell as usize] = true;
            }
            regions.push(region);
        }
    }
    regions
}

fn seeds(field: &Field, growth: Growth) -> Vec<Seed> {
    let noise = growth.noise;
    let mut seeds: Vec<Seed> = Vec::new();
    let is_used = |level: usize| growth.without != Some(Step::Resolutions) || level == COARSE;
    for (level, around) in field.around.iter().enumerate().filter(|(level, _)| is_used(*level)) {
        for (group, around) in (0..).zip(around) {
            let flat = around.as_ref().filter(|around| around.is_flat(noise, SEED_CHI_SQUARED, SEED_WIDTH));
            let tilt = flat.map(|around| around.tilt(noise)).filter(|tilt| *tilt <= SEED_TILT);
            seeds.extend(tilt.map(|tilt| Seed { tilt, level, group }));
        }
    }
    seeds.sort_by(|a, b| a.tilt.total_cmp(&b.tilt).then((a.level, a.group).cmp(&(b.level, b.group))));
    seeds
}

struct Growing<'f> {
    field: &'f Field,
    growth: Growth,
    /// Whether a cell is of a region already.
    owned: Vec<bool>,
    /// By level and group, when it was last reached.
    reached: Vec<Vec<u32>>,
    clock: u32,
}

impl Growing<'_> {
    fn region(&mut self, seed: &Seed) -> Option<Region> {
        let (field, level) = (self.field, &self.field.levels[seed.level]);
        if !self.is_free(level.cells(seed.group as usize).iter().copied())
            || !self.is_free(level.around(seed.group as usize))
        {
            return None;
        }
        let mut plane = field.around[seed.level][seed.group as usize].as_ref()?.plane;
        let (mut before, mut spread) = (0, 0.0);
        let mut found: Option<Region> = None;
        let rounds = if self.growth.without == Some(Step::Refit) { 1 } else { ROUNDS };
        for _ in 0..rounds {
            let cells = self.flood(seed, &plane, spread);
            if cells.len() < FEWEST_CELLS {
                return None;
            }
            let fitted = field.fit(&cells, self.growth.noise)?;
            plane = fitted.plane;
            spread = self.spread(&cells, &plane);
            let stays = cells.len() == before;
            before = cells.len();
            found = Some(Region { cells, fitted });
            if stays {
                break;
            }
        }
        found.filter(|region| region.fitted.points() >= FEWEST_POINTS)
    }

    fn is_free(&self, cells: impl Iterator<Item = u32>) -> bool {
        let (mut free, mut all) = (0.0, 0.0);
        for cell in cells {
            let points = self.field.cells[cell as usize].points;
            all += points;
            free += if self.owned[cell as usize] { 0.0 } else { points };
        }
        free > 0.0 && free >= SEED_FREE * all
    }

    /// The free cells on the plane that hang together with the seed, group by group at its resolution.
    fn flood(&mut self, seed: &Seed, plane: &Flat, spread: f64) -> Vec<u32> {
        self.clock += 1;
        let level = &self.field.levels[seed.level];
        let reached = &mut self.reached[seed.level];
        let mut queue: Vec<u32> = vec![seed.group];
        queue.extend(level.near(seed.group as usize));
        for group in &queue {
            reached[*group as usize] = self.clock;
        }
        let mut cells: Vec<u32> = Vec::new();
        let mut next = 0;
        while let Some(group) = queue.get(next).copied() {
            next += 1;
            let before = cells.len();
            let lies_on = |cell: &&u32| {
                !self.owned[**cell as usize]
                    && self.growth.lies_on(self.field, **cell as usize, plane, spread)
            };
            cells.extend(level.cells(group as usize).iter().filter(lies_on));
            if cells.len() > before {
                for near in level.near(group as usize) {
                    if reached[*near as usize] != self.clock {
                        reached[*near as usize] = self.clock;
                        queue.push(*near);
                    }
                }
            }
        }
        cells
    }

    /// How far the means of cells scatter about the plane beyond their errors, as a variance in units of those of points.
    fn spread(&self, cells: &[u32], plane: &Flat) -> f64 {
        let (mut sum, mut points) = (0.0, 0.0);
        for cell in cells.iter().map(|cell| &self.field.cells[*cell as usize]) {
            let off = plane.distance(cell.mean);
            sum += cell.points * off * off / self.growth.noise.variance(cell, plane.normal) - 1.0;
            points += cell.points;
        }
        (sum / points - USUAL_SPREAD).clamp(0.0, MOST_SPREAD)
    }
}

impl Growth {
    fn lies_on(&self, field: &Field, cell: usize, plane: &Flat, spread: f64) -> bool {
        let sums = &field.cells[cell];
        let variance = self.noise.variance(sums, plane.normal);
        let errors = SLACK * (1.0 + SIGNIFICANT * (2.0 / sums.points).sqrt());
        let by_offset = self.without != Some(Step::Offsets);
        if by_offset && sums.mean_square(plane) > variance * (errors + self.spread * self.spread * spread) {
            return false;
        }
        self.without == Some(Step::Normals)
            || field.around[0][cell].as_ref().is_none_or(|around| {
                around.is_row(self.noise)
                    || plane.angle(&around.plane) <= TURNED + TURNED_ERRORS * around.tilt(self.noise)
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{NOISE, field, square};

    const STRICT: Growth = Growth { noise: NOISE, spread: 0.0, without: None };

    #[test]
    fn one_square_is_one_region_of_all_cells() {
        let field = field(&square(|x, y| [x, y, 0.05 + 0.2 * x]));
        let [region] = &grow(&field, STRICT)[..] else { panic!() };
        assert_eq!(region.cells.len(), field.cells.len());
        assert_eq!(region.fitted.sums.count(), 3600);
        assert!(region.fitted.reduced_chi_squared < 1e-9);
    }

    #[test]
    fn cells_are_of_one_region_at_most_and_lie_on_its_plane() {
        // A floor with walls on two sides.
        let mut points = square(|x, y| [x, y, 0.03]);
        points.extend(square(|y, z| [0.04, y, z]));
        points.extend(square(|z, x| [x, 0.05, z]));
        let field = field(&points);
        let regions = grow(&field, STRICT);
        assert!(regions.len() >= 3);
        let mut seen = vec![false; field.cells.len()];
        for region in &regions {
            for cell in &region.cells {
                assert!(!std::mem::replace(&mut seen[*cell as usize], true));
            }
            assert_eq!(region.fitted.plane, field.fit(&region.cells, NOISE).unwrap().plane);
        }
        // Each of the three largest has an axis of its own as normal.
        let mut axes: Vec<usize> =
            regions[..3].iter().map(|region| region.fitted.plane.normal.abs().max_position()).collect();
        axes.sort_unstable();
        assert_eq!(axes, [0, 1, 2]);
    }

    #[test]
    fn a_cell_whose_surface_is_turned_is_not_on_the_plane_through_it() {
        let wall = field(&square(|y, z| [0.04, y, z]));
        let flat = |axis| Flat { normal: glam::DVec3::AXES[axis], point: glam::DVec3::new(0.04, 0.55, 0.55) };
        let cell = wall.keys.iter().position(|key| *key == [0, 5, 5]).unwrap();
        // A cell is five errors long: its points alone would do.
        assert!(
            wall.cells[cell].mean_square(&flat(2))
                < SLACK * 2.0 * NOISE.variance(&wall.cells[cell], flat(2).normal)
        );
        assert!(STRICT.lies_on(&wall, cell, &flat(0), 0.0) && !STRICT.lies_on(&wall, cell, &flat(2), 0.0));
    }

    #[test]
    fn nothing_grows_from_points_in_a_line_or_all_over() {
        let line: Vec<[f64; 3]> = (0..2000).map(|k| [0.001 * f64::from(k), 0.05, 0.05]).collect();
        assert_eq!(grow(&field(&line), STRICT).len(), 0);
        let fraction = |k: i32, by: f64| (f64::from(k) * by).fract();
        let cloud: Vec<[f64; 3]> =
            (0..4000).map(|k| [0.8192, 0.6711, 0.5497].map(|by| fraction(k, by))).collect();
        assert_eq!(grow(&field(&cloud), STRICT).len(), 0);
    }
}
