//! Noisy copies of a place with known planes.

use std::num::NonZeroU32;

use rayon::prelude::*;
use terrace::{Mapper, Params, PlaneMap};
use terrace_calibration::{Calibration, Exceedance};
use terrace_noise::PoseNoise;
use terrace_synth::{LabelledScan, misplaced};
use terrace_types::{PlaneId, Sigma};

use crate::deviation::normal_error;
use crate::interior::Interiors;
use crate::{Deviation, KnownPlace, KnownPlane, PointNoise, TrialError};

/// A plane found is the known one that at least this share of its points are of.
pub const MAJORITY: f64 = 0.8;
/// And a pure one from this share on. Of others a part of the error is that of the segmentation, and they are counted apart.
pub const PURE: f64 = 0.95;

/// How trials are made.
#[derive(Debug, Clone)]
pub struct Trials {
    /// Number of noisy copies.
    pub copies: NonZeroU32,
    /// Of all noise.
    pub seed: u64,
    /// How points are wrong.
    pub noise: PointNoise,
    /// Whether the mapper is told the errors of points; otherwise it has to find them out.
    pub told: bool,
    /// How wrong the poses are; `None`: not at all.
    pub pose: Option<PoseNoise>,
    /// Whether the mapper is told that poses are wrong.
    pub pose_told: bool,
    /// Whether cells are looked at as well, which takes about as long again.
    pub cells: bool,
    /// How planes are extracted.
    pub params: Params,
}

impl Default for Trials {
    fn default() -> Self {
        Self {
            copies: NonZeroU32::MIN.saturating_add(99),
            seed: 0,
            noise: PointNoise::Own,
            told: true,
            pose: None,
            pose_told: true,
            cells: true,
            params: Params::default(),
        }
    }
}

/// What trials have shown.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Copies made.
    pub copies: u32,
    /// Squared errors of the tilt and offset of pure planes.
    pub planes: Calibration,
    /// The same for planes of which more than [`PURE`] allows, but no more than [`MAJORITY`] does, are points of something else.
    pub mixed: Calibration,
    /// Of pure planes, for each known one in the order of their numbers.
    pub by_plane: Vec<(String, Calibration)>,
    /// Components of the normals of planes, and whether they are off by more than their min-max.
    pub plane_bounds: Exceedance,
    /// Squared errors of the planes around interior cells: cells whose surroundings hold points of one known plane only, which
    /// goes on to all sides.
    pub cells: Calibration,
    /// Components of the normals of interior cells, and whether they are off by more than their min-max.
    pub cell_bounds: Exceedance,
    /// The same for the normals that are clustered: those fitted to the dense cells without regard to errors.
    pub fitted_bounds: Exceedance,
    /// Planes found that are no known one: no known plane has [`MAJORITY`] of their points.
    pub unmatched: usize,
    /// Known planes found that have no estimate.
    pub without: usize,
    /// Estimates whose residuals were larger than their errors say.
    pub grown: usize,
}

impl Outcome {
    fn none(planes: &[KnownPlane]) -> Result<Self, TrialError> {
        let by_plane = planes.iter().map(|p| Ok((p.name.clone(), Calibration::new(3)?)));
        Ok(Self {
            copies: 0,
            planes: Calibration::new(3)?,
            mixed: Calibration::new(3)?,
            by_plane: by_plane.collect::<Result<_, TrialError>>()?,
            plane_bounds: Exceedance::new(),
            cells: Calibration::new(3)?,
            cell_bounds: Exceedance::new(),
            fitted_bounds: Exceedance::new(),
            unmatched: 0,
            without: 0,
            grown: 0,
        })
    }

    /// Adds the outcome of other copies of the same place. In which order does not matter, but for the order of the values.
    ///
    /// # Errors
    /// [`TrialError::Places`], with nothing changed, when the known planes are others.
    pub fn merge(&mut self, other: &Self) -> Result<(), TrialError> {
        let names =
            |outcome: &Self| outcome.by_plane.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>();
        let (ours, theirs) = (names(self), names(other));
        if ours != theirs {
            return Err(TrialError::Places { ours, theirs });
        }
        self.copies += other.copies;
        self.planes.merge(&other.planes)?;
        self.mixed.merge(&other.mixed)?;
        for ((_, all), (_, more)) in self.by_plane.iter_mut().zip(&other.by_plane) {
            all.merge(more)?;
        }
        self.plane_bounds.merge(&other.plane_bounds);
        self.cells.merge(&other.cells)?;
        self.cell_bounds.merge(&other.cell_bounds);
        self.fitted_bounds.merge(&other.fitted_bounds);
        self.unmatched += other.unmatched;
        self.without += other.without;
        self.grown += other.grown;
        Ok(())
    }
}

