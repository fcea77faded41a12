//! Two maps into one.

use terrace_grid::{CellId, GridError, VoxelGrid};

use super::{Kept, Mapper, cell_number};
use crate::estimate::Sightings;
use crate::seen::Seen;
use crate::{Params, Regions};

/// Why two maps cannot be made one. The map merged into is then as it was, but for [`MergeError::Grid`].
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MergeError {
    /// Cells of different sizes have no sums in common.
    #[error("the cells of one map are {ours} m wide, those of the other {theirs} m")]
    CellSizes {
        /// Of the map merged into, in metres.
        ours: f64,
        /// Of the other.
        theirs: f64,
    },
    /// One of the maps finds cells by expected distance, or weighs points: cells of parts are then not those of the whole.
    #[error("{} and {}: maps add up where points are added by place and each counts the same", told(*ours), told(*theirs))]
    NotByPlace {
        /// Whether the map merged into does.
        ours: bool,
        /// Whether the other does.
        theirs: bool,
    },
    /// Only one of the maps has samples of its points, as regions need them.
    #[error("{} and {} cannot be one map", grown(*ours), grown(*theirs))]
    Kinds {
        /// Whether the map merged into grows regions.
        ours: bool,
        /// Whether the other does.
        theirs: bool,
    },
    /// It is not known what the views of a map saw: see [`Mapper::spare_sightings`].
    #[error("what the views of a map saw is not known everywhere: it was made to spare that")]
    Spared,
    /// The standard errors of the points of one map are stated, and those of the other are not known.
    #[error("the standard errors of the points are {} in one map and {} in the other", stated(*ours), stated(*theirs))]
    Errors {
        /// Whether those of the map merged into are known.
        ours: bool,
        /// Whether those of the other are.
        theirs: bool,
    },
    /// A setting differs. Give both maps the same one: [`Mapper::set_params`].
    #[error("the setting {name} is {ours} in one map and {theirs} in the other")]
    Settings {
        /// As it is called in [`Params`].
        name: &'static str,
        /// In the map merged into.
        ours: String,
        /// In the other.
        theirs: String,
    },
    /// All cells together are more than a grid holds; the map then has a part of those of the other.
    #[error(transparent)]
    Grid(#[from] GridError),
}

fn told(by_place: bool) -> &'static str {
    if by_place { "by place" } else { "by expected distance or weight" }
}

fn grown(regions: bool) -> &'static str {
    if regions { "a map for regions" } else { "a map for clusters" }
}

fn stated(known: bool) -> &'static str {
    if known { "stated" } else { "unknown" }
}

impl Mapper {
    /// Adds another map: its cells to those of the same places, and its views behind the views so far. That of parts of the scans is then
    /// the map of all of them, up to rounding of the sums, whatever the order. A scan whose points went into several maps counts as one
    /// view in each. Where one of the maps [forgets](Mapper::streaming) its points, so does the result.
    ///
    /// ```
    /// use terrace::{Frame, Mapper, Params, Scan, Sigma};
    ///
    /// let strip = |i: u32| {
    ///     let point = |k: u32| [0.02 * f64::from(k % 100), 0.02 * f64::from(50 * i + k / 100), 0.0];
    ///     Scan::new((0..5000).map(point).collect(), Sigma::Uniform(0.005), Frame::World { sensor: None })
    /// };
    /// let params = Params { cell_size: Some(0.1), ..Params::default() };
    /// let [mut one, mut other] = [Mapper::streaming(params)?, Mapper::streaming(params)?];
    /// one.insert(&strip(0)?)?;
    /// other.insert(&strip(1)?)?;
    /// one.merge(&other)?;
    /// assert_eq!((one.len(), one.extract()?.planes.len()), (10_000, 1));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`MergeError`] with what differs.
    pub fn merge(&mut self, other: &Self) -> Result<(), MergeError> {
        self.compare(other)?;
        let Some(theirs) = &other.fine else { return Ok(()) };
        if self.is_streaming() != other.is_streaming() {
            self.forget();
        }
        if other.params.cell_size.is_some() {
            (self.params.cell_size, self.chosen) = (other.params.cell_size, None);
        } else if self.params.cell_size.is_none() {
            self.chosen = self.chosen.or(other.chosen);
        }
        if let (None, Some(size)) = (&self.fine, other.cell_size()) {
            self.begin(size)?;
        }
        let Some(ours) = &mut self.fine else { return Ok(()) };
        self.coarse = std::sync::OnceLock::new();
        // Founded in the order of a run over both.
        let mut cells: Vec<CellId> = Vec::with_capacity(theirs.len());
        for cell in theirs.founded() {
            let id = ours.add_cell(cell.key(), cell.stats().moments())?;
            if let (Some(samples), Some(others)) = (&mut self.samples, &other.samples) {
                samples.merge(cell_number(id), others, cell_number(cell.id()));
            }
            cells.push(id);
        }
        let renumbered = |cell: CellId| cells.get(cell.index()).copied();
        if let Some(seen) = &mut self.seen {
            let views = self.views.len();
            let of_other = Sightings::of_fine(other);
            seen.append(views, cells.iter().zip((0..).map(|cell| of_other.of_cell(cell))));
        } else {
            self.kept.extend(other.kept.iter().map(|kept| Kept {
                cells: kept.cells.iter().map(|cell| cell.and_then(renumbered)).collect(),
                places: kept.places.clone(),
            }));
        }
        self.views.extend_from_slice(&other.views);
        Ok(())
    }

