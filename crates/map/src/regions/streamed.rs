//! Regions whose points are not kept: planes first, labels as the points are read again.

use terrace_grid::{CellId, CellIndex};
use terrace_regions::Labeller;
use terrace_types::PlaneId;

use super::coplanar::add_points;
use super::tallies::{Borrowed, Measures, Tallies};
use super::{Grown, Planes, label_each, renumbered, summed};
use crate::facing::Seen;
use crate::mapper::{FineCells, cell_number};
use crate::{ExtractError, ExtractedPlane, Mapper, PlaneMap, Regions, Stage};

/// Tells points of regions, and measures those it has told.
#[derive(Debug, Clone)]
pub(crate) struct RegionLabels {
    labeller: Labeller,
    /// The plane of each region.
    numbers: Vec<Option<PlaneId>>,
    /// The plane of each cell of the grid.
    pub(crate) of_cells: Vec<Option<PlaneId>>,
    tallies: Tallies,
    /// The points of each region that each view saw.
    by_view: Vec<Measures>,
}

impl Mapper {
    /// The planes as regions, with points as they are told by samples, and what tells the points.
    /// Of its fine cells, as [`Grown::of`] takes them, and which they were if they were given away.
    pub(crate) fn regions_streamed(
        &self,
        cells: Option<FineCells<'_>>,
        settings: &Regions,
        mut begins: impl FnMut(Stage),
    ) -> Result<(PlaneMap, RegionLabels, Option<CellIndex>), ExtractError> {
        let grown = Grown::of(self, cells, self.kept(), settings, &mut begins)?;
        begins(Stage::Label { points: self.len() });
        let regions = grown.found.regions.len();
        let Planes { map, joined, labeller, index, of_cells } = grown.planes();
        let numbers = joined.unwrap_or_else(|| (0..regions).map(PlaneId::from_index).collect());
        let (tallies, by_view) = (Tallies::default(), vec![Measures::new(); self.views().len()]);
        Ok((map, RegionLabels { labeller, numbers, of_cells, tallies, by_view }, index))
    }
}

impl RegionLabels {
    /// What a thread counts in the points that it labels.
    pub(crate) fn tally(&self) -> Borrowed<'_> {
        self.tallies.borrow(&self.labeller)
    }

    /// Labels points by their cells and places, and measures them.
    pub(crate) fn label(
        &self,
        cells: &[Option<CellId>],
        places: &[[f32; 3]],
        labels: &mut [Option<PlaneId>],
        tally: &mut Borrowed<'_>,
    ) {
        let number = |region: u32| self.numbers.get(region as usize).copied().flatten();
        let points = cells.iter().map(|cell| cell.map(cell_number)).zip(places.iter().copied()).zip(labels);
        label_each(&self.labeller, points, tally, |label, found| *label = found.and_then(number));
    }

    /// What points measure that were labelled since the last time is that of points of a view; of no view, if they are not to count.
    pub(crate) fn counted(&mut self, view: Option<usize>) {
        let mut of_none = Measures::new();
        self.tallies.add_to(view.and_then(|view| self.by_view.get_mut(view)).unwrap_or(&mut of_none));
    }

    /// Gives the planes the points that were labelled, and tells how many of each plane each view saw.
    pub(crate) fn finish(&self, planes: &mut [ExtractedPlane]) -> Vec<Seen> {
        let measures = summed(&self.by_view, self.numbers.len());
        for plane in &mut *planes {
            plane.points = 0;
        }
        for (region, (measure, number)) in measures.iter().zip(&self.numbers).enumerate() {
            let plane = number.and_then(|number| planes.get_mut(number.index()));
            let (Some(plane), Some((mean, rms))) = (plane, self.labeller.mean_and_rms(region, measure))
            else {
                continue;
            };
            if plane.points == 0 {
                (plane.points, plane.centroid, plane.rms) = (measure.points, mean, rms);
            } else {
                add_points(plane, measure.points, mean, rms);
            }
        }
        renumbered(&self.by_view, &self.numbers)
    }
}
