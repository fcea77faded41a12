//! The fine cells, as regions take them.

use terrace_grid::{Assignment, CellId, VoxelGrid};
use terrace_regions::{
    Cells, Field, Found, Order, PartOf, RegionsError, Sample, Samples, Share, SharedNoise, Together,
};
use terrace_stats::{Moments, Stats, SymmetricMatrix3};
use terrace_types::PlaneId;

use super::MOSTLY;
use crate::estimate::Errors;
use crate::mapper::Coarse;

/// Cells stay whole where the standard error of a point, along an axis in the mean, is more than this share of half their edge: parts
/// of such a cell all have points of the same places, and tell together what it tells alone.
const BLURRED: f64 = 0.4;

/// The cells of half the cell size, and whole ones in the place of those where errors are large.
pub(crate) struct Fine<'m> {
    coarse: &'m Coarse,
    samples: &'m Samples,
    cells: Vec<Source>,
    /// The larger cell that each is a part of, or is.
    of: Vec<CellId>,
    /// Of which whole cells others are parts, until these are [sampled](Self::sample_wholes).
    parts: Vec<PartOf>,
    /// Samples of the points of whole cells.
    of_whole: Option<Together<'m>>,
    /// By cell of the grid, its place among the cells; empty where that is the same for all.
    pub(crate) places: Vec<Option<u32>>,
    /// Points of all cells.
    pub(crate) points: u64,
}

/// Where the sums and the sample of a cell are.
#[derive(Debug, Clone, Copy)]
enum Source {
    /// A cell of the grid.
    Half(CellId),
    /// A whole cell, by its place among those.
    Whole(u32),
}

impl<'m> Fine<'m> {
    /// Sums that overflow are no cell of a region: their points are of no plane.
    pub(crate) fn of(grid: &VoxelGrid, coarse: &'m Coarse, samples: &'m Samples) -> Self {
        let is_whole: Vec<bool> =
            coarse.grid.founded().map(|cell| is_blurred(cell.moments(), grid.cell_size())).collect();
        let mut fine = Self {
            coarse,
            samples,
            cells: Vec::with_capacity(grid.len()),
            of: Vec::with_capacity(grid.len()),
            parts: Vec::new(),
            of_whole: None,
            places: Vec::new(),
            points: 0,
        };
        // By larger cell, its number among the whole ones and its place among all.
        let mut wholes: Vec<Option<(u32, Option<u32>)>> = vec![None; coarse.grid.len()];
        let mut whole = 0;
        let mut places: Vec<Option<u32>> = Vec::with_capacity(grid.len());
        for ((number, cell), of) in (0..).zip(grid.founded()).zip(&coarse.of) {
            let place = u32::try_from(fine.cells.len()).ok();
            let points = cell.density();
            if is_whole[of.index()] {
                let (whole, place) = *wholes[of.index()].get_or_insert_with(|| {
                    fine.push(Source::Whole(whole), *of);
                    whole += 1;
                    (whole - 1, place)
                });
                // Were there more, others would be sampled as if there were not.
                let points = u32::try_from(points).unwrap_or(u32::MAX);
                fine.parts.push(PartOf { whole, part: number, points });
                places.push(place);
            } else if is_usable(cell.moments()) {
                fine.push(Source::Half(cell.id()), *of);
                places.push(place);
            } else {
                places.push(None);
                continue;
            }
            fine.points += points;
        }
        if fine.cells.len() < places.len() {
            fine.places = places;
        }
        fine
    }

    /// Samples the whole cells: before that they have none, which growth does not need.
    pub(crate) fn sample_wholes(&mut self) {
        let parts = std::mem::take(&mut self.parts);
        if !parts.is_empty() {
            self.of_whole = Some(self.samples.together(parts));
        }
    }

    fn push(&mut self, source: Source, of: CellId) {
        self.cells.push(source);
        self.of.push(of);
    }

    /// The cells laid out for regions to grow over, by the grid that they are of, and the order of its cells if that is known.
    pub(crate) fn field(&self, grid: &VoxelGrid, order: Option<Order>) -> Result<Field, RegionsError> {
        Field::of_ordered(&OfGrid { fine: self, grid }, grid.cell_size(), order)
    }