    /// Changes the settings of the next extractions. What cells are made by stays as it is: `cell_size`, `assignment`, `weighting`, and
    /// whether regions are grown.
    ///
    /// # Errors
    /// [`ParamsError`](crate::ParamsError) when a setting cannot be used; the old ones stay.
    pub fn set_params(&mut self, params: Params) -> Result<(), crate::ParamsError> {
        let Params { cell_size, assignment, weighting, regions, .. } = self.params;
        let regions = regions.map(|old| params.regions.unwrap_or(old));
        let params = Params { cell_size, assignment, weighting, regions, ..params };
        params.validate()?;
        self.params = params;
        Ok(())
    }

    /// Counts what each view saw, and forgets the points.
    fn forget(&mut self) {
        if self.seen.is_none() {
            let sightings = Sightings::of_fine(self);
            let mut seen = Seen::default();
            for cell in self.fine.iter().flat_map(VoxelGrid::founded) {
                seen.restore(cell.id(), sightings.of_cell(cell.id().index()));
            }
            self.seen = Some(seen);
            self.kept = Vec::new();
        }
    }

    /// Whether the other can be added.
    fn compare(&self, other: &Self) -> Result<(), MergeError> {
        let [ours, theirs] = [self, other].map(|mapper| mapper.params.by_place());
        if !(ours && theirs) {
            return Err(MergeError::NotByPlace { ours, theirs });
        }
        let [ours, theirs] = [self, other].map(|mapper| mapper.params.grows().is_some());
        if ours != theirs {
            return Err(MergeError::Kinds { ours, theirs });
        }
        if self.spares || other.spares {
            return Err(MergeError::Spared);
        }
        if let (Some(ours), Some(theirs)) = (self.cell_size(), other.cell_size())
            && ours.to_bits() != theirs.to_bits()
        {
            return Err(MergeError::CellSizes { ours, theirs });
        }
        let [ours, theirs] = [self, other].map(Self::knows_errors);
        if ours != theirs && self.cells() > 0 && other.cells() > 0 {
            return Err(MergeError::Errors { ours, theirs });
        }
        let (ours, theirs) = (settings(&self.params), settings(&other.params));
        match ours.into_iter().zip(theirs).find(|(ours, theirs)| ours != theirs) {
            Some(((name, ours), (_, theirs))) => Err(MergeError::Settings { name, ours, theirs }),
            None => Ok(()),
        }
    }
}

/// The settings of extractions, by name.
fn settings(params: &Params) -> Vec<(&'static str, String)> {
    let p = params;
    let mut named = vec![
        ("tau", format!("{:?}", p.tau)),
        ("omega", format!("{:?}", p.omega)),
        ("phi", format!("{:?}", p.phi)),
        ("depth", format!("{:?}", p.depth)),
        ("connectivity", format!("{:?}", p.connectivity)),
        ("fit", format!("{:?}", p.fit)),
        ("random_seeds", format!("{:?}", p.random_seeds)),
        ("optimise", format!("{:?}", p.optimise)),
        ("estimate", format!("{:?}", p.estimate)),
        ("min_cells", format!("{:?}", p.min_cells)),
        ("seed", format!("{:?}", p.seed)),
    ];
    if let Some(regions) = &p.regions {
        let Regions { tilt, reach, turn, min_points, min_area, join, errors_are_complete, leave_out } =
            regions;
        named.extend([
            ("regions.tilt", format!("{tilt:?}")),
            ("regions.reach", format!("{reach:?}")),
            ("regions.turn", format!("{turn:?}")),
            ("regions.min_points", format!("{min_points:?}")),
            ("regions.min_area", format!("{min_area:?}")),
            ("regions.join", format!("{join:?}")),
            ("regions.errors_are_complete", format!("{errors_are_complete:?}")),
            ("regions.leave_out", format!("{leave_out:?}")),
        ]);
    }
    named
}
