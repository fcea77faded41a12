//! The cells of a plane in columns along its normal.

use std::ops::RangeInclusive;

use glam::DVec3;
use terrace_grid::VoxelKey;
use terrace_normals::CovariantPlane;
use terrace_regions::SharedNoise;
use terrace_stats::{Moments, Stats, SymmetricMatrix3};
use terrace_types::PlaneId;

use super::level::{NoiseLevel, Residuals};
use super::noise_around::Among;
use super::sightings::{Sighting, merged};
use super::{Errors, ExtractedPlane, Owned};

/// Errors of this many standard errors are still looked for beyond the cells of a plane; the mean of a cell may be off by one of
/// them, since its faces cut the errors.
const FAR: f64 = 5.0;
/// Voxels above and below that are looked at, at most: errors larger than cells say little of a plane.
const REACH: i32 = 4;

/// A plane that another one is near to.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Near {
    pub(crate) centroid: DVec3,
    pub(crate) normal: DVec3,
}

impl Near {
    pub(crate) fn to(plane: &ExtractedPlane) -> Self {
        Self { centroid: plane.centroid.into(), normal: plane.plane.normal().into() }
    }

    pub(crate) fn of(plane: &CovariantPlane) -> Self {
        Self { centroid: plane.fit.centroid.into(), normal: plane.fit.normal.into() }
    }
}

/// A column of voxels along the main axis.
#[derive(Debug, Clone)]
pub(crate) struct Column {
    /// Its other two indices.
    pub(crate) place: [i32; 2],
    /// Of its cells near the plane, about the anchor of the columns, with the errors that are known or were found out.
    pub(crate) sum: Moments,
    /// What its cells are of.
    pub(crate) of: Of,
    /// From where it was seen, where that matters.
    pub(crate) seen: Option<Box<Seen>>,
}

/// From where the points of a column were seen.
#[derive(Debug, Clone)]
pub(crate) struct Seen {
    pub(crate) from: Vec<Sighting>,
    pub(crate) shared: SharedNoise,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Of {
    /// The plane, and of no other.
    Plane,
    /// Another plane as well.
    Others,
    /// No cell is of the plane: it goes on there with fewer points, or ends beside it.
    Rim,
}

/// The cells of a plane and what is around them, column by column.
pub(crate) struct Columns {
    pub(crate) axis: usize,
    /// What the sums are relative to.
    pub(crate) anchor: [f64; 3],
    /// Those of the plane in rising order of their places, then the rim.
    pub(crate) all: Vec<Column>,
    /// For each column the neighbours after and before it along its two directions. Those of the rim know none.
    pub(crate) sides: Vec<Sides>,
}

/// The places of neighbours in the list of columns.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Sides {
    pub(crate) after: [Option<u32>; 2],
    pub(crate) before: [Option<u32>; 2],
}

/// What the columns of a plane are made from.
struct Building<'a> {
    owned: &'a Owned<'a, 'a>,
    plane: Option<PlaneId>,
    level: Option<&'a NoiseLevel>,
    axis: usize,
    anchor: [f64; 3],
}

/// A cell of the plane, and the heights at which there may be points of the plane at its place.
struct Member {
    place: [i32; 2],
    height: i32,
    heights: RangeInclusive<i32>,
    node: u32,
}

impl Owned<'_, '_> {
    /// The columns with cells of the plane, in a fixed order.
    pub(crate) fn columns(
        &self,
        plane: Option<PlaneId>,
        of: &[u32],
        near: &Near,
        level: Option<&NoiseLevel>,
    ) -> Columns {
        let axis = main_axis(near.normal);
        let building = Building { owned: self, plane, level, axis, anchor: near.centroid.to_array() };
        let members = building.members(of, near.normal);
        let same = |a: &Member, b: &Member| a.place == b.place;
        let mut all: Vec<Column> = Vec::with_capacity(members.len());
        all.extend(members.chunk_by(same).filter_map(|column| building.column(column)));
        let mut columns = Columns { axis, anchor: building.anchor, all, sides: Vec::new() };
        columns.connect();
        building.add_rim(&mut columns, members.chunk_by(same));
        columns
    }
}

