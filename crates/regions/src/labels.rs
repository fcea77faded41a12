//! Which region each point is of.

use glam::DVec3;
use rayon::prelude::*;

use crate::cell::Noise;
use crate::ends::{End, Ends};
use crate::field::Field;
use crate::flat::Flat;
use crate::grow::Region;
use crate::{RegionsError, Settings, Step};

/// Rounds in which the shares of the regions around each cell are found from the labels before.
const ROUNDS: usize = 4;
/// Shares below this are none.
const LEAST_SHARE: f64 = 1e-3;
/// A region that keeps a smaller share of the points of its cells is explained by others.
const OWN: f64 = 0.5;

/// Points, each of a cell.
#[derive(Debug, Clone, Copy)]
pub struct Points<'a> {
    /// The cell of each point; `None` for points of none, which get no label.
    pub cells: &'a [Option<u32>],
    /// Where each is, from the anchor of its cell's sums, in metres. Places that are not finite get no label.
    pub places: &'a [[f32; 3]],
}

/// The points in the order of their cells.
pub(crate) struct ByCell<'a> {
    points: Points<'a>,
    starts: Vec<usize>,
    order: Vec<u32>,
}

/// The points of a region in a cell.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Piece {
    pub(crate) region: u32,
    pub(crate) cell: u32,
    pub(crate) points: u32,
    /// Sum of their places from the anchor of the cell.
    pub(crate) sum: DVec3,
    /// Sum of their squared distances from its plane, in m².
    pub(crate) squares: f64,
}

/// What is known of a region when points are labelled.
#[derive(Debug, Clone)]
pub(crate) struct Candidate {
    pub(crate) plane: Flat,
    reduced_chi_squared: f64,
    points: f64,
}

/// Labels of points by region, and which regions are left.
pub(crate) struct Labels {
    pub(crate) of: Vec<Option<u32>>,
    pub(crate) pieces: Vec<Piece>,
}

/// A region near a cell.
struct Near {
    region: u32,
    /// The distance from its plane in standard errors of a point is `normal · place + offset`, places from the anchor.
    normal: DVec3,
    offset: f64,
    /// −2 ln of its share of the points around.
    prior: f64,
    /// Its ends at the others.
    ends: Vec<End>,
}

/// What the points of a cell are of.
struct OfCell {
    labels: Vec<Option<u32>>,
    /// Regions and how many points are expected to be of each.
    expected: Vec<(u32, f64)>,
}

impl<'a> ByCell<'a> {
    /// # Errors
    /// [`RegionsError`] when there are not as many places as points, too many points, or a point of a cell that does not exist.
    pub(crate) fn of(points: Points<'a>, cells: usize) -> Result<Self, RegionsError> {
        let (given, places) = (points.cells.len(), points.places.len());
        if given != places {
            return Err(RegionsError::Places { points: given, places });
        }
        let mut starts = vec![0_usize; cells + 1];
        for (point, cell) in points.cells.iter().enumerate() {
            let Some(cell) = cell else { continue };
            let count =
                starts[1..].get_mut(*cell as usize).ok_or(RegionsError::NoCell { point, cell: *cell })?;
            *count += 1;
        }
        for cell in 0..cells {
            starts[cell + 1] += starts[cell];
        }
        let mut next = starts.clone();
        let mut order = vec![0_u32; starts.last().copied().unwrap_or(0)];
        for (point, cell) in points.cells.iter().enumerate() {
            let Some(cell) = cell else { continue };
            let place = &mut next[*cell as usize];
            order[*place] =
                u32::try_from(point).map_err(|_| RegionsError::TooManyPoints { points: given })?;
            *place += 1;
        }
        Ok(Self { points, starts, order })
    }

    /// The places of the points of a cell, from the anchor of its sums.
    fn places(&self, cell: usize) -> impl Iterator<Item = DVec3> + '_ {
        self.of_cell(cell).iter().map(|point| DVec3::from(self.points.places[*point as usize].map(f64::from)))
    }

    /// The points of a cell.
    pub(crate) fn of_cell(&self, cell: usize) -> &[u32] {
        &self.order[self.starts[cell]..self.starts[cell + 1]]
    }

    /// Number of points of some cell.
    pub(crate) fn len(&self) -> usize {
        self.order.len()
    }
}

