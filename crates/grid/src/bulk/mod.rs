//! Many points at once.

mod add;
mod batch;
mod direct;
mod errors;
mod find;
mod locate;
mod present;
mod section;
mod split;
mod sums;
mod voxels;

use rayon::prelude::*;

use self::add::Share;
pub use self::errors::PointErrors;
pub(crate) use self::locate::unit_of;
use self::section::{SECTION, Section, Targets};
pub use self::voxels::{Locator, PointVoxels};
use crate::block::PARTS;
use crate::cell::CellId;
use crate::grid::{Home, MOST_CELLS};
use crate::{Assignment, GridError, VoxelGrid};

/// Points of a chunk. The larger, the more often a cell of shuffled points is met while it is in the cache.
const CHUNK: usize = 1 << 21;

/// Takes points, some at a time, from where they are told to where they are in the grid: from the frame of a sensor into that of the world.
/// It is given as many places to put them.
pub type Motion<'a> = dyn Fn(&[[f64; 3]], &mut [[f64; 3]]) + Sync + 'a;

/// What became of points that were inserted together.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Taken {
    /// Points that are now in the grid.
    pub points: usize,
    /// Points left out because a coordinate is NaN or infinite: absent measurements.
    pub not_finite: usize,
    /// Points left out for another reason: see [`VoxelGrid::insert`].
    pub refused: usize,
    /// The reason for the first of them.
    pub first_refusal: Option<GridError>,
}

impl Taken {
    fn add(&mut self, later: &Self) {
        self.points += later.points;
        self.not_finite += later.not_finite;
        self.refused += later.refused;
        self.first_refusal = self.first_refusal.or(later.first_refusal);
    }
}

impl VoxelGrid {
    /// Adds points with weight 1, faster than one by one and on all threads of the rayon pool, and appends the cell of each
    /// to `cells`: `None` if it was refused. Appends to `places`, if given, where each is from the [anchor](crate::Cell::anchor) of its voxel (of
    /// its cell, with [`Assignment::ExpectedDistance`], where what is further than 16 bits can tell is as far as they can), in whole
    /// [units](Self::place_unit), 0 if it was refused.
    ///
    /// Cells, their identities and their sums are those of [`VoxelGrid::insert`] point by point, to the bit, on any number of threads and
    /// however points are handed over. [`Assignment::ExpectedDistance`] depends on the order of points, which are then inserted one by
    /// one.
    ///
    /// ```
    /// use terrace_grid::{Assignment, PointErrors, VoxelGrid};
    ///
    /// let points = [[0.01, 0.02, 0.0], [0.03, 0.02, 0.0], [f64::NAN; 3], [0.11, 0.02, 0.0]];
    /// let mut grid = VoxelGrid::new(0.1, Assignment::Voxel)?;
    /// let mut cells = Vec::new();
    /// let taken = grid.insert_all(&points, PointErrors::Same(0.005), &mut cells, None)?;
    /// assert_eq!((taken.points, taken.not_finite, grid.len()), (3, 1, 2));
    /// assert_eq!(cells[0], cells[1]);
    /// assert_eq!(cells[2], None);
    /// # Ok::<(), terrace_grid::GridError>(())
    /// ```
    ///
    /// # Errors
    /// [`GridError::Lengths`] when there are not as many errors as points; nothing is changed then.
    pub fn insert_all(
        &mut self,
        points: &[[f64; 3]],
        errors: PointErrors<'_>,
        cells: &mut Vec<Option<CellId>>,
        places: Option<&mut Vec<[i16; 3]>>,
    ) -> Result<Taken, GridError> {
        self.insert_by(false, (points, None), errors, cells, places)
    }