impl Building<'_> {
    /// The cells of the plane by place and height.
    fn members(&self, of: &[u32], normal: DVec3) -> Vec<Member> {
        let Owned { grid, nodes, errors, .. } = self.owned;
        let cells = of.iter().filter_map(|node| {
            let at = *node as usize;
            let (stats, key) = (nodes.stats(grid, at)?, *nodes.dense.keys().get(at)?);
            let noise = match self.level {
                Some(level) => {
                    level.covariance(errors, &stats, errors.seen(nodes.dense.cells().get(at)?.index()))
                }
                None => mean_noise(stats.moments()),
            };
            let sigma = noise.quadratic_form(normal.to_array()).max(0.0).sqrt();
            let [below, above] = self.reach(stats.moments(), normal, sigma, grid.cell_size());
            let height = key[self.axis];
            let heights = height.saturating_add(below.min(0))..=height.saturating_add(above.max(0));
            Some(Member { place: place_of(key, self.axis), height, heights, node: *node })
        });
        let mut cells: Vec<Member> = cells.collect();
        cells.sort_unstable_by_key(|cell| (cell.place, cell.height));
        cells
    }

    /// Voxels above a cell, whose sums are about its centre, that points of a plane through its mean may lie in: the lowest and
    /// the highest.
    fn reach(&self, cell: &Moments, normal: DVec3, sigma: f64, size: f64) -> [i32; 2] {
        let mean = DVec3::from(cell.sum()) / cell.weight();
        let steepness = 1.0 / normal[self.axis];
        let (mut low, mut high) = (mean[self.axis], mean[self.axis]);
        for side in [1, 2] {
            let e = (self.axis + side) % 3;
            let ends = [-0.5 * size, 0.5 * size].map(|end| (mean[e] - end) * normal[e] * steepness);
            low += ends[0].min(ends[1]);
            high += ends[0].max(ends[1]);
        }
        let errors = FAR * sigma * steepness.abs();
        // Saturates; what is no number stays in the cell.
        #[allow(clippy::cast_possible_truncation)]
        [low - errors, high + errors].map(|end| ((end / size + 0.5).floor() as i32).clamp(-REACH, REACH))
    }

    /// The column of some members, which share a place.
    fn column(&self, members: &[Member]) -> Option<Column> {
        let place = members.first()?.place;
        let mut gathered = Gathered::new(self.anchor);
        let range = heights(members);
        let mut members = members.iter().peekable();
        for height in range {
            match members.next_if(|member| member.height == height) {
                Some(member) => self.gather_member(member, &mut gathered),
                None => self.gather(place, height, &mut gathered),
            }
        }
        gathered.column(place, self.level, &self.owned.errors)
    }

    /// Puts beside the columns what there is at their sides and heights, where no column is.
    fn add_rim<'m>(&self, columns: &mut Columns, of: impl Iterator<Item = &'m [Member]>) {
        let mut missing = Vec::new();
        let with_sides: Vec<(&[Member], Sides)> = of.zip(columns.sides.iter().copied()).collect();
        for (at, (members, sides)) in with_sides.into_iter().enumerate() {
            for side in 0..2 {
                for (step, beside) in [(1, sides.after[side]), (-1, sides.before[side])] {
                    if beside.is_none()
                        && let Some(member) = members.first()
                    {
                        let mut place = member.place;
                        place[side] = place[side].saturating_add(step);
                        missing.push((place, at, side, step, heights(members)));
                    }
                }
            }
        }
        missing.sort_by_key(|(place, at, ..)| (*place, *at));
        for of_place in missing.chunk_by(|a, b| a.0 == b.0) {
            let Some((place, .., heights)) = of_place.first() else { continue };
            let mut gathered = Gathered::new(self.anchor);
            for height in heights.clone() {
                self.gather(*place, height, &mut gathered);
            }
            let Some(column) = gathered.column(*place, None, &self.owned.errors) else { continue };
            // Columns are as many as cells at most, which are numbered with 32 bits.
            let rim = u32::try_from(columns.all.len()).ok();
            columns.all.push(Column { of: Of::Rim, ..column });
            columns.sides.push(Sides::default());
            for (_, at, side, step, _) in of_place {
                let sides = &mut columns.sides[*at];
                let of_step = if *step > 0 { &mut sides.after } else { &mut sides.before };
                of_step[*side] = rim;
            }
        }
    }

    fn gather_member(&self, member: &Member, gathered: &mut Gathered) {
        let Owned { grid, nodes, errors, .. } = self.owned;
        if let Some(stats) = nodes.stats(grid, member.node as usize) {
            gathered.sum.merge(&stats);
        }
        if let Some(id) = nodes.dense.cells().get(member.node as usize) {
            gathered.seen.extend(errors.seen(id.index()));
        }
    }

    fn gather(&self, place: [i32; 2], height: i32, gathered: &mut Gathered) {
        let Owned { grid, plane_of_cell, errors, .. } = self.owned;
        let mut key = [height; 3];
        key[(self.axis + 1) % 3] = place[0];
        key[(self.axis + 2) % 3] = place[1];
        let Some(cell) = grid.find(key) else { return };
        let index = cell.id().index();
        if plane_of_cell.get(index).copied().flatten().is_some_and(|other| Some(other) != self.plane) {
            gathered.of = Of::Others;
        }
        gathered.sum.merge(&cell.stats());
        gathered.seen.extend(errors.seen(index));
    }
}

