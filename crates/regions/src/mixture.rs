//! How many points of each cell are of which region.

use rayon::prelude::*;

use crate::cell::{Noise, Sums};
use crate::ends::{End, Ends};
use crate::field::Field;
use crate::flat::Flat;
use crate::grow::Region;
use crate::near::{Near, Nearby, Several};
use crate::of_cells::{Difference, NOTHING, OfCells, Part, Parts, SEVERAL};
use crate::samples::{Sample, Spot};
use crate::weighed::{Kept, Weighed};
use crate::{Settings, Step};

/// Rounds in which the shares of the regions around each cell are found from the labels before.
const ROUNDS: usize = 4;
/// A region that keeps a smaller share of the points of its cells is explained by others.
const OWN: f64 = 0.5;
/// Cells that are handed to a thread at once.
const AT_ONCE: usize = 256;

/// What is known of a region when points are labelled.
#[derive(Debug, Clone)]
struct Candidate {
    plane: Flat,
    reduced_chi_squared: f64,
    points: f64,
}

/// All cells as they were in the round before.
#[derive(Clone, Copy)]
struct Before<'a> {
    parts: &'a [Parts],
    codes: &'a [u32],
}

/// Memory that a thread works with.
#[derive(Default)]
struct Work<'s> {
    /// The cells that are looked at, and those of them whose sample is.
    todo: Vec<usize>,
    anew: Vec<usize>,
    shares: Vec<(u32, f64)>,
    ends: Vec<End>,
    parts: Vec<Part>,
    likely: Vec<f32>,
    samples: Vec<Sample<'s>>,
    spots: Vec<Spot>,
    /// The places of these, one after the other, and where each begins.
    places: Vec<[f32; 3]>,
    starts: Vec<usize>,
}

/// A cell that was looked at.
struct Seen {
    parts: Parts,
    /// Whether some of its points may be of two regions.
    is_open: bool,
    /// From what it was before.
    difference: Difference,
}

/// What is known of the surroundings of each cell.
struct Around {
    nearby: Vec<Nearby>,
    /// Where that of its sample is kept which several regions are near.
    kept: Vec<Kept>,
    /// By as many cells as are handed to a thread at once.
    weighed: Vec<Weighed>,
}

impl Around {
    fn new(cells: usize) -> Self {
        let (nearby, kept) = (vec![Nearby::None; cells], vec![Kept::default(); cells]);
        Self { nearby, kept, weighed: vec![Weighed::default(); cells.div_ceil(AT_ONCE)] }
    }

    fn chunks_mut(&mut self) -> impl IndexedParallelIterator<Item = AroundSome<'_>> {
        let chunks = self.nearby.par_chunks_mut(AT_ONCE).zip(self.kept.par_chunks_mut(AT_ONCE));
        let some = |((nearby, kept), weighed)| AroundSome { nearby, kept, weighed };
        chunks.zip(&mut self.weighed).map(some)
    }
}

/// That of some cells on end.
struct AroundSome<'a> {
    nearby: &'a mut [Nearby],
    kept: &'a mut [Kept],
    weighed: &'a mut Weighed,
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