impl Labels {
    /// Labels points by the probability that they are of a region near their cell.
    ///
    /// # Algorithm
    /// Around each cell, points are a mixture: of region k with the share πₖ of the points there, an error of standard
    /// deviation σₖ along its normal, and, where it ends at another region's plane, only on one side of that. A point at the
    /// distance d is of the region with the greatest `ln πₖ − d²/2σₖ² + Σ ln Φ(u/σ)`, u being how far inside each end it
    /// is. The shares are those of the cells of each region at first, then those of the labels before (expectation
    /// maximisation). A region that keeps too few points of its own cells, or too few at all, is taken out on the way.
    pub(crate) fn of(
        field: &Field,
        noise: Noise,
        regions: &[Region],
        by_cell: &ByCell,
        settings: &Settings,
        fewest: f64,
    ) -> Self {
        let mut candidates: Vec<Option<Candidate>> =
            regions.iter().map(|region| Some(Candidate::of(region))).collect();
        let mut region_of: Vec<Option<u32>> = vec![None; field.cells.len()];
        for (number, region) in (0..).zip(regions) {
            for cell in &region.cells {
                region_of[*cell as usize] = Some(number);
            }
        }
        let ends = if settings.takes(Step::Ends) {
            Ends::of(field, noise, &region_of, regions)
        } else {
            Ends::default()
        };
        let labelling = Labelling { field, noise, by_cell, settings, ends };
        let first = |(cell, region): (&crate::cell::Sums, &Option<u32>)| OfCell {
            labels: Vec::new(),
            expected: region.iter().map(|region| (*region, cell.points)).collect(),
        };
        let mut of_cells: Vec<OfCell> = field.cells.iter().zip(&region_of).map(first).collect();
        for round in 1..=ROUNDS {
            of_cells = labelling.round(&of_cells, &candidates);
            // The last round labels among those that are left.
            if round < ROUNDS {
                take_out(&mut candidates, &of_cells, &region_of, fewest);
            }
        }
        labelling.collect(&of_cells, &candidates)
    }

    /// Gives the points of each piece the number of a region instead; regions are told apart by new numbers alone.
    pub(crate) fn renumber(&mut self, by_cell: &ByCell, numbers: &[u32]) {
        for (piece, number) in self.pieces.iter_mut().zip(numbers) {
            if *number == piece.region {
                continue;
            }
            for point in by_cell.of_cell(piece.cell as usize) {
                let label = &mut self.of[*point as usize];
                if *label == Some(piece.region) {
                    *label = Some(*number);
                }
            }
            piece.region = *number;
        }
    }
}

impl Candidate {
    fn of(region: &Region) -> Self {
        let fitted = &region.fitted;
        let (plane, points) = (fitted.plane, fitted.points());
        Self { plane, points, reduced_chi_squared: fitted.reduced_chi_squared }
    }
}

/// Takes out regions that keep few points.
fn take_out(
    candidates: &mut [Option<Candidate>],
    of_cells: &[OfCell],
    region_of: &[Option<u32>],
    fewest: f64,
) {
    let mut all = vec![0_u64; candidates.len()];
    let mut own = vec![0_u64; candidates.len()];
    for (cell, owner) in of_cells.iter().zip(region_of) {
        for label in cell.labels.iter().flatten() {
            all[*label as usize] += 1;
            own[*label as usize] += u64::from(*owner == Some(*label));
        }
    }
    for (candidate, (all, own)) in candidates.iter_mut().zip(all.into_iter().zip(own)) {
        let keeps = |c: &Candidate| all as f64 >= fewest && own as f64 >= OWN * c.points;
        *candidate = candidate.take().filter(keeps);
    }
}

/// What stays the same over the rounds.
struct Labelling<'a> {
    field: &'a Field,
    noise: Noise,
    by_cell: &'a ByCell<'a>,
    settings: &'a Settings,
    ends: Ends,
}

