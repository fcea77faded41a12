//! The points that a map keeps, and their labels in the place of their cells.

use std::borrow::Cow;

use rayon::prelude::*;
use terrace_grid::CellId;
use terrace_types::PlaneId;

/// What is kept of points, scan after scan: of a scan, of a chunk of it, or of several.
#[derive(Debug, Clone, Default)]
pub(crate) struct Kept {
    /// The fine cell of each; `None` for points that were left out.
    pub(crate) cells: Vec<Option<CellId>>,
    /// Where each is, from the centre of its voxel in whole units, where regions are grown.
    pub(crate) places: Vec<[i16; 3]>,
}

impl Kept {
    /// With room for so many points, and for where they are if that matters.
    pub(super) fn of(points: usize, places: bool) -> Self {
        let places = Vec::with_capacity(if places { points } else { 0 });
        Self { cells: Vec::with_capacity(points), places }
    }

    /// The same, if the system has it.
    pub(super) fn try_of(points: usize, places: bool) -> Option<Self> {
        let mut kept = Self::default();
        kept.cells.try_reserve_exact(points).ok()?;
        kept.places.try_reserve_exact(if places { points } else { 0 }).ok()?;
        Some(kept)
    }

    /// Whether there is room for so many more.
    pub(super) fn has_room(&self, points: usize) -> bool {
        self.cells.capacity() - self.cells.len() >= points
    }

    /// Forgets all but so many.
    pub(super) fn truncate(&mut self, points: usize) {
        self.cells.truncate(points);
        self.places.truncate(points);
    }
}

/// What is given away in one piece, in which labels have room; else what it was.
pub(crate) fn in_one_piece(kept: Cow<'_, [Kept]>) -> Result<Kept, Cow<'_, [Kept]>> {
    match kept {
        Cow::Owned(mut parts) if parts.len() == 1 => parts.pop().ok_or(Cow::Owned(parts)),
        others => Err(others),
    }
}

/// Labels of points in the memory of their cells: a number for each, 0 for none. Those of cells at first, of planes in the end.
pub(crate) struct Tags(Vec<u32>);

impl Tags {
    /// The cells.
    pub(crate) fn of(cells: Vec<Option<CellId>>) -> Self {
        // A list that is made of another, number by number, stays where that is.
        Self(cells.into_iter().map(|cell| tag(cell.map(cell_number))).collect())
    }

    /// With room for those of so many points.
    pub(crate) fn with_capacity(points: usize) -> Self {
        Self(Vec::with_capacity(points))
    }

    /// Those of so many points more, which are of none. On all threads: memory that is used for the first time is handed out by the system
    /// page by page.
    pub(crate) fn more(&mut self, points: usize) -> &mut [u32] {
        let first = self.0.len();
        self.0.par_extend(rayon::iter::repeat_n(0, points));
        &mut self.0[first..]
    }

    pub(crate) fn as_mut_slice(&mut self) -> &mut [u32] {
        &mut self.0
    }

    /// The labels, once each cell is replaced by that of a plane.
    pub(crate) fn into_labels(self) -> Vec<Option<PlaneId>> {
        self.0.into_iter().map(PlaneId::new).collect()
    }
}

/// The number of a cell, as samples take it, and what labels points.
#[inline]
pub(crate) fn cell_number(cell: CellId) -> u32 {
    // A grid numbers its cells with 32 bits.
    #[allow(clippy::cast_possible_truncation)]
    let number = cell.index() as u32;
    number
}

/// Of the number of a cell or plane, from 0.
#[inline]
pub(crate) fn tag(number: Option<u32>) -> u32 {
    // Of 2³² cells there are none: they are numbered with four bytes, and so is `None`.
    number.map_or(0, |number| number.wrapping_add(1))
}

/// The number of a cell or plane.
#[inline]
pub(crate) fn number_of(tag: u32) -> Option<u32> {
    tag.checked_sub(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_are_where_cells_were() {
        let mut grid = terrace_grid::VoxelGrid::new(1.0, terrace_grid::Assignment::Voxel).unwrap();
        let points: Vec<[f64; 3]> = (0..100).map(|k| [f64::from(k) + 0.5, 0.0, 0.0]).collect();
        let mut cells = vec![None];
        grid.insert_all(&points, terrace_grid::PointErrors::None, &mut cells, None).unwrap();
        let (memory, numbers) = (cells.as_ptr() as usize, cells.clone());
        let mut tags = Tags::of(cells);
        for (tag, cell) in tags.as_mut_slice().iter_mut().zip(numbers) {
            assert_eq!(number_of(*tag).map(|number| number as usize), cell.map(CellId::index));
            *tag = super::tag(number_of(*tag).filter(|cell| cell % 3 > 0).map(|cell| 2 * cell));
        }
        let labels = tags.into_labels();
        assert_eq!(labels.as_ptr() as usize, memory);
        assert_eq!(labels[..3], [None, None, PlaneId::from_index(2)]);
        assert_eq!(labels.len(), 101);
        assert!((0..100).all(|k| labels[k + 1].map(PlaneId::index) == (k % 3 > 0).then_some(2 * k)));
    }
}
