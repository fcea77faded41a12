//! Regions grown from the most certain places.

use crate::Step;
use crate::around::Arounds;
use crate::cell::Noise;
use crate::field::{COARSE, Field};
use crate::flat::{Fitted, Flat};
use crate::level::Level;
use crate::seeds::{Seed, Seeds};

/// A seed's points may scatter by this, in units of the variance of their errors.
pub(crate) const SEED_CHI_SQUARED: f64 = 2.0;
/// A seed's orientation is known to this, in radians.
pub(crate) const SEED_TILT: f64 = 0.05;
/// A seed's points scatter across their longer direction by this share of the variance along it.
pub(crate) const SEED_WIDTH: f64 = 0.1;
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
    /// Where it began.
    pub(crate) seed: Seed,
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

/// Grows regions until no certain place is left.
///
/// # Algorithm
/// Seeds are the neighbourhoods, at every resolution, whose points lie as flat as their errors say; the one whose orientation
/// is surest is grown first, whatever its resolution: so a place is seen at the coarsest one at which it is flat. From its
/// group, neighbours are taken whose points have the mean square distance from the plane that their errors explain and whose
/// own neighbourhood is not turned against it; then the plane is fitted to the sums of all, and all is grown again from the
/// seed, until it stays.
pub(crate) fn grow(arounds: &mut Arounds, growth: Growth) -> Vec<Region> {
    let field = arounds.field();
    let mut seeds = Seeds::of(field, growth);
    let mut growing = Growing::of(arounds, growth);
    let mut regions: Vec<Region> = Vec::new();
    while let Some(seed) = seeds.next(|seed| growing.judge(seed)) {
        regions.extend(growing.region(seed));
    }
    regions
}

/// Points of a group of cells: whole numbers.
#[derive(Debug, Clone, Copy, Default)]
struct Held {
    all: f64,
    free: f64,
}

impl Held {
    fn add(self, other: Self) -> Self {
        Self { all: self.all + other.all, free: self.free + other.free }
    }

    /// Whether enough are of no region.
    fn is_free(self) -> bool {
        self.free > 0.0 && self.free >= SEED_FREE * self.all
    }
}

/// Regions on their way.
pub(crate) struct Growing<'a, 'f> {
    field: &'f Field,
    growth: Growth,
    arounds: &'a mut Arounds<'f>,
    /// Whether a cell is of a region already.
    owned: Vec<bool>,
    /// By level and group, all points and those of no region yet; without the finest level, whose groups are the cells.
    coarser: Vec<Vec<Held>>,
    /// By level and group, when it was last reached.
    reached: Vec<Vec<u32>>,
    clock: u32,
}

impl<'a, 'f> Growing<'a, 'f> {
    /// With all cells free.
    pub(crate) fn of(arounds: &'a mut Arounds<'f>, growth: Growth) -> Self {
        let field = arounds.field();
        arounds.limit(growth.noise, TURNED, TURNED_ERRORS);
        let reached = field.levels.iter().map(|level| vec![0; level.len()]).collect();
        let of_level = |level: &Level| {
            let of_group = |group: usize| {
                let all = level.cells(group).map(|cell| field.cells[cell as usize].points).sum();
                Held { all, free: all }
            };
            (0..level.len()).map(of_group).collect()
        };
        let coarser = field.levels.iter().skip(1).map(of_level).collect();
        Self { field, growth, arounds, owned: vec![false; field.cells.len()], coarser, reached, clock: 0 }
    }

    /// How sure the orientation at a seed is; `None` when it cannot begin a region, now or later.
    fn judge(&mut self, seed: &Seed) -> Option<f64> {
        let (level, group) = (&self.field.levels[seed.level], seed.group as usize);
        let own = self.held(seed.level, group);
        let near = level.near(group).iter().map(|near| self.held(seed.level, *near as usize));
        if !own.is_free() || !near.fold(own, Held::add).is_free() {
            return None;
        }
        let noise = self.growth.noise;
        let around = self.arounds.get(seed.level, group)?;
        let tilt = around.is_flat(noise, SEED_CHI_SQUARED, SEED_WIDTH).then(|| around.tilt(noise));
        tilt.filter(|tilt| *tilt <= SEED_TILT)
    }

    /// Grows a region from the plane around its seed.
    fn region(&mut self, seed: Seed) -> Option<Region> {
        let plane = self.arounds.get(seed.level, seed.group as usize)?.plane;
        self.settled(seed, plane, 0.0, 0)
    }

