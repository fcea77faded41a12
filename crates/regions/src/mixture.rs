//! How many points of each cell are of which region.

use rayon::prelude::*;

use crate::cell::{Noise, Sums};
use crate::ends::Ends;
use crate::field::Field;
use crate::flat::Flat;
use crate::grow::Region;
use crate::near::{Near, Nearby, Several};
use crate::{Settings, Step};

/// Rounds in which the shares of the regions around each cell are found from the labels before.
const ROUNDS: usize = 4;
/// Shares below this are none.
const LEAST_SHARE: f64 = 1e-3;
/// Shares of the points of a cell that change by less have settled.
const SETTLED: f64 = 0.02;
/// A region that keeps a smaller share of the points of its cells is explained by others.
const OWN: f64 = 0.5;
/// Cells that are handed to a thread at once.
const AT_ONCE: usize = 256;

/// What is known of a region when points are labelled.
#[derive(Debug, Clone)]
pub(crate) struct Candidate {
    pub(crate) plane: Flat,
    reduced_chi_squared: f64,
    points: f64,
}

/// The points of a cell that are of a region.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Part {
    pub(crate) region: u32,
    /// How many are expected to be.
    expected: f64,
    /// How many are more probably of it than of any other.
    pub(crate) labelled: f64,
}

/// What the points of a cell are of.
#[derive(Debug, Clone)]
pub(crate) struct OfCell {
    pub(crate) nearby: Nearby,
    pub(crate) parts: Parts,
    /// Whether some point may be of two regions: their shares then matter.
    is_open: bool,
}

/// How a cell differs from what it was before.
enum Difference {
    None,
    /// More of its points are of one region than before, by what matters.
    Shares,
    /// Its points are of other regions.
    Regions,
}

impl OfCell {
    fn differs(&self, before: &Self, points: f64) -> Difference {
        let (now, before) = (self.parts.as_slice(), before.parts.as_slice());
        if !now.iter().map(|part| part.region).eq(before.iter().map(|part| part.region)) {
            return Difference::Regions;
        }
        let moved = |(now, before): (&Part, &Part)| (now.expected - before.expected).abs() > SETTLED * points;
        if now.iter().zip(before).any(moved) { Difference::Shares } else { Difference::None }
    }
}

/// By number of the region.
#[derive(Debug, Clone)]
pub(crate) enum Parts {
    None,
    One(Part),
    Several(Box<[Part]>),
}

impl Parts {
    pub(crate) fn as_slice(&self) -> &[Part] {
        match self {
            Self::None => &[],
            Self::One(part) => std::slice::from_ref(part),
            Self::Several(parts) => parts,
        }
    }

    fn regions(&self) -> impl Iterator<Item = u32> {
        self.as_slice().iter().map(|part| part.region)
    }

    fn of(parts: &[Part]) -> Self {
        match parts {
            [] => Self::None,
            [one] => Self::One(*one),
            parts => Self::Several(parts.into()),
        }
    }

    fn retain(&mut self, keep: impl Fn(u32) -> bool) {
        if !self.regions().all(&keep) {
            let kept: Vec<Part> = self.as_slice().iter().filter(|part| keep(part.region)).copied().collect();
            *self = Self::of(&kept);
        }
    }
}

/// What stays the same over the rounds.
pub(crate) struct Mixture<'a, S> {
    pub(crate) field: &'a Field,
    pub(crate) noise: Noise,
    /// Some points of each cell.
    pub(crate) samples: S,
    pub(crate) settings: &'a Settings,
    pub(crate) fewest: f64,
}

impl Candidate {
    fn of(region: &Region) -> Self {
        let fitted = &region.fitted;
        let (plane, points) = (fitted.plane, fitted.points());
        Self { plane, points, reduced_chi_squared: fitted.reduced_chi_squared }
    }
}