    /// As [`insert_all`](Self::insert_all), to the bit, and on the calling thread alone: for those who have other work for the others.
    /// Takes less CPU time than on several for points that [come in order](Self::are_in_order), and more for others.
    ///
    /// With a `motion` points are inserted where that takes them, without a list of all of them there; errors are told as they are there.
    ///
    /// # Errors
    /// As [`insert_all`](Self::insert_all).
    pub fn insert_alone(
        &mut self,
        points: &[[f64; 3]],
        motion: Option<&Motion<'_>>,
        errors: PointErrors<'_>,
        cells: &mut Vec<Option<CellId>>,
        places: Option<&mut Vec<[i16; 3]>>,
    ) -> Result<Taken, GridError> {
        self.insert_by(true, (points, motion), errors, cells, places)
    }

    /// Whether so many more points cannot have too many cells.
    fn has_room(&self, points: usize) -> bool {
        self.len() + points <= MOST_CELLS
    }

    fn insert_by(
        &mut self,
        alone: bool,
        (points, motion): (&[[f64; 3]], Option<&Motion<'_>>),
        errors: PointErrors<'_>,
        cells: &mut Vec<Option<CellId>>,
        mut places: Option<&mut Vec<[i16; 3]>>,
    ) -> Result<Taken, GridError> {
        errors.require(points.len())?;
        cells.reserve(points.len());
        if let Some(places) = &mut places {
            places.reserve(points.len());
        }
        let mut taken = Taken::default();
        let mut sections = std::mem::take(&mut self.scratch.0);
        for (chunk, points) in points.chunks(CHUNK).enumerate() {
            let begin = chunk * CHUNK;
            let chunk = Chunk { points, errors: errors.part(begin..begin + points.len()) };
            // Where cells may run out, the first points get them, as one by one.
            let by_voxel = self.assignment == Assignment::Voxel && self.has_room(points.len());
            if by_voxel && (alone || rayon::current_num_threads() == 1 && self.are_in_order(points)) {
                taken.add(&self.insert_in_order(&chunk, motion, cells, places.as_deref_mut()));
                continue;
            }
            let mut moved = Vec::new();
            if let Some(motion) = motion {
                moved.resize(points.len(), [0.0; 3]);
                motion(points, &mut moved);
            }
            let chunk = Chunk { points: if motion.is_some() { &moved } else { points }, ..chunk };
            let cells = extend(cells, None, points.len());
            let places = places.as_mut().map(|places| extend(places, [0; 3], points.len()));
            taken.add(&if by_voxel {
                self.insert_chunk(&chunk, &mut sections, cells, places)
            } else {
                self.insert_each(&chunk, cells, places)
            });
        }
        self.scratch.0 = sections;
        Ok(taken)
    }

    /// One by one.
    fn insert_each(
        &mut self,
        chunk: &Chunk<'_>,
        cells: &mut [Option<CellId>],
        mut places: Option<&mut [[i16; 3]]>,
    ) -> Taken {
        let mut taken = Taken::default();
        for (at, (point, of_point)) in chunk.points.iter().zip(cells).enumerate() {
            if !point.iter().all(|x| x.is_finite()) {
                taken.not_finite += 1;
                continue;
            }
            match chunk.errors.insert(self, *point, at) {
                Err(refusal) => taken.refuse(refusal),
                Ok(cell) => {
                    taken.points += 1;
                    *of_point = Some(cell);
                    if let (Some(places), Some(cell)) = (&mut places, self.get(cell)) {
                        let (anchor, (_, per_unit)) = (cell.anchor(), unit_of(self.lattice.size));
                        // As `Located` rounds them; what is further than is told is at the end.
                        #[allow(clippy::cast_possible_truncation)]
                        let units = |i: usize| ((point[i] - anchor[i]) * per_unit).round_ties_even() as i16;
                        places[at] = [0, 1, 2].map(units);
                    }
                }
            }
        }
        taken
    }

    /// In three steps, each parallel, with the same result on any number of threads: what is split among them does not
    /// depend on their number, and each cell is of one part, which adds its points in their order.
    fn insert_chunk(
        &mut self,
        chunk: &Chunk<'_>,
        sections: &mut Vec<Section>,
        cells: &mut [Option<CellId>],
        places: Option<&mut [[i16; 3]]>,
    ) -> Taken {
        let Chunk { points, errors } = *chunk;
        let lattice = self.lattice;
        let of_sections = points.chunks(SECTION);
        sections.resize_with(of_sections.len(), Section::default);
        let mut places = places.map(|places| places.chunks_mut(SECTION));
        let mut sorting: Vec<_> = sections
            .iter_mut()
            .zip(of_sections)
            .map(|(section, points)| (section, points, places.as_mut().and_then(Iterator::next)))
            .collect();
        sorting.par_iter_mut().enumerate().for_each_init(
            Targets::default,
            |targets, (at, (section, points, places))| {
                let begin = at * SECTION;
                let errors = errors.part(begin..begin + points.len());
                section.sort(points, &errors, lattice, places.as_deref_mut(), targets);
            },
        );

        let mut shares: Vec<Share<'_>> = Vec::new();
        shares.resize_with(PARTS, Share::default);
        for section in sections.iter_mut() {
            for (share, portion) in shares.iter_mut().zip(section.portions(errors)) {
                share.portions.push(portion);
            }
        }
        let with_parts = shares.par_iter_mut().zip(&mut self.parts);
        with_parts.for_each(|(share, part)| share.add(part, lattice));
        let founded: Vec<Vec<u32>> = shares.into_iter().map(|share| share.founded).collect();
        self.number(&founded, points.len());

        let parts = &self.parts;
        sections.par_iter().zip(cells.par_chunks_mut(SECTION)).for_each(|(section, cells)| {
            for ((numbers, slots), part) in section.found().zip(parts) {
                for (number, slot) in numbers.iter().zip(slots) {
                    cells[usize::from(*number)] = part.ids.get(*slot as usize).copied();
                }
            }
        });
        let mut taken = Taken::default();
        for section in sections.iter() {
            taken.add(&section.taken);
        }
        taken.points = points.len() - taken.not_finite - taken.refused;
        taken
    }

    /// Numbers the new cells of each part in the order of their first points.
    fn number(&mut self, founded: &[Vec<u32>], points: usize) {
        // Which points found a cell, 64 to a word, and how many did before each word.
        let mut founders = vec![0_u64; points.div_ceil(64)];
        for point in founded.iter().flatten() {
            founders[*point as usize / 64] |= 1 << (point % 64);
        }
        let mut cells = self.homes.len();
        let mut before = Vec::with_capacity(founders.len());
        for word in &founders {
            before.push(cells);
            cells += word.count_ones() as usize;
        }
        self.homes.resize(cells, Home::default());
        for ((number, part), founded) in (0..).zip(&mut self.parts).zip(founded) {
            for point in founded {
                let word = *point as usize / 64;
                let earlier = founders[word] & ((1 << (point % 64)) - 1);
                let index = before[word] + earlier.count_ones() as usize;
                // There is room for a cell for each point.
                let Some(id) = CellId::from_index(index) else { continue };
                // As many slots as identities.
                #[allow(clippy::cast_possible_truncation)]
                let slot = part.ids.len() as u32;
                part.ids.push(id);
                self.homes[index] = Home { part: number, slot };
            }
        }
    }
}

/// Appends a value so many times, and hands out where. On all threads: for much memory that costs more than its use.
fn extend<T: Copy + Send + Sync>(list: &mut Vec<T>, value: T, times: usize) -> &mut [T] {
    let first = list.len();
    list.par_extend(rayon::iter::repeat_n(value, times));
    &mut list[first..]
}

/// Memory that insertions use one after the other. A copy of a grid begins with none.
#[derive(Debug, Default)]
pub(crate) struct Scratch(Vec<Section>);

impl Clone for Scratch {
    fn clone(&self) -> Self {
        Self::default()
    }
}

/// Points that go through the steps together.
struct Chunk<'a> {
    points: &'a [[f64; 3]],
    errors: PointErrors<'a>,
}