impl Trials {
    /// Makes the copies, extracts their planes, and compares each with the known plane that most of its points are of.
    /// `done` is told of each copy, in no fixed order; the outcome does not depend on the number of threads.
    ///
    /// # Errors
    /// [`TrialError`] of the first copy that failed.
    pub fn run(&self, place: &KnownPlace, done: impl Fn() + Sync) -> Result<Outcome, TrialError> {
        let planes = place.planes();
        let copies: Vec<Outcome> = (0..self.copies.get())
            .into_par_iter()
            .map(|copy| {
                let outcome = self.copy(place, &planes, u64::from(copy));
                done();
                outcome
            })
            .collect::<Result<_, _>>()?;
        let mut all = Outcome::none(&planes)?;
        for copy in &copies {
            all.merge(copy)?;
        }
        Ok(all)
    }

    fn copy(&self, place: &KnownPlace, planes: &[KnownPlane], copy: u64) -> Result<Outcome, TrialError> {
        let scans = place.copy(self.noise, self.seed, copy)?;
        let mut mapper = Mapper::new(self.params)?;
        for (LabelledScan { scan, .. }, stream) in scans.iter().zip(0..) {
            let mut scan = match &self.pose {
                Some(noise) => misplaced(scan, noise, self.seed.wrapping_add(copy), stream)?,
                None => scan.clone(),
            };
            if !self.told {
                // Nothing to check: there is nothing.
                scan = scan.with_sigma(Sigma::Unknown).map_err(terrace_synth::StatedError::from)?;
            }
            mapper.insert_from(&scan, self.pose.filter(|_| self.pose_told))?;
        }
        let map = mapper.extract()?;
        let truth: Vec<Option<PlaneId>> = scans.iter().flat_map(|s| s.labels.iter().copied()).collect();
        let mut outcome = Outcome { copies: 1, ..Outcome::none(planes)? };
        for_planes(&mut outcome, &map, &truth, planes)?;
        if self.cells {
            for_cells(&mut outcome, &mapper, &truth, planes)?;
        }
        Ok(outcome)
    }
}

fn for_planes(
    outcome: &mut Outcome,
    map: &PlaneMap,
    truth: &[Option<PlaneId>],
    planes: &[KnownPlane],
) -> Result<(), TrialError> {
    // How many points of each plane found are of each one known.
    let mut shared = vec![vec![0_u64; planes.len()]; map.planes.len()];
    let place = |id: PlaneId| planes.iter().position(|known| known.id == id);
    for (found, truth) in map.labels.iter().zip(truth) {
        if let (Some(found), Some(known)) = (found, truth.and_then(place))
            && let Some(count) = shared.get_mut(found.index()).and_then(|of| of.get_mut(known))
        {
            *count += 1;
        }
    }
    for (found, shared) in map.planes.iter().zip(&shared) {
        let most = shared
            .iter()
            .zip(planes)
            .enumerate()
            .max_by_key(|(place, (count, _))| (**count, usize::MAX - place));
        let Some((place, (count, known))) =
            most.filter(|(_, (count, _))| **count as f64 >= MAJORITY * found.points as f64)
        else {
            outcome.unmatched += 1;
            continue;
        };
        let Some(estimate) = found.estimate else {
            outcome.without += 1;
            continue;
        };
        let squared = Deviation::of(&estimate, &known.plane).squared;
        if (*count as f64) < PURE * found.points as f64 {
            push(&mut outcome.mixed, squared)?;
            continue;
        }
        outcome.grown += usize::from(estimate.growth > 1.0);
        bounds(&mut outcome.plane_bounds, estimate.plane.normal(), estimate.min_max, known)?;
        push(&mut outcome.planes, squared)?;
        if let Some((_, of_plane)) = outcome.by_plane.get_mut(place) {
            push(of_plane, squared)?;
        }
    }
    Ok(())
}

fn for_cells(
    outcome: &mut Outcome,
    mapper: &Mapper,
    truth: &[Option<PlaneId>],
    planes: &[KnownPlane],
) -> Result<(), TrialError> {
    let interiors = Interiors::of(mapper, truth);
    for cell in mapper.cell_planes()? {
        let Some(known) =
            interiors.plane_of(cell.key).and_then(|id| planes.iter().find(|known| known.id == id))
        else {
            continue;
        };
        let block = (2 * mapper.params().depth as usize + 1).pow(2);
        if let Some(estimate) = cell.estimate.filter(|estimate| estimate.columns == block) {
            bounds(&mut outcome.fitted_bounds, cell.fitted.fit.normal, Some(cell.fitted.uncertainty), known)?;
            bounds(&mut outcome.cell_bounds, estimate.plane.normal(), estimate.min_max, known)?;
            push(&mut outcome.cells, Deviation::of(&estimate, &known.plane).squared)?;
        }
    }
    Ok(())
}

fn bounds(
    exceedance: &mut Exceedance,
    normal: [f64; 3],
    bound: Option<[f64; 3]>,
    known: &KnownPlane,
) -> Result<(), TrialError> {
    for (error, bound) in normal_error(normal, &known.plane).into_iter().zip(bound.into_iter().flatten()) {
        exceedance.push_error(error, bound)?;
    }
    Ok(())
}

fn push(calibration: &mut Calibration, squared: Option<f64>) -> Result<(), TrialError> {
    match squared {
        Some(squared) => calibration.push(squared)?,
        None => calibration.refuse(),
    }
    Ok(())
}