impl<'s, S: Fn(usize) -> &'s [[f32; 3]] + Sync> Mixture<'_, S> {
    /// Finds how many points of each cell are of which region near it, and the regions that are left.
    ///
    /// # Algorithm
    /// Around each cell, points are a mixture: of region k with the share πₖ of the points there, an error of standard
    /// deviation σₖ along its normal, and, where it ends at another region's plane, only on one side of that. A point at the
    /// distance d is of the region with the greatest `ln πₖ − d²/2σₖ² + Σ ln Φ(u/σ)`, u being how far inside each end it
    /// is. The shares are those of the cells of each region at first, then those of the labels before (expectation
    /// maximisation), by a sample of the points of each cell. A region that keeps too few points of its own cells, or too few at all,
    /// is taken out on the way.
    ///
    /// A cell is looked at again only where that can change something: the regions near it are others than before, or some of its points
    /// may be of two regions, and the shares around have changed.
    pub(crate) fn solve(&self, regions: &[Region]) -> (Vec<OfCell>, Vec<Option<Candidate>>) {
        let cells = self.field.cells.len();
        let mut candidates: Vec<Option<Candidate>> =
            regions.iter().map(|region| Some(Candidate::of(region))).collect();
        let mut region_of: Vec<Option<u32>> = vec![None; cells];
        for (number, region) in (0..).zip(regions) {
            for cell in &region.cells {
                region_of[*cell as usize] = Some(number);
            }
        }
        let ends = if self.settings.takes(Step::Ends) {
            Ends::of(self.field, self.noise, &region_of, regions)
        } else {
            Ends::default()
        };
        let first = |(cell, region): (&Sums, &Option<u32>)| OfCell {
            nearby: Nearby::None,
            parts: region.map_or(Parts::None, |region| {
                Parts::One(Part { region, expected: cell.points, labelled: 0.0 })
            }),
            is_open: false,
        };
        let mut of_cells: Vec<OfCell> = self.field.cells.iter().zip(&region_of).map(first).collect();
        let mut again = vec![true; cells];
        for round in 1..=ROUNDS {
            let todo: Vec<usize> = (0..cells).filter(|cell| again[*cell]).collect();
            let found: Vec<OfCell> = todo
                .par_iter()
                .with_min_len(AT_ONCE)
                .map_init(Vec::new, |shares, cell| {
                    let nearby = self.nearby(*cell, &of_cells, &candidates, &ends, shares);
                    self.look(*cell, nearby)
                })
                .collect();
            let different = |(cell, now): (&usize, &OfCell)| {
                now.differs(&of_cells[*cell], self.field.cells[*cell].points)
            };
            let differences: Vec<Difference> = todo.iter().zip(&found).map(different).collect();
            for (cell, now) in todo.iter().zip(found) {
                of_cells[*cell] = now;
            }
            // By what all cells are now, whichever was looked at first.
            again.fill(false);
            for (cell, difference) in todo.iter().zip(differences) {
                match difference {
                    Difference::Regions => self.mark_around(*cell, &mut again, |_| true),
                    Difference::Shares => self.mark_around(*cell, &mut again, |near| of_cells[near].is_open),
                    Difference::None => {}
                }
            }
            // The last round labels among those that are left.
            if round < ROUNDS && self.take_out(&mut candidates, &of_cells, &region_of) {
                for cell in 0..cells {
                    let left = |region: u32| candidates[region as usize].is_some();
                    if !of_cells[cell].parts.regions().all(left) {
                        of_cells[cell].parts.retain(left);
                        self.mark_around(cell, &mut again, |_| true);
                    }
                    again[cell] |= !of_cells[cell].nearby.regions().iter().all(|near| left(near.region));
                }
            }
        }
        (of_cells, candidates)
    }

    fn mark_around(&self, cell: usize, marks: &mut [bool], is_meant: impl Fn(usize) -> bool) {
        marks[cell] |= is_meant(cell);
        for near in self.field.levels[0].near(cell) {
            marks[*near as usize] |= is_meant(*near as usize);
        }
    }

    /// Takes out regions that keep few points, and tells whether there are any.
    fn take_out(
        &self,
        candidates: &mut [Option<Candidate>],
        of_cells: &[OfCell],
        region_of: &[Option<u32>],
    ) -> bool {
        let mut all = vec![0.0; candidates.len()];
        let mut own = vec![0.0; candidates.len()];
        for (cell, owner) in of_cells.iter().zip(region_of) {
            for part in cell.parts.as_slice() {
                all[part.region as usize] += part.labelled;
                own[part.region as usize] += if *owner == Some(part.region) { part.labelled } else { 0.0 };
            }
        }
        let before = candidates.iter().flatten().count();
        for (candidate, (all, own)) in candidates.iter_mut().zip(all.into_iter().zip(own)) {
            let keeps = |c: &Candidate| all >= self.fewest && own >= OWN * c.points;
            *candidate = candidate.take().filter(keeps);
        }
        candidates.iter().flatten().count() < before
    }

    /// The regions around a cell, by number. `shares` is memory to work with.
    fn nearby(
        &self,
        cell: usize,
        before: &[OfCell],
        candidates: &[Option<Candidate>],
        ends: &Ends,
        shares: &mut Vec<(u32, f64)>,
    ) -> Nearby {
        shares.clear();
        let around =
            || std::iter::once(cell).chain(self.field.levels[0].near(cell).iter().map(|near| *near as usize));
        // Nearly all cells have points of one region around them, whose share then does not matter.
        let mut only: Option<u32> = None;
        let alone = around().all(|near| match &before[near].parts {
            Parts::None => true,
            Parts::One(part) => *only.get_or_insert(part.region) == part.region,
            Parts::Several(_) => false,
        });
        if alone {
            shares.extend(only.map(|region| (region, 1.0)));
        } else {
            for part in around().flat_map(|near| before[near].parts.as_slice()) {
                match shares.iter_mut().find(|(known, _)| *known == part.region) {
                    Some((_, sum)) => *sum += part.expected,
                    None => shares.push((part.region, part.expected)),
                }
            }
        }
        let plane = |region: u32| candidates[region as usize].as_ref();
        shares.retain(|(region, _)| plane(*region).is_some());
        shares.sort_unstable_by_key(|(region, _)| *region);
        let all: f64 = shares.iter().map(|(_, points)| points).sum();
        let sums = &self.field.cells[cell];
        let near = |(region, points): (u32, f64)| {
            let candidate = plane(region)?;
            let normal = candidate.plane.normal;
            // A region that is smoother than errors say is not given less of them than are stated.
            let grown = candidate.reduced_chi_squared.max(1.0 / self.noise.scale);
            let sigma = (self.noise.variance(sums, normal) * grown).sqrt();
            let prior = if self.settings.takes(Step::Shares) { -2.0 * (points / all).ln() } else { 0.0 };
            let offset = candidate.plane.distance(sums.anchor) / sigma;
            Some(Near {
                region,
                normal: (normal / sigma).to_array().map(single),
                offset: single(offset),
                prior: single(prior),
                ends: (0, 0),
            })
        };
        match shares[..] {
            [] => Nearby::None,
            [one] => near(one).map_or(Nearby::None, Nearby::One),
            _ => {
                let mut several = Several::default();
                for share in shares.iter() {
                    let (Some(mut near), Some(here)) = (near(*share), plane(share.0)) else { continue };
                    let first = several.ends.len();
                    for (other, _) in shares.iter().filter(|(other, _)| *other != share.0) {
                        let Some(there) = plane(*other) else { continue };
                        let (here, there) = ((share.0, &here.plane), (*other, &there.plane));
                        several.ends.extend(ends.between(here, there, sums, self.noise));
                    }
                    let count = several.ends.len() - first;
                    // Pairs of regions near one cell: far fewer than 2³².
                    near.ends = (u32::try_from(first).unwrap_or(0), u32::try_from(count).unwrap_or(0));
                    several.near.push(near);
                }
                Nearby::Several(Box::new(several))
            }
        }
    }

    /// What the points of a cell are of, with these regions near it.
    fn look(&self, cell: usize, nearby: Nearby) -> OfCell {
        let points = self.field.cells[cell].points;
        let places = self.places(cell);
        let each = points / places.len() as f64;
        let reach = single(self.settings.reach);
        let (parts, is_open) = match &nearby {
            Nearby::None => (Parts::None, false),
            Nearby::One(near) => {
                let within = places.iter().filter(|place| near.errors(**place, reach).is_some()).count();
                let points = within as f64 * each;
                let part = Part { region: near.region, expected: points, labelled: points };
                (if within > 0 { Parts::One(part) } else { Parts::None }, false)
            }
            Nearby::Several(several) => several.mixed(places, each, reach),
        };
        OfCell { nearby, parts, is_open }
    }

    /// Some points of a cell, at least one: a cell has points.
    pub(crate) fn places<'t>(&'t self, cell: usize) -> &'t [[f32; 3]]
    where
        's: 't,
    {
        match (self.samples)(cell) {
            [] => self.field.middle(cell),
            places => places,
        }
    }
}

