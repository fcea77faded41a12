//! The growing map: scans in.

mod beside;
mod builder;
mod insert;
mod kept;
mod line;
mod merge;
mod parts;
mod view;

use std::borrow::Cow;
use std::sync::OnceLock;

use terrace_grid::{CellId, GridError, VoxelGrid};
use terrace_regions::{Order, Samples};

use crate::seen::Seen;
use crate::{CellSizeChoice, InsertError, Optimise, Params, ParamsError, StreamingError};

pub use builder::{MapBuilder, PartsError};
pub(crate) use kept::{Kept, Tags, cell_number, in_one_piece, number_of, tag};
pub use merge::MergeError;
pub use parts::{MapCell, MapParts};
pub use view::View;

/// Gathers scans into a grid of statistics, from which planes are extracted. See the [crate page](crate).
#[derive(Debug, Clone)]
pub struct Mapper {
    params: Params,
    chosen: Option<CellSizeChoice>,
    /// The cells that points are added to: of half the cell size where regions are grown.
    fine: Option<VoxelGrid>,
    /// Cells of the cell size, where they are not those that points are added to.
    coarse: OnceLock<Option<Coarse>>,
    /// Some points of each fine cell, where regions are grown.
    samples: Option<Samples>,
    /// In parts, so that nothing is moved when more come; nothing where points are forgotten.
    kept: Vec<Kept>,
    /// What each view saw of which cell, where points are not kept.
    seen: Option<Seen>,
    /// Whether that is left out where covariances do not need it.
    spares: bool,
    /// Where the sensors stood, scan after scan.
    views: Vec<View>,
}

/// Cells of the cell size, made of those of half of it.
#[derive(Debug, Clone)]
pub(crate) struct Coarse {
    pub(crate) grid: VoxelGrid,
    /// For each fine cell, the one it is a part of.
    pub(crate) of: Vec<CellId>,
}

/// The fine cells, as regions are grown of them.
pub(crate) struct FineCells<'m> {
    /// A map that is given away forgets them.
    pub(crate) grid: Cow<'m, VoxelGrid>,
    /// Along the curve, if that is known.
    pub(crate) order: Option<Order>,
}

/// What became of the points of a scan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inserted {
    /// Points that are now in the map.
    pub points: usize,
    /// Absent points: not finite.
    pub absent: usize,
    /// Points left out: too many cells away from the origin, or beyond the number of cells a grid holds.
    pub out_of_range: usize,
    /// The reason for the first point left out.
    pub first_refusal: Option<GridError>,
}

impl Mapper {
    /// An empty map.
    ///
    /// # Errors
    /// [`ParamsError`] when a parameter cannot be used.
    pub fn new(params: Params) -> Result<Self, ParamsError> {
        params.validate()?;
        Ok(Self {
            params,
            chosen: None,
            fine: None,
            coarse: OnceLock::new(),
            samples: None,
            kept: Vec::new(),
            seen: None,
            spares: false,
            views: Vec::new(),
        })
    }

    /// An empty map that forgets points once they are added: its memory grows with the cells that hold one, and with how many scans saw
    /// each. For scans that do not fit into memory, see [`Mapper::insert_more`] and
    /// [`Mapper::extract_streamed`].
    ///
    /// # Errors
    /// [`StreamingError`] when a parameter cannot be used, or points could not be told again by where they are
    /// ([`Params::by_place`]).
    pub fn streaming(params: Params) -> Result<Self, StreamingError> {
        if !params.by_place() {
            return Err(StreamingError::NotByPlace);
        }
        Ok(Self { seen: Some(Seen::default()), ..Self::new(params)? })
    }

    /// Counts which scans saw a cell only where covariances need it: where errors are not stated, or a pose is uncertain. That takes
    /// less memory. [`Mapper::extract`] cannot turn planes to the sensors then, only [`PointLabels`](crate::PointLabels) can, and the
    /// map has no [parts](Self::parts) and cannot be [merged](Self::merge). For a map without scans.
    #[must_use]
    pub fn spare_sightings(self) -> Self {
        Self { spares: true, ..self }
    }

    /// Changes how the next extractions search for φ; the points need not be inserted again.
    ///
    /// # Errors
    /// [`ParamsError`] when a setting cannot be used; the old ones stay.
    pub fn set_optimise(&mut self, optimise: Option<Optimise>) -> Result<(), ParamsError> {
        let params = Params { optimise, ..self.params };
        params.validate()?;
        self.params = params;
        Ok(())
    }

    /// Makes room for what is kept of so many more points in one piece, in which [`Mapper::into_planes`] then labels them; that of a single
    /// scan is in one piece anyway. Where points are [forgotten](Self::streaming), or there is no such room, nothing happens.
    pub fn reserve(&mut self, points: usize) {
        let has_room = self.kept.last().is_some_and(|kept| kept.has_room(points));
        if !self.is_streaming() && !has_room {
            self.kept.extend(Kept::try_of(points, self.params.grows().is_some()));
        }
    }

