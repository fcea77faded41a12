//! From where each cell was seen.

use terrace_grid::CellId;

use crate::Mapper;
use crate::mapper::Kept;

/// Some points of a cell, seen in one scan.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sighting {
    /// Place of the scan in the order of insertion, from 0.
    pub view: u32,
    /// Number of points; 2³² − 1 stands for all above.
    pub points: u32,
}

/// One for each scan.
pub(crate) fn merged(mut seen: Vec<Sighting>) -> Vec<Sighting> {
    seen.sort_unstable_by_key(|sighting| sighting.view);
    seen.dedup_by(|next, first| {
        let same = next.view == first.view;
        if same {
            first.points = first.points.saturating_add(next.points);
        }
        same
    });
    seen
}

/// For each cell the scans that saw it.
pub(crate) struct Sightings {
    /// Cell `i` has `of[starts[i]..starts[i + 1]]`, in the order of the scans.
    starts: Vec<u32>,
    of: Vec<Sighting>,
}

impl Sightings {
    /// Of the cells of the grid. `kept` is what the map keeps of its points.
    pub(crate) fn of(mapper: &Mapper, kept: &[Kept]) -> Self {
        let cells = mapper.grid().map_or(0, terrace_grid::VoxelGrid::len);
        let coarse = mapper.params().grows().and_then(|_| mapper.coarse());
        let cell_of_grid = |cell: CellId| match coarse {
            None => Some(cell),
            Some(coarse) => coarse.of.get(cell.index()).copied(),
        };
        Self::grouped(cells, found(mapper, kept, cells, cell_of_grid))
    }

    /// Of the cells that points are added to.
    pub(crate) fn of_fine(mapper: &Mapper) -> Self {
        let cells = mapper.fine().map_or(0, terrace_grid::VoxelGrid::len);
        Self::grouped(cells, found(mapper, mapper.kept(), cells, Some))
    }

    fn grouped(cells: usize, mut found: Vec<(u32, Sighting)>) -> Self {
        found.sort_unstable_by_key(|(cell, sighting)| (*cell, sighting.view));
        found.dedup_by(|(next, more), (cell, sighting)| {
            let same = (*next, more.view) == (*cell, sighting.view);
            if same {
                sighting.points = sighting.points.saturating_add(more.points);
            }
            same
        });
        let mut starts = vec![0_u32; cells + 1];
        for (cell, _) in &found {
            starts[*cell as usize + 1] += 1;
        }
        for cell in 0..cells {
            starts[cell + 1] += starts[cell];
        }
        Self { starts, of: found.into_iter().map(|(_, sighting)| sighting).collect() }
    }

    /// Of the cell with this index, in the order of the scans.
    pub(crate) fn of_cell(&self, index: usize) -> &[Sighting] {
        match self.starts.get(index..) {
            Some([start, end, ..]) => self.of.get(*start as usize..*end as usize).unwrap_or(&[]),
            _ => &[],
        }
    }
}

/// What views saw of the cells that `cell_of` makes of those that points are added to; a cell may come several times.
fn found(
    mapper: &Mapper,
    kept: &[Kept],
    cells: usize,
    cell_of: impl Fn(CellId) -> Option<CellId>,
) -> Vec<(u32, Sighting)> {
    match mapper.seen() {
        Some(seen) => seen
            .all(mapper.views().len().saturating_sub(1))
            .filter_map(|(cell, sighting)| Some((u32::try_from(cell_of(cell)?.index()).ok()?, sighting)))
            .collect(),
        None => counted_now(mapper, kept, cells, cell_of),
    }
}

/// The same of points that are kept.
fn counted_now(
    mapper: &Mapper,
    kept: &[Kept],
    cells: usize,
    cell_of: impl Fn(CellId) -> Option<CellId>,
) -> Vec<(u32, Sighting)> {
    let mut counts = vec![0_u32; cells];
    let mut touched: Vec<u32> = Vec::new();
    let mut found: Vec<(u32, Sighting)> = Vec::new();
    let mut rest = kept.iter().flat_map(|kept| &kept.cells).map(|cell| cell.and_then(&cell_of));
    for (view, seen) in (0..).zip(mapper.views()) {
        for cell in rest.by_ref().take(seen.points).flatten() {
            let Some(count) = counts.get_mut(cell.index()) else { continue };
            if *count == 0 {
                // A grid numbers its cells with 32 bits.
                touched.extend(u32::try_from(cell.index()));
            }
            *count = count.saturating_add(1);
        }
        for cell in touched.drain(..) {
            let points = std::mem::take(&mut counts[cell as usize]);
            found.push((cell, Sighting { view, points }));
        }
    }
    found
}