/// From the lowest to the highest at which points of these may be.
fn heights(members: &[Member]) -> RangeInclusive<i32> {
    let low = members.iter().map(|member| *member.heights.start()).min();
    let high = members.iter().map(|member| *member.heights.end()).max();
    low.unwrap_or(1)..=high.unwrap_or(0)
}

/// What a column is made of.
struct Gathered {
    sum: Stats,
    of: Of,
    seen: Vec<Sighting>,
}

impl Gathered {
    fn new(anchor: [f64; 3]) -> Self {
        Self { sum: Stats::new(anchor), of: Of::Plane, seen: Vec::new() }
    }

    fn column(self, place: [i32; 2], level: Option<&NoiseLevel>, errors: &Errors) -> Option<Column> {
        let Self { sum, of, seen } = self;
        if sum.count() == 0 {
            return None;
        }
        let seen = (!seen.is_empty()).then(|| Box::new(Seen::of(merged(seen), &sum, errors.views)));
        let mut column = Column { place, sum: *sum.moments(), of, seen };
        if let Some(level) = level {
            column.take_level(sum.anchor(), level, errors);
        }
        Some(column)
    }
}

impl Columns {
    /// Takes errors that were found out.
    pub(crate) fn take_level(&mut self, near: &Near, level: &NoiseLevel, errors: &Errors) {
        for column in self.all.iter_mut().filter(|column| column.of != Of::Rim) {
            column.take_level(self.anchor, level, errors);
        }
        self.take_noise_from_around(near, Among::Explained);
    }

    /// Finds the neighbours of each column. Two cursors walk the sorted places, one at each side.
    fn connect(&mut self) {
        self.sides = vec![Sides::default(); self.all.len()];
        let mut cursor = 0;
        for at in 0..self.all.len() {
            let [a, b] = self.all[at].place;
            let next = [a.saturating_add(1), b];
            while self.all.get(cursor).is_some_and(|column| column.place < next) {
                cursor += 1;
            }
            for (side, found, place) in [(0, cursor, next), (1, at + 1, [a, b.saturating_add(1)])] {
                if found != at && self.all.get(found).is_some_and(|column| column.place == place) {
                    // Columns are as many as cells at most, which are numbered with 32 bits.
                    self.sides[at].after[side] = u32::try_from(found).ok();
                    self.sides[found].before[side] = u32::try_from(at).ok();
                }
            }
        }
    }

    /// A column and those beside it, also across corners.
    pub(crate) fn around(&self, at: usize) -> impl Iterator<Item = usize> {
        let three = move |at: usize, side: usize| {
            let Sides { after, before } = self.sides[at];
            [before[side], u32::try_from(at).ok(), after[side]].into_iter().flatten().map(|at| at as usize)
        };
        three(at, 0).flat_map(move |at| three(at, 1))
    }

    pub(crate) fn counted<'c>(&'c self, counts: &'c [bool]) -> impl Iterator<Item = &'c Column> + Clone {
        self.all.iter().zip(counts).filter(|(_, counts)| **counts).map(|(column, _)| column)
    }

    /// The plane of least variance through the columns that count, near one with this normal.
    pub(crate) fn fit(&self, counts: &[bool], normal: DVec3) -> Option<CovariantPlane> {
        let sums = self.counted(counts).map(|column| (&column.sum, column.shared_by_points()));
        CovariantPlane::near_with_shared(self.anchor, sums, normal.to_array()).ok()?
    }

