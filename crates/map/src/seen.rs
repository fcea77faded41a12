//! How many points of each cell each view saw, counted as they come.

use terrace_grid::CellId;

use crate::estimate::Sighting;

/// Memory grows with the cells that each view saw, not with their points.
#[derive(Debug, Clone, Default)]
pub(crate) struct Seen {
    /// Points of the last view, by cell.
    counts: Vec<u32>,
    /// The cells it saw.
    touched: Vec<CellId>,
    before: Vec<(CellId, Sighting)>,
}

impl Seen {
    /// Counts points of the last view by their cells.
    pub(crate) fn push(&mut self, cells: &[Option<CellId>]) {
        for cell in cells.iter().flatten() {
            if cell.index() >= self.counts.len() {
                self.counts.resize(cell.index() + 1, 0);
            }
            if let Some(count) = self.counts.get_mut(cell.index()) {
                if *count == 0 {
                    self.touched.push(*cell);
                }
                *count = count.saturating_add(1);
            }
        }
    }

    /// What follows is seen by the view after this one.
    pub(crate) fn end_view(&mut self, view: usize) {
        let ended: Vec<_> = self.by(view).collect();
        self.before.extend(ended);
        for cell in self.touched.drain(..) {
            if let Some(count) = self.counts.get_mut(cell.index()) {
                *count = 0;
            }
        }
    }

    /// What views that are over saw of a cell.
    pub(crate) fn restore(&mut self, cell: CellId, seen: &[Sighting]) {
        self.before.extend(seen.iter().map(|sighting| (cell, *sighting)));
    }

    /// Adds what the views of another map saw, behind so many views of this one. All are over.
    pub(crate) fn append<'s>(
        &mut self,
        views: usize,
        cells: impl Iterator<Item = (&'s CellId, &'s [Sighting])>,
    ) {
        if let Some(last) = views.checked_sub(1) {
            self.end_view(last);
        }
        let first = u32::try_from(views).unwrap_or(u32::MAX);
        for (cell, seen) in cells {
            let behind =
                |sighting: &Sighting| Sighting { view: first.saturating_add(sighting.view), ..*sighting };
            self.before.extend(seen.iter().map(|sighting| (*cell, behind(sighting))));
        }
    }

    /// All sightings, where `last` is the last view.
    pub(crate) fn all(&self, last: usize) -> impl Iterator<Item = (CellId, Sighting)> {
        self.before.iter().copied().chain(self.by(last))
    }

    fn by(&self, view: usize) -> impl Iterator<Item = (CellId, Sighting)> {
        // More scans than 32 bits can count do not occur: each has cells of its own here.
        let view = u32::try_from(view).unwrap_or(u32::MAX);
        let points = |cell: &CellId| self.counts.get(cell.index()).copied().unwrap_or(0);
        self.touched.iter().map(move |cell| (*cell, Sighting { view, points: points(cell) }))
    }
}
