//! The scans in cells of one size.

use terrace_types::Scan;

use crate::tune::{TrueLabel, TuneError};
use crate::{ExtractError, Mapper, Params};

/// The scans in cells of one size.
pub(crate) struct Gridded {
    pub(crate) mapper: Mapper,
    /// Points of the scans that are not absent, whether the grid took them or not.
    pub(crate) present: u64,
    /// The points by cell and true label; none when labels do not matter.
    pub(crate) groups: Vec<Group>,
    /// The densities of the cells, in rising order.
    densities: Vec<u64>,
}

/// Points of one cell with one true label.
pub(crate) struct Group {
    /// Their cell; `None` for points in none.
    pub(crate) cell: Option<usize>,
    pub(crate) truth: TrueLabel,
    pub(crate) points: u64,
}

impl Gridded {
    pub(crate) fn new(
        params: &Params,
        cell_size: f64,
        scans: &[Scan],
        truth: Option<&[TrueLabel]>,
    ) -> Result<Self, TuneError> {
        // Settings of clusters are tuned, whatever is extracted.
        let mut mapper = Mapper::new(Params { cell_size: Some(cell_size), regions: None, ..*params })?;
        for scan in scans {
            mapper.insert(scan)?;
        }
        let grid = mapper.grid().filter(|grid| !grid.is_empty()).ok_or(ExtractError::Empty)?;
        let mut densities: Vec<u64> = grid.iter().map(|cell| cell.density()).collect();
        densities.sort_unstable();
        let groups = truth.map(|truth| groups(&mapper, truth)).unwrap_or_default();
        let present = scans.iter().map(|scan| scan.present() as u64).sum();
        Ok(Self { mapper, present, groups, densities })
    }

    /// Number of cells with at least `tau` points: it tells which they are.
    pub(crate) fn dense(&self, tau: u64) -> usize {
        self.densities.len() - self.densities.partition_point(|density| *density < tau)
    }

    /// The smallest and the largest density threshold with the same dense cells as `tau`, both included; `None`: there is
    /// no largest, no cell is dense.
    pub(crate) fn same_dense(&self, tau: u64) -> (u64, Option<u64>) {
        let at = self.densities.partition_point(|density| *density < tau);
        let below = at.checked_sub(1).and_then(|below| self.densities.get(below));
        (below.map_or(0, |below| below + 1), self.densities.get(at).copied())
    }
}

/// The points of each cell by their true label, in the order of the cells.
fn groups(mapper: &Mapper, truth: &[TrueLabel]) -> Vec<Group> {
    let cells = mapper.cells_of_points().map(|cell| cell.map(terrace_grid::CellId::index));
    let mut points: Vec<_> = cells.zip(truth).collect();
    points.sort_unstable();
    points
        .chunk_by(|a, b| a == b)
        .filter_map(|same| {
            let (cell, truth) = *same.first()?;
            Some(Group { cell, truth: *truth, points: same.len() as u64 })
        })
        .collect()
}