    /// What flat columns off the borders of the plane tell of the noise.
    pub(crate) fn residuals(&self, near: &Near, errors: &Errors, residuals: &mut Residuals) {
        let counts = self.near(near, errors.floor);
        for column in self.counted(&counts) {
            let from = column.seen.as_ref().map_or(&[][..], |seen| &seen.from);
            let place = Stats::from_moments(self.anchor, column.sum);
            residuals.push(errors, from, &place, near.normal.into());
        }
    }

    /// How many hold cells of the plane.
    pub(crate) fn of_plane(&self) -> usize {
        self.all.iter().filter(|column| column.of != Of::Rim).count()
    }

    /// Those in a block about a place.
    pub(crate) fn block(&self, place: [i32; 2], reach: u32) -> Vec<bool> {
        let within = |column: &Column| (0..2).all(|i| column.place[i].abs_diff(place[i]) <= reach);
        self.all.iter().map(|column| column.of == Of::Plane && within(column)).collect()
    }

    /// The place of a voxel.
    pub(crate) fn place(&self, key: VoxelKey) -> [i32; 2] {
        place_of(key, self.axis)
    }

    /// The variance of the means of columns along an axis, each counting by its points.
    pub(crate) fn spread_along(&self, counts: &[bool], axis: [f64; 3]) -> f64 {
        let axis = DVec3::from(axis);
        let places = || self.counted(counts).map(|c| (c.sum.count() as f64, axis.dot(c.mean())));
        let points: f64 = places().map(|(points, _)| points).sum();
        let mean = places().map(|(points, at)| points * at).sum::<f64>() / points;
        places().map(|(points, at)| points * (at - mean).powi(2)).sum::<f64>() / points
    }
}

impl Column {
    fn take_level(&mut self, anchor: [f64; 3], level: &NoiseLevel, errors: &Errors) {
        let from = self.seen.as_ref().map_or(&[][..], |seen| &seen.from);
        let place = Stats::from_moments(anchor, self.sum);
        let noise = level.covariance(errors, &place, from) * self.sum.count() as f64;
        self.sum = self.sum.with_noise(noise);
    }

    /// Of its points, from the anchor of the columns.
    pub(crate) fn mean(&self) -> DVec3 {
        DVec3::from(self.sum.sum()) / self.sum.weight()
    }

    /// The sums with noise that makes the variance of their mean that of a sample, scatter over one less than the points, and along
    /// the normal at least what the errors say: few points may lie close together by luck.
    pub(crate) fn with_sample_variance(&self, anchor: [f64; 3], normal: [f64; 3]) -> Stats {
        let points = self.sum.count() as f64;
        let stats = Stats::from_moments(anchor, self.sum);
        match self.sum.covariance() {
            Some(scatter) if points > 1.0 => {
                let sample = scatter.quadratic_form(normal) * points / (points - 1.0);
                let lacking = (variance_along(&self.sum, DVec3::from(normal)) - sample).max(0.0) * points;
                let more = scatter * (points / (points - 1.0)) + SymmetricMatrix3::outer(normal) * lacking;
                stats.with_noise(self.sum.noise() + more)
            }
            _ => stats,
        }
    }

    /// The mean covariance of the error of a point.
    pub(crate) fn noise_of_points(&self) -> SymmetricMatrix3 {
        mean_noise(&self.sum) + self.shared_by_points()
    }

    /// The mean covariance of the part of it that points of a scan share.
    fn shared_by_points(&self) -> SymmetricMatrix3 {
        self.seen.as_ref().map_or(SymmetricMatrix3::ZERO, |seen| seen.shared.of_points)
    }

    /// What each of its points counts.
    pub(crate) fn weight(&self, plane: &CovariantPlane) -> f64 {
        plane.weight_with_shared(&self.sum, &self.shared_by_points())
    }
}

fn place_of(key: VoxelKey, axis: usize) -> [i32; 2] {
    [key[(axis + 1) % 3], key[(axis + 2) % 3]]
}

/// The axis that the normal is nearest to.
fn main_axis(normal: DVec3) -> usize {
    normal.abs().max_position()
}

fn mean_noise(cell: &Moments) -> SymmetricMatrix3 {
    cell.noise() * (1.0 / cell.count().max(1) as f64)
}

pub(crate) fn variance_along(cell: &Moments, direction: DVec3) -> f64 {
    cell.noise().quadratic_form(direction.to_array()) / cell.count().max(1) as f64
}