    /// Grows a region once more, from its own plane; `None` when others have most of its cells by now.
    pub(crate) fn again(&mut self, region: &Region) -> Option<Region> {
        let (plane, cells) = (region.fitted.plane, &region.cells);
        let held = cells.iter().map(|cell| self.held(0, *cell as usize));
        if !held.fold(Held::default(), Held::add).is_free() {
            return None;
        }
        self.settled(region.seed, plane, self.spread(cells, &plane), cells.len())
    }

    /// Grows and fits until the number of cells stays; they are of no other region then.
    fn settled(&mut self, seed: Seed, mut plane: Flat, mut spread: f64, mut before: usize) -> Option<Region> {
        let field = self.field;
        let mut found: Option<Region> = None;
        let rounds = if self.growth.without == Some(Step::Refit) { 1 } else { ROUNDS };
        for _ in 0..rounds {
            let cells = self.flood(&seed, &plane, spread);
            if cells.len() < FEWEST_CELLS {
                return None;
            }
            let fitted = field.fit(&cells, self.growth.noise)?;
            plane = fitted.plane;
            spread = self.spread(&cells, &plane);
            let stays = cells.len() == before;
            before = cells.len();
            found = Some(Region { cells, fitted, seed });
            if stays {
                break;
            }
        }
        let found = found.filter(|region| region.fitted.points() >= FEWEST_POINTS)?;
        for cell in found.cells.iter().map(|cell| *cell as usize) {
            self.owned[cell] = true;
            for (level, held) in field.levels.iter().skip(1).zip(&mut self.coarser) {
                held[level.group(cell) as usize].free -= field.cells[cell].points;
            }
        }
        Some(found)
    }

    /// The points of a group of a level.
    fn held(&self, level: usize, group: usize) -> Held {
        if let Some(coarser) = level.checked_sub(1) {
            return self.coarser[coarser][group];
        }
        let all = self.field.cells[group].points;
        Held { all, free: if self.owned[group] { 0.0 } else { all } }
    }