    /// The key of a cell, of a whole one that of the first cell it is in the place of.
    fn key(&self, grid: &VoxelGrid, at: usize) -> Option<[i32; 3]> {
        Some(match self.cells.get(at)? {
            Source::Half(id) => grid.get(*id)?.key(),
            Source::Whole(_) => self.coarse.grid.get(*self.of.get(at)?)?.key().map(|k| k << 1),
        })
    }

    fn stats(&self, grid: &VoxelGrid, at: usize) -> Option<Stats> {
        match self.cells.get(at)? {
            Source::Half(id) => grid.get(*id),
            Source::Whole(_) => self.coarse.grid.get(*self.of.get(at)?),
        }
        .map(|cell| cell.stats())
    }

    /// The sample of the points of the cell at a place.
    pub(crate) fn sample(&self, place: usize) -> Sample<'_> {
        let sample = match self.cells.get(place) {
            Some(Source::Half(id)) => u32::try_from(id.index()).ok().map(|cell| self.samples.sample(cell)),
            Some(Source::Whole(whole)) => self.of_whole.as_ref().map(|samples| samples.sample(*whole)),
            None => None,
        };
        sample.unwrap_or(Sample::EMPTY)
    }

    /// Gives the cells the errors that flat places show, which are then in `errors`.
    pub(crate) fn find_errors(
        &self,
        grid: &VoxelGrid,
        field: &mut Field,
        errors: &mut Errors,
    ) -> Result<(), RegionsError> {
        errors.find_level(field, &self.of);
        field.set_noise(|at| {
            self.stats(grid, at).map_or(SymmetricMatrix3::ZERO, |stats| {
                errors.of_place(&stats, self.of[at]) * stats.count() as f64
            })
        })
    }

    /// Adds to the errors of points those that the poses of their scans give them. Scans are off against each other by these, so that a
    /// surface which several have seen is as thick, and would be taken for several by the errors of points alone.
    pub(crate) fn add_errors_of_poses(
        &self,
        grid: &VoxelGrid,
        field: &mut Field,
        errors: &Errors,
    ) -> Result<(), RegionsError> {
        if !errors.of_poses_are_told() {
            return Ok(());
        }
        field.add_shared_noise(|at| {
            let mean = self.stats(grid, at).and_then(|stats| stats.mean());
            mean.map_or(SharedNoise::NONE, |mean| errors.of_poses(mean, self.of[at]))
        })
    }

    /// For each cell of the cell size the plane that most of its points are of.
    pub(crate) fn planes_of_cells(&self, found: &Found) -> Vec<Option<PlaneId>> {
        let cells = self.coarse.grid.len();
        let of = |share: &Share| self.of[share.cell as usize].index();
        // Boyer and Moore's majority vote: what has most of the points of a cell is left when others are set against it.
        let mut votes: Vec<(u32, u64)> = vec![(0, 0); cells];
        for share in &found.shares {
            let ((region, lead), points) = (&mut votes[of(share)], u64::from(share.points));
            if *region == share.region {
                *lead += points;
            } else if *lead >= points {
                *lead -= points;
            } else {
                (*region, *lead) = (share.region, points - *lead);
            }
        }
        let mut points: Vec<u64> = vec![0; cells];
        for share in &found.shares {
            let at = of(share);
            points[at] += if votes[at].0 == share.region { share.points.into() } else { 0 };
        }
        let of_cells = self.coarse.grid.founded().zip(votes).zip(points);
        let owner = of_cells.map(|((cell, (region, _)), points)| {
            let is_owner = points as f64 >= MOSTLY * cell.density() as f64;
            PlaneId::from_index(region as usize).filter(|_| is_owner)
        });
        owner.collect()
    }
}

/// The cells with the grid that they are of.
struct OfGrid<'a> {
    fine: &'a Fine<'a>,
    grid: &'a VoxelGrid,
}

