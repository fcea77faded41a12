//! A map taken apart.

use std::borrow::Cow;

use terrace_grid::{VoxelGrid, VoxelKey};
use terrace_regions::SampledPoint;
use terrace_stats::Moments;

use super::{Mapper, View, cell_number};
use crate::StreamingError;
use crate::estimate::{Sighting, Sightings};

/// A cell of a map. Cells have the edge of [`Mapper::edge`].
#[derive(Debug, Clone, PartialEq)]
pub struct MapCell<'m> {
    /// Index of the voxel: the point p lies in `floor(p / edge)`.
    pub key: VoxelKey,
    /// Number of points, L, S and E, relative to the centre of the cell of the map's cell size that the cell is or is in, in metres.
    pub sums: Moments,
    /// Some of the points, with their places relative to the same centre; empty where no regions are grown.
    pub sample: Cow<'m, [SampledPoint]>,
    /// How often the sample was halved, see [`Samples::halvings`](terrace_regions::Samples::halvings).
    pub halvings: u8,
    /// How many points each view saw, in the order of the views.
    pub seen: &'m [Sighting],
}

/// A map taken apart: [`Mapper::parts`].
pub struct MapParts<'m> {
    mapper: &'m Mapper,
    sightings: Sightings,
}

impl Mapper {
    /// The map taken apart: its views and cells, from which [`MapBuilder`](crate::MapBuilder) makes the same map again, but for points that were kept.
    ///
    /// # Errors
    /// [`StreamingError::NotByPlace`] and [`StreamingError::Spared`] where cells and views do not tell all of a map.
    pub fn parts(&self) -> Result<MapParts<'_>, StreamingError> {
        if !self.params.by_place() {
            return Err(StreamingError::NotByPlace);
        }
        if self.spares {
            return Err(StreamingError::Spared);
        }
        Ok(MapParts { mapper: self, sightings: Sightings::of_fine(self) })
    }

    /// Edge of the cells that points are added to, in metres: half the cell size where regions are grown. `None` before there is a cell
    /// size.
    pub fn edge(&self) -> Option<f64> {
        Some(if self.params.grows().is_some() { 0.5 * self.cell_size()? } else { self.cell_size()? })
    }

    /// The cell size, in metres: given, or chosen from the first scan. `None` before there is one.
    pub fn cell_size(&self) -> Option<f64> {
        self.params.cell_size.or(self.chosen.map(|chosen| chosen.cell_size))
    }

    /// The scans so far, in the order of insertion.
    pub fn views(&self) -> &[View] {
        &self.views
    }

    /// Number of cells that points were added to.
    pub fn cells(&self) -> usize {
        self.fine.as_ref().map_or(0, VoxelGrid::len)
    }

    /// Whether the standard errors of any point are known.
    pub fn knows_errors(&self) -> bool {
        let known = |cell: terrace_grid::Cell| cell.stats().moments().noise().trace() > 0.0;
        self.fine.iter().flat_map(VoxelGrid::founded).any(known)
    }
}

impl MapParts<'_> {
    /// The map.
    pub fn mapper(&self) -> &Mapper {
        self.mapper
    }

    /// Its cells, in the order in which they were founded.
    pub fn cells(&self) -> impl Iterator<Item = MapCell<'_>> {
        let cells = self.mapper.fine.iter().flat_map(VoxelGrid::founded);
        let samples = self.mapper.samples();
        cells.map(move |cell| {
            let number = cell_number(cell.id());
            MapCell {
                key: cell.key(),
                sums: *cell.stats().moments(),
                sample: samples
                    .map_or_else(Vec::new, |samples| samples.sample(number).points().collect())
                    .into(),
                halvings: samples.map_or(0, |samples| samples.halvings(number)),
                seen: self.sightings.of_cell(cell.id().index()),
            }
        })
    }
}