    /// The parameters as given.
    pub fn params(&self) -> &Params {
        &self.params
    }

    /// The grid, from the first scan on. Where regions are grown it is made of cells of half the size when it is asked for the first
    /// time after an insertion.
    pub fn grid(&self) -> Option<&VoxelGrid> {
        if self.params.grows().is_some() {
            self.coarse().map(|coarse| &coarse.grid)
        } else {
            self.fine.as_ref()
        }
    }

    /// The cells that points are added to.
    pub(crate) fn fine(&self) -> Option<&VoxelGrid> {
        self.fine.as_ref()
    }

    pub(crate) fn coarse(&self) -> Option<&Coarse> {
        let made = || {
            let (grid, of) = self.fine.as_ref()?.halved().ok()?;
            Some(Coarse { grid, of })
        };
        self.coarse.get_or_init(made).as_ref()
    }

    /// The fine cells, once the others are made of them.
    pub(crate) fn fine_cells(&self) -> Option<FineCells<'_>> {
        let order = self.make_coarse();
        Some(FineCells { grid: Cow::Borrowed(self.fine.as_ref()?), order })
    }

    /// Takes the fine cells away, once the others are made of them.
    pub(crate) fn take_fine(&mut self) -> Option<FineCells<'static>> {
        let order = self.make_coarse();
        Some(FineCells { grid: Cow::Owned(self.fine.take()?), order })
    }

    /// Makes the cells of the cell size, if they are not made yet; and the order of the fine ones meanwhile, where there is another thread.
    fn make_coarse(&self) -> Option<Order> {
        let are_made = self.params.grows().is_none() || self.coarse.get().is_some();
        let grid = self.fine.as_ref().filter(|_| !are_made)?;
        if rayon::current_num_threads() == 1 {
            self.coarse();
            return None;
        }
        let order = || {
            let keys: Vec<[i32; 3]> = grid.founded().map(|cell| cell.key()).collect();
            Order::of(keys.len(), |at| keys[at])
        };
        Some(rayon::join(|| self.coarse().is_some(), order).1)
    }

    /// Forgets what only extractions need.
    pub(crate) fn forget_samples(&mut self) {
        self.samples = None;
    }

    /// Some points of each fine cell; none where no regions are grown.
    pub(crate) fn samples(&self) -> Option<&Samples> {
        self.samples.as_ref()
    }

    pub(crate) fn kept(&self) -> &[Kept] {
        &self.kept
    }

    /// Takes away what is kept of the points.
    pub(crate) fn take_kept(&mut self) -> Vec<Kept> {
        std::mem::take(&mut self.kept)
    }

    /// What each view saw, where points are not kept.
    pub(crate) fn seen(&self) -> Option<&Seen> {
        self.seen.as_ref()
    }

    /// Whether points are forgotten once they are added: the map was made by [`Mapper::streaming`].
    pub fn is_streaming(&self) -> bool {
        self.seen.is_some()
    }

    /// Whether the first scan will be asked for a cell size: none is given, and none was chosen yet.
    pub fn wants_cell_size(&self) -> bool {
        self.fine.is_none() && self.params.cell_size.is_none()
    }

    /// Begins the map with a cell size that was chosen beforehand, from all of a scan that is inserted in chunks: see
    /// [`CellSizeSample`](crate::CellSizeSample). Nothing happens where none is [wanted](Self::wants_cell_size).
    ///
    /// # Errors
    /// [`InsertError::Grid`] when the grid refuses it.
    pub fn begin_with(&mut self, choice: CellSizeChoice) -> Result<(), InsertError> {
        if self.wants_cell_size() {
            self.begin(choice.cell_size)?;
            self.chosen = Some(choice);
        }
        Ok(())
    }

    /// Cells of this size, and samples of them where regions are grown.
    fn begin(&mut self, size: f64) -> Result<(), GridError> {
        if self.params.grows().is_some() {
            let grid = VoxelGrid::of_halves(size)?;
            self.samples = Some(Samples::new(grid.place_unit()));
            self.fine = Some(grid);
        } else {
            self.fine = Some(VoxelGrid::new(size, self.params.assignment)?);
        }
        Ok(())
    }

    /// The cell size that was chosen from the first scan; `None` when one was given, or before the first scan.
    pub fn chosen_cell_size(&self) -> Option<CellSizeChoice> {
        self.chosen
    }

    /// Number of points so far, absent ones included: the number of labels.
    pub fn len(&self) -> usize {
        self.views.iter().map(|view| view.points).sum()
    }

    /// Whether no scan with a point was inserted.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The cell of each point so far, scan after scan; `None` for points that were left out. None at all where they are not kept.
    pub fn cells_of_points(&self) -> impl Iterator<Item = Option<CellId>> {
        let coarse = self.params.grows().and_then(|_| self.coarse());
        self.kept.iter().flat_map(|kept| &kept.cells).map(move |cell| match coarse {
            None => *cell,
            Some(coarse) => coarse.of.get((*cell)?.index()).copied(),
        })
    }
}