impl Labelling<'_> {
    fn round(&self, before: &[OfCell], candidates: &[Option<Candidate>]) -> Vec<OfCell> {
        (0..self.field.cells.len())
            .into_par_iter()
            .map(|cell| self.label(cell, &self.near(cell, before, candidates)))
            .collect()
    }

    /// The regions around a cell, by number.
    fn near(&self, cell: usize, before: &[OfCell], candidates: &[Option<Candidate>]) -> Vec<Near> {
        let level = &self.field.levels[0];
        let mut shares: Vec<(u32, f64)> = before[cell].expected.clone();
        for near in level.near(cell) {
            for (region, points) in &before[*near as usize].expected {
                match shares.iter_mut().find(|(known, _)| known == region) {
                    Some((_, sum)) => *sum += points,
                    None => shares.push((*region, *points)),
                }
            }
        }
        shares.retain(|(region, _)| candidates[*region as usize].is_some());
        shares.sort_unstable_by_key(|(region, _)| *region);
        let all: f64 = shares.iter().map(|(_, points)| points).sum();
        let sums = &self.field.cells[cell];
        let anchor = DVec3::from(sums.stats.anchor());
        let plane = |region: u32| candidates[region as usize].as_ref();
        let near = |(region, points): &(u32, f64)| {
            let candidate = plane(*region)?;
            let normal = candidate.plane.normal;
            // A region that is smoother than errors say is not given less of them than are stated.
            let grown = candidate.reduced_chi_squared.max(1.0 / self.noise.scale);
            let sigma = (self.noise.variance(sums, normal) * grown).sqrt();
            let others = shares.iter().filter(|(other, _)| other != region);
            let ends = others.filter_map(|(other, _)| {
                let (here, there) = ((*region, &candidate.plane), (*other, &plane(*other)?.plane));
                self.ends.between(here, there, sums, self.noise)
            });
            Some(Near {
                region: *region,
                normal: normal / sigma,
                offset: candidate.plane.distance(anchor) / sigma,
                prior: if self.settings.takes(Step::Shares) { -2.0 * (points / all).ln() } else { 0.0 },
                ends: ends.collect(),
            })
        };
        shares.iter().filter_map(near).collect()
    }

    fn label(&self, cell: usize, near: &[Near]) -> OfCell {
        let mut expected: Vec<(u32, f64)> = near.iter().map(|near| (near.region, 0.0)).collect();
        let mut scores = vec![f64::INFINITY; near.len()];
        let label = |place: DVec3| {
            let mut best: Option<(f64, u32)> = None;
            for (near, score) in near.iter().zip(&mut scores) {
                let errors = near.normal.dot(place) + near.offset;
                *score = f64::INFINITY;
                // A place that is not finite is near no plane.
                if errors.abs() > self.settings.reach || errors.is_nan() {
                    continue;
                }
                let inside: f64 = near.ends.iter().map(|end| end.ln_inside(place)).sum();
                *score = errors * errors + near.prior - 2.0 * inside;
                if best.is_none_or(|(least, _)| *score < least) {
                    best = Some((*score, near.region));
                }
            }
            let (least, region) = best?;
            let likely = |score: f64| (-0.5 * (score - least)).exp();
            let all: f64 = scores.iter().map(|score| likely(*score)).sum();
            for ((_, points), score) in expected.iter_mut().zip(&scores) {
                let share = likely(*score) / all;
                *points += if share > LEAST_SHARE { share } else { 0.0 };
            }
            Some(region)
        };
        let labels =
            if near.is_empty() { Vec::new() } else { self.by_cell.places(cell).map(label).collect() };
        expected.retain(|(_, points)| *points > 0.0);
        OfCell { labels, expected }
    }

    /// The labels by point, of the regions that are left.
    fn collect(&self, of_cells: &[OfCell], candidates: &[Option<Candidate>]) -> Labels {
        let mut of: Vec<Option<u32>> = vec![None; self.by_cell.points.cells.len()];
        let mut pieces: Vec<Piece> = Vec::new();
        for (number, cell) in (0..).zip(of_cells) {
            let first = pieces.len();
            let anchor = DVec3::from(self.field.cells[number as usize].stats.anchor());
            let points =
                self.by_cell.of_cell(number as usize).iter().zip(self.by_cell.places(number as usize));
            for ((point, place), label) in points.zip(&cell.labels) {
                let known = |region: u32| Some((region, candidates[region as usize].as_ref()?));
                let Some((region, candidate)) = label.and_then(known) else { continue };
                of[*point as usize] = Some(region);
                let squares = candidate.plane.distance(anchor + place).powi(2);
                match pieces[first..].iter_mut().find(|piece| piece.region == region) {
                    Some(piece) => {
                        piece.points += 1;
                        piece.sum += place;
                        piece.squares += squares;
                    }
                    None => pieces.push(Piece { region, cell: number, points: 1, sum: place, squares }),
                }
            }
        }
        Labels { of, pieces }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn points_by_cell_are_the_points_in_another_order(
            cells in prop::collection::vec(prop::option::weighted(0.9, 0..9_u32), 0..200),
        ) {
            let places: Vec<[f32; 3]> = (0..cells.len()).map(|point| [point as f32, 0.5, -1.0]).collect();
            let by_cell = ByCell::of(Points { cells: &cells, places: &places }, 9).unwrap();
            prop_assert_eq!(by_cell.len(), cells.iter().flatten().count());
            for cell in 0..9_u32 {
                let expected: Vec<u32> = (0..).zip(&cells).filter(|(_, of)| **of == Some(cell)).map(|(point, _)| point).collect();
                prop_assert_eq!(by_cell.of_cell(cell as usize), &expected[..]);
                let places: Vec<DVec3> = by_cell.places(cell as usize).collect();
                let expected: Vec<DVec3> = expected.iter().map(|point| DVec3::new(f64::from(*point), 0.5, -1.0)).collect();
                prop_assert_eq!(places, expected);
            }
        }
    }
}
