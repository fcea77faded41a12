//! The cost of settings, with the step it stands on.

use std::collections::VecDeque;

use terrace_crs::{Bounds, Cost, Evaluation};

use crate::tune::gridded::Gridded;
use crate::tune::prepared::Prepared;
use crate::tune::{Settings, TuneError, TuneStep, Tuner};

/// So many sets of normals are kept. A pattern search goes to and fro along each of the three settings that change them.
const PREPARED: usize = 6;

/// The cost of the settings of a space: a staircase in all of them that knows its steps. Made by
/// [`Tuner::cost`](crate::tune::Tuner::cost).
///
/// Another cell size costs a grid, once; another τ or depth new normals, unless they are those of one of the last few; ω
/// and φ a clustering.
pub struct TuneCost<'t> {
    pub(crate) tuner: &'t Tuner,
    pub(crate) bounds: Bounds,
    /// By cell size.
    grids: Vec<(f64, Gridded)>,
    /// The last used at the back.
    prepared: VecDeque<(Key, Prepared)>,
    /// Why the last value could not be told: a search only hears that it is not a number.
    pub(crate) refusal: Option<TuneError>,
}

/// What normals depend on: cell size, number of dense cells (which tells the set of them), depth.
type Key = (usize, usize, u32);

impl<'t> TuneCost<'t> {
    pub(crate) fn new(tuner: &'t Tuner, bounds: Bounds) -> Self {
        Self { tuner, bounds, grids: Vec::new(), prepared: VecDeque::new(), refusal: None }
    }

    /// The cost at any settings, those of the space or others, and where it is the same.
    ///
    /// # Errors
    /// [`TuneError`] for settings that are none.
    pub fn at(&mut self, settings: &Settings) -> Result<TuneStep, TuneError> {
        let Tuner { params, scans, objective, .. } = self.tuner;
        settings.in_params(params).validate()?;
        let size = settings.cell_size;
        let known = self.grids.iter().position(|(of, _)| of.to_bits() == size.to_bits());
        let grid = known.unwrap_or(self.grids.len());
        if known.is_none() {
            self.grids.push((size, Gridded::new(params, size, scans, objective.truth())?));
        }
        let gridded = &self.grids[grid].1;
        let key = (grid, gridded.dense(settings.tau), settings.depth);
        let known = self.prepared.iter().position(|(of, _)| *of == key);
        let prepared = match known.and_then(|at| self.prepared.remove(at)) {
            Some((_, known)) => known,
            None => Prepared::new(gridded, settings, params)?,
        };
        let step = prepared.step(gridded, settings, params, objective);
        if self.prepared.len() == PREPARED {
            self.prepared.pop_front();
        }
        self.prepared.push_back((key, prepared));
        step
    }
}

impl Cost for TuneCost<'_> {
    fn evaluate(&mut self, x: &[f64]) -> Evaluation {
        let Some(settings) = Settings::at(x) else { return Evaluation::point(f64::NAN) };
        match self.at(&settings) {
            Ok(step) => step.evaluation(&settings),
            Err(refusal) => {
                self.refusal = Some(refusal);
                Evaluation::point(f64::NAN)
            }
        }
    }

    fn dimension(&self) -> Option<usize> {
        Some(5)
    }
}