    /// The free cells on the plane that hang together with the seed, group by group at its resolution; where surfaces scatter by more
    /// than errors say, at that of a coarser cell at most: what lies beyond a gap may then be on the plane by chance.
    fn flood(&mut self, seed: &Seed, plane: &Flat, spread: f64) -> Vec<u32> {
        self.clock += 1;
        let of_seed = &self.field.levels[seed.level];
        let touching = if self.growth.noise.scale > 1.0 { seed.level.min(COARSE) } else { seed.level };
        let level = &self.field.levels[touching];
        let reached = &mut self.reached[touching];
        let mut queue: Vec<u32> =
            of_seed.cells(seed.group as usize).map(|cell| level.group(cell as usize)).collect();
        queue.dedup();
        if touching == seed.level {
            queue.extend(level.near(seed.group as usize));
        }
        for group in &queue {
            reached[*group as usize] = self.clock;
        }
        let mut cells: Vec<u32> = Vec::new();
        let mut next = 0;
        while let Some(group) = queue.get(next).copied() {
            next += 1;
            let before = cells.len();
            for cell in level.cells(group as usize) {
                if !self.owned[cell as usize]
                    && self.growth.lies_on(self.field, self.arounds, cell as usize, plane, spread)
                {
                    cells.push(cell);
                }
            }
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

    /// How far the means of cells scatter about the plane beyond their errors, as a variance in units of those of points; not asked where
    /// nothing is allowed for it.
    fn spread(&self, cells: &[u32], plane: &Flat) -> f64 {
        if self.growth.spread <= 0.0 {
            return 0.0;
        }
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
    fn lies_on(&self, field: &Field, arounds: &mut Arounds, cell: usize, plane: &Flat, spread: f64) -> bool {
        let sums = &field.cells[cell];
        let variance = self.noise.variance(sums, plane.normal);
        let errors = SLACK * (1.0 + SIGNIFICANT * (2.0 / sums.points).sqrt());
        let by_offset = self.without != Some(Step::Offsets);
        let allowed = variance * (errors + self.spread * self.spread * spread)
            + SLACK * SIGNIFICANT * field.uncertainty_of_shared(cell, plane.normal);
        if by_offset && sums.mean_square(plane) > allowed {
            return false;
        }
        // Nearly all cells are told by their sums.
        self.without == Some(Step::Normals)
            || arounds.is_along(cell, plane).unwrap_or_else(|| {
                arounds.get(0, cell).is_none_or(|around| {
                    around.is_row(self.noise)
                        || plane.angle(&around.plane) <= TURNED + TURNED_ERRORS * around.tilt(self.noise)
                })
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{NOISE, field, square, ungrown};
    use crate::{RegionsError, SharedNoise};
    use terrace_stats::SymmetricMatrix3;

    const STRICT: Growth = Growth { noise: NOISE, spread: 0.0, without: None };

    #[test]
    fn one_square_is_one_region_of_all_cells() {
        let field = field(&square(|x, y| [x, y, 0.05 + 0.2 * x]));
        let [region] = &grow(&mut Arounds::of(&field), STRICT)[..] else { panic!() };
        assert_eq!(region.cells.len(), field.cells.len());
        assert_eq!(region.fitted.sums.count(), 3600);
        assert!(region.fitted.reduced_chi_squared < 1e-9);
    }

    #[test]
    fn beyond_a_gap_a_region_goes_on_where_errors_are_all_there_is() {
        let near = square(|x, y| [x, y, 0.05]);
        let far = square(|x, y| [1.7 + x, y, 0.05]);
        let field = field(&[near, far].concat());
        let regions = |scale: f64| {
            let noise = Noise { scale, ..NOISE };
            grow(&mut Arounds::of(&field), Growth { noise, spread: 3.0, without: None }).len()
        };
        assert_eq!((regions(1.0), regions(1.5)), (1, 2));
    }

    #[test]
    fn what_one_scan_is_off_as_a_whole_is_on_the_plane_where_such_errors_are_told() {
        let near = square(|x, y| [x, y, 0.05]);
        let off = square(|x, y| [1.2 + x, y, 0.05 + 0.16]);
        let largest = |shared: f64| {
            let mut field = ungrown(&[&near[..], &off].concat());
            // Each place was seen by one scan: nothing averages out.
            let shared = SymmetricMatrix3::diagonal([shared * shared; 3]);
            field.add_shared_noise(|_| SharedNoise { of_points: shared, of_mean: shared }).unwrap();
            field.begin_growth();
            let regions = grow(&mut Arounds::of(&field), STRICT);
            let cells = regions.iter().map(|region| region.cells.len()).max().unwrap();
            cells as f64 / field.cells.len() as f64
        };
        assert!(largest(0.0) < 0.7 && largest(0.08) > 0.95, "{} {}", largest(0.0), largest(0.08));
        let mut field = ungrown(&near);
        let strange = SharedNoise { of_mean: SymmetricMatrix3([f64::NAN; 6]), ..SharedNoise::NONE };
        let told = |cell: usize| if cell == 3 { strange } else { SharedNoise::NONE };
        assert_eq!(field.add_shared_noise(told), Err(RegionsError::Cell { cell: 3 }));
    }

    #[test]
    fn cells_are_of_one_region_at_most_and_lie_on_its_plane() {
        // A floor with walls on two sides.
        let mut points = square(|x, y| [x, y, 0.03]);
        points.extend(square(|y, z| [0.04, y, z]));
        points.extend(square(|z, x| [x, 0.05, z]));
        let field = field(&points);
        let regions = grow(&mut Arounds::of(&field), STRICT);
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
        let mut arounds = Arounds::of(&wall);
        arounds.limit(NOISE, TURNED, TURNED_ERRORS);
        let mut lies_on = |axis| STRICT.lies_on(&wall, &mut arounds, cell, &flat(axis), 0.0);
        assert!(lies_on(0) && !lies_on(2));
    }

    #[test]
    fn nothing_grows_from_points_in_a_line_or_all_over() {
        let line: Vec<[f64; 3]> = (0..2000).map(|k| [0.001 * f64::from(k), 0.05, 0.05]).collect();
        assert_eq!(grow(&mut Arounds::of(&field(&line)), STRICT).len(), 0);
        let fraction = |k: i32, by: f64| (f64::from(k) * by).fract();
        let cloud: Vec<[f64; 3]> =
            (0..4000).map(|k| [0.8192, 0.6711, 0.5497].map(|by| fraction(k, by))).collect();
        assert_eq!(grow(&mut Arounds::of(&field(&cloud)), STRICT).len(), 0);
    }
}