impl<'s, S: Fn(usize) -> Sample<'s> + Sync> Mixture<'_, S> {
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
    pub(crate) fn solve(&self, regions: &[Region]) -> OfCells {
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
        let first = |(cell, region): (&Sums, &Option<u32>)| {
            let part = |region| Part { region, expected: cell.points, labelled: 0.0 };
            region.map_or(Parts::None, |region| Parts::One(part(region)))
        };
        let mut parts: Vec<Parts> = self.field.cells.iter().zip(&region_of).map(first).collect();
        let mut codes: Vec<u32> = parts.iter().map(Parts::code).collect();
        let mut around = Around::new(cells);
        // Whether some point of a cell may be of two regions: their shares then matter.
        let mut is_open = vec![false; cells];
        let mut again = vec![true; cells];
        for round in 1..=ROUNDS {
            let before = Before { parts: &parts, codes: &codes };
            let found = self.look_again(&again, &mut around, before, &candidates, &ends);
            let mut changed = Vec::new();
            let todo = (0..cells).filter(|cell| again[*cell]);
            for (cell, Seen { parts: now, is_open: open, difference }) in
                todo.zip(found.into_iter().flatten())
            {
                if difference != Difference::None {
                    changed.push((cell, difference));
                }
                (codes[cell], parts[cell], is_open[cell]) = (now.code(), now, open);
            }
            // By what all cells are now, whichever was looked at first.
            again.fill(false);
            for (cell, difference) in changed {
                let matters = |near: usize| difference == Difference::Regions || is_open[near];
                self.mark_around(cell, &mut again, matters);
            }
            // The last round labels among those that are left.
            if round < ROUNDS && self.take_out(&mut candidates, &parts, &region_of) {
                for cell in 0..cells {
                    let left = |region: u32| candidates[region as usize].is_some();
                    if !parts[cell].regions().all(left) {
                        parts[cell].retain(left);
                        codes[cell] = parts[cell].code();
                        self.mark_around(cell, &mut again, |_| true);
                    }
                    again[cell] |= !around.nearby[cell].regions().iter().all(|near| left(near.region));
                }
            }
        }
        OfCells { nearby: around.nearby, parts }
    }

    /// Looks at some cells: finds what is near them, in place of what was, and gives their parts. The samples of those that have the same
    /// regions near them are not looked at again.
    fn look_again(
        &self,
        again: &[bool],
        around: &mut Around,
        before: Before<'_>,
        candidates: &[Option<Candidate>],
        ends: &Ends,
    ) -> Vec<Vec<Seen>> {
        let cells = again.par_chunks(AT_ONCE).zip(around.chunks_mut()).enumerate();
        let of_some = |work: &mut Work<'s>, (number, (again, some)): (usize, (&[bool], AroundSome<'_>))| {
            let AroundSome { nearby, kept, weighed } = some;
            let first = number * AT_ONCE;
            work.todo.clear();
            work.todo.extend((0..again.len()).filter(|at| again[*at]));
            work.anew.clear();
            for number in 0..work.todo.len() {
                let at = work.todo[number];
                let known = std::mem::replace(&mut nearby[at], Nearby::None);
                let (now, is_new) = self.nearby(first + at, known, before, candidates, ends, work);
                nearby[at] = now;
                if is_new {
                    work.anew.push(at);
                }
            }
            work.unpack(self, first);
            let mut anew = 0;
            let mut found = Vec::with_capacity(work.todo.len());
            for number in 0..work.todo.len() {
                let at = work.todo[number];
                let place = (work.anew.get(anew) == Some(&at)).then_some(anew);
                anew += usize::from(place.is_some());
                let kept = (&mut kept[at], &mut *weighed);
                let (parts, is_open) = self.look(first + at, &nearby[at], place, before, kept, work);
                let points = self.field.cells[first + at].points;
                let difference = parts.differ(&before.parts[first + at], points);
                found.push(Seen { parts, is_open, difference });
            }
            found
        };
        cells.map_init(Work::default, of_some).collect()
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
        parts: &[Parts],
        region_of: &[Option<u32>],
    ) -> bool {
        let mut all = vec![0.0; candidates.len()];
        let mut own = vec![0.0; candidates.len()];
        for (parts, owner) in parts.iter().zip(region_of) {
            for part in parts.as_slice() {
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

    /// The regions around a cell, by number, and whether these are others than before, which `known` are. `work` is memory to work with.
    fn nearby(
        &self,
        cell: usize,
        known: Nearby,
        before: Before<'_>,
        candidates: &[Option<Candidate>],
        ends: &Ends,
        work: &mut Work<'s>,
    ) -> (Nearby, bool) {
        let Work { shares, ends: here_ends, .. } = work;
        shares.clear();
        let around =
            || std::iter::once(cell).chain(self.field.levels[0].near(cell).iter().map(|near| *near as usize));
        // Nearly all cells have points of one region around them, whose share then does not matter.
        let mut only = NOTHING;
        let alone = around().all(|near| {
            let code = before.codes[near];
            only = if only == NOTHING { code } else { only };
            (code == only || code == NOTHING) && code != SEVERAL
        });
        if alone {
            shares.extend((only != NOTHING).then_some((only, 1.0)));
        } else {
            for part in around().flat_map(|near| before.parts[near].as_slice()) {
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
        let prior = |points: f64| {
            single(if self.settings.takes(Step::Shares) { -2.0 * (points / all).ln() } else { 0.0 })
        };
        if known.regions().iter().map(|near| near.region).eq(shares.iter().map(|(region, _)| *region)) {
            // The same, but for their shares.
            if let Nearby::Several(mut several) = known {
                for (near, (_, points)) in several.near.iter_mut().zip(&*shares) {
                    near.prior = prior(*points);
                }
                return (Nearby::Several(several), false);
            }
            return (known, false);
        }
        let (sums, anchor) = (&self.field.cells[cell], self.field.anchors[cell]);
        let near = |(region, points): (u32, f64)| {
            let candidate = plane(region)?;
            let normal = candidate.plane.normal;
            // A region that is smoother than errors say is not given less of them than are stated.
            let grown = candidate.reduced_chi_squared.max(1.0 / self.noise.scale);
            let sigma = (self.noise.variance(sums, normal) * grown).sqrt();
            let offset = candidate.plane.distance(anchor) / sigma;
            Some(Near {
                region,
                normal: (normal / sigma).to_array().map(single),
                offset: single(offset),
                prior: prior(points),
                ends: (0, 0),
            })
        };
        let now = match shares[..] {
            [] => Nearby::None,
            [one] => near(one).map_or(Nearby::None, Nearby::One),
            _ => {
                let mut all = Vec::with_capacity(shares.len());
                here_ends.clear();
                for share in shares.iter() {
                    let (Some(mut near), Some(here)) = (near(*share), plane(share.0)) else { continue };
                    let first = here_ends.len();
                    for (other, _) in shares.iter().filter(|(other, _)| *other != share.0) {
                        let Some(there) = plane(*other) else { continue };
                        let (here, there) = ((share.0, &here.plane), (*other, &there.plane));
                        here_ends.extend(ends.between(here, there, (sums, anchor), self.noise));
                    }
                    let count = here_ends.len() - first;
                    // Pairs of regions near one cell: far fewer than 2³².
                    near.ends = (u32::try_from(first).unwrap_or(0), u32::try_from(count).unwrap_or(0));
                    all.push(near);
                }
                Nearby::Several(Several { near: all.into(), ends: here_ends.as_slice().into() })
            }
        };
        (now, true)
    }

    /// What the points of a cell are of, with these regions near it, and whether some may be of two. `anew` tells which sample in `work` is
    /// its own, if others were near it before; what is known of it otherwise, or now, is `kept` there in `weighed`.
    fn look(
        &self,
        cell: usize,
        nearby: &Nearby,
        anew: Option<usize>,
        before: Before<'_>,
        (kept, weighed): (&mut Kept, &mut Weighed),
        work: &mut Work<'s>,
    ) -> (Parts, bool) {
        let points = self.field.cells[cell].points;
        let Work { places, starts, parts, likely, .. } = work;
        let places = anew.map(|at| &places[starts[at]..starts[at + 1]]);
        let reach = single(self.settings.reach);
        match (nearby, places) {
            (Nearby::None, _) => (Parts::None, false),
            // Its share does not matter.
            (Nearby::One(_), None) => (before.parts[cell].clone(), false),
            (Nearby::One(near), Some(places)) => {
                let within = places.iter().filter(|place| near.errors(**place, reach).is_some()).count();
                let points = within as f64 * (points / places.len() as f64);
                let part = Part { region: near.region, expected: points, labelled: points };
                (if within > 0 { Parts::One(part) } else { Parts::None }, false)
            }
            (Nearby::Several(several), places) => {
                if let Some(places) = places {
                    *kept = weighed.weigh(several, places, reach);
                }
                weighed.mixed(*kept, several, points, (parts, likely))
            }
        }
    }

    /// Places of some points of a cell, at least one, for a cell has points; each with the number of points that it stands for.
    pub(crate) fn weighted(&self, cell: usize) -> impl Iterator<Item = ([f32; 3], f64)> {
        let (sample, points) = ((self.samples)(cell), self.field.cells[cell].points);
        let middle = if sample.is_empty() { self.field.middle(cell) } else { None };
        middle.into_iter().map(move |place| (place, points)).chain(sample.weighted(points))
    }
}

impl<'s> Work<'s> {
    /// Finds the places of samples of the cells that are looked at, the first of all being of this number. Step by step: so the memory of
    /// one is not waited for before that of the next is asked for.
    fn unpack<S: Fn(usize) -> Sample<'s> + Sync>(&mut self, mixture: &Mixture<'_, S>, first: usize) {
        let Self { anew, samples, spots, places, starts, .. } = self;
        samples.clear();
        samples.extend(anew.iter().map(|at| (mixture.samples)(first + at)));
        Sample::unpack(samples, spots, places, starts);
        // A cell has points.
        for ((at, start), sample) in anew.iter().zip(&*starts).zip(&*samples) {
            if sample.is_empty()
                && let Some(middle) = mixture.field.middle(first + at)
            {
                places[*start] = middle;
            }
        }
    }
}

/// Places are in single precision, and so is what they are held against.
#[allow(clippy::cast_possible_truncation)]
fn single(x: f64) -> f32 {
    x as f32
}