impl Cells for OfGrid<'_> {
    fn count(&self) -> usize {
        self.fine.cells.len()
    }

    // All are cells of the grids.
    fn key(&self, at: usize) -> [i32; 3] {
        self.fine.key(self.grid, at).unwrap_or([0; 3])
    }

    fn is_wide(&self, at: usize) -> bool {
        matches!(self.fine.cells.get(at), Some(Source::Whole(_)))
    }

    fn stats(&self, at: usize) -> Stats {
        self.fine.stats(self.grid, at).unwrap_or(Stats::new([0.0; 3]))
    }

    // Points are added to the cell of the voxel that they lie in.
    fn are_parts(&self) -> bool {
        self.grid.assignment() == Assignment::Voxel
    }

    fn fetch(&self, at: usize) {
        if let Some(Source::Half(id)) = self.fine.cells.get(at) {
            self.grid.fetch(*id);
        }
    }
}

/// Whether the sums of a cell are finite.
fn is_usable(moments: &Moments) -> bool {
    moments.noise().is_finite() && moments.second().is_finite()
}

/// Whether errors as stated blur a cell that is made of those with an edge in metres.
fn is_blurred(moments: &Moments, edge: f64) -> bool {
    let variance = moments.noise().trace() / (3.0 * moments.count() as f64);
    is_usable(moments) && variance > (BLURRED * edge).powi(2)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]

    use super::*;
    use crate::{Mapper, Params, Scan};
    use terrace_types::{Frame, Sigma};

    const CELL: f64 = 0.1;

    /// A floor of 2 m by 1 m, whose points have errors of 5 mm up to the middle and of `sigma` beyond it.
    fn mapper(sigma: f64) -> Mapper {
        let place = |k: u32| [0.01 * f64::from(k % 200) + 0.002, 0.01 * f64::from(k / 200) + 0.003, 0.02];
        let points: Vec<[f64; 3]> = (0..200 * 100).map(place).collect();
        let errors = points.iter().map(|[x, ..]| if *x < 1.0 { 0.005 } else { sigma }).collect();
        let frame = Frame::World { sensor: None };
        let scan = Scan::new(points, Sigma::PerPoint(errors), frame).unwrap();
        let mut mapper = Mapper::new(Params { cell_size: Some(CELL), ..Params::default() }).unwrap();
        mapper.insert(&scan).unwrap();
        mapper
    }

    fn fine(mapper: &Mapper) -> Fine<'_> {
        let mut fine = Fine::of(mapper.fine().unwrap(), mapper.coarse().unwrap(), mapper.samples().unwrap());
        fine.sample_wholes();
        fine
    }

    #[test]
    fn cells_stay_whole_where_errors_blur_them() {
        let sharp = mapper(0.0199);
        assert_eq!((sharp.fine().unwrap().len(), fine(&sharp).cells.len()), (800, 800));
        assert!(fine(&sharp).places.is_empty());
        let blurred = mapper(0.0201);
        let fine = fine(&blurred);
        let is_whole = |at: usize| matches!(fine.cells[at], Source::Whole(_));
        let wide: Vec<usize> = (0..fine.cells.len()).filter(|at| is_whole(*at)).collect();
        assert_eq!((fine.cells.len(), wide.len(), fine.points), (400 + 100, 100, 20_000));
        for at in 0..fine.cells.len() {
            let sample: Vec<[f32; 3]> = fine.sample(at).places().collect();
            let points = fine.stats(blurred.fine().unwrap(), at).unwrap().count();
            assert_eq!(points, if is_whole(at) { 100 } else { 25 });
            assert!((1..=16).contains(&sample.len()));
            for place in sample {
                let inside = |i: usize| f64::from(place[i]).abs() <= 0.5 * CELL;
                assert!((0..3).all(inside));
            }
        }
        // Each cell of the grid has a place, and eight of them, of which four have points, one together.
        let mut shared = vec![0; fine.cells.len()];
        for cell in blurred.fine().unwrap().founded() {
            shared[fine.places[cell.id().index()].unwrap() as usize] += 1;
        }
        assert!(shared.iter().enumerate().all(|(at, n)| *n == if wide.contains(&at) { 4 } else { 1 }));
    }

    #[test]
    fn a_plane_goes_on_into_whole_cells() {
        for sigma in [0.0199, 0.0201, 0.1] {
            let map = mapper(sigma).extract().unwrap();
            assert_eq!((map.planes.len(), map.summary().labelled), (1, 20_000), "{sigma}");
        }
    }
}