impl Several {
    /// The parts of a cell with a sample of points that stand for so many `each`, and whether any could be of two regions.
    fn mixed(&self, places: &[[f32; 3]], each: f64, reach: f32) -> (Parts, bool) {
        let mut parts: Vec<Part> =
            self.near.iter().map(|near| Part { region: near.region, expected: 0.0, labelled: 0.0 }).collect();
        let mut scores = vec![f32::INFINITY; parts.len()];
        let mut is_open = false;
        for place in places {
            let (mut least, mut best, mut within) = (f32::INFINITY, None, 0);
            for ((at, near), score) in self.near.iter().enumerate().zip(&mut scores) {
                *score = self.score(near, *place, reach).unwrap_or(f32::INFINITY);
                within += usize::from(*score < f32::INFINITY);
                if *score < least {
                    (least, best) = (*score, Some(at));
                }
            }
            let Some(best) = best else { continue };
            parts[best].labelled += each;
            if within == 1 {
                parts[best].expected += each;
                continue;
            }
            is_open = true;
            let likely = |score: f32| f64::from(-0.5 * (score - least)).exp();
            let all: f64 = scores.iter().map(|score| likely(*score)).sum();
            for (part, score) in parts.iter_mut().zip(&scores) {
                let share = likely(*score) / all;
                part.expected += if share > LEAST_SHARE { each * share } else { 0.0 };
            }
        }
        parts.retain(|part| part.expected > 0.0);
        (Parts::of(&parts), is_open)
    }
}

/// Places are in single precision, and so is what they are held against.
#[allow(clippy::cast_possible_truncation)]
fn single(x: f64) -> f32 {
    x as f32
}
