//! Scans against each other: does each scan see a plane where the others see it?

mod agreement;
mod common;

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;
use terrace::{Estimate, ExtractError, Mapper, Params, PlaneEstimate, PlaneMap};
use terrace_noise::PoseNoise;
use terrace_types::{PlaneId, Scan};

pub use agreement::{Agreement, PlaneAgreement, Ratio, Residual, Scatter};
use common::Common;

use crate::{PURE, TrialError};

/// A plane of a scan that is turned further from that of the reference, in radians, is another one: tilts are no small angles
/// then, and no covariance is meant for them.
pub const TURNED: f64 = 0.5;

/// The planes of all scans together, by which it is known which planes of single scans are the same.
///
/// Scans need not be in memory at once: put each into a [`Mapper`], extract its planes, and read each again for
/// [`Reference::look`]. Of all that only a [`Look`] a scan is kept. For scans that are in memory there is
/// [`scans_against_each_other`].
#[derive(Debug, Clone)]
pub struct Reference {
    params: Params,
    planes: Vec<(PlaneId, u64, Common)>,
    labels: Vec<Option<PlaneId>>,
}

/// What one scan sees by itself.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Look {
    /// The planes of the reference that it sees, each once.
    pub sightings: Vec<Sighting>,
    /// Planes of the scan that are none of the reference: none has [`PURE`] of their labelled points.
    pub unmatched: usize,
    /// Planes of the scan that have no estimate.
    pub without: usize,
    /// Planes of the scan on a plane of the reference that are turned by more than [`TURNED`] from it.
    pub turned: usize,
    /// Further planes on a plane of the reference, with fewer points than the one that was taken.
    pub lesser: usize,
}

/// A plane of the reference as one scan sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sighting {
    /// The plane of the reference.
    pub plane: PlaneId,
    /// Labelled points of the scan's own plane.
    pub points: u64,
    /// The scan's own plane.
    pub estimate: PlaneEstimate,
}

impl Reference {
    /// From the map of all scans. Single scans get cells of the same size.
    pub fn new(map: PlaneMap) -> Self {
        let params = Params { cell_size: Some(map.used.cell_size), ..map.used.params };
        let planes = map.planes.iter().map(|plane| (plane.id, plane.points, Common::of(plane))).collect();
        Self { params, planes, labels: map.labels }
    }

    /// The planes of one scan by itself. Its first point is the point `first` of the map: before it come the points of all
    /// scans that were inserted earlier, absent ones included. The floor, in metres, is that of
    /// [`Estimate::floor`](terrace::Estimate::floor).
    ///
    /// A scan without planes, or without a point, has an empty look.
    ///
    /// # Errors
    /// [`TrialError::Unlabelled`] when the map does not have all its points, and what the mapper refuses.
    pub fn look(
        &self,
        scan: &Scan,
        pose: Option<PoseNoise>,
        first: usize,
        floor: f64,
    ) -> Result<Look, TrialError> {
        let end = first.saturating_add(scan.len());
        let points = self.labels.len();
        let labels = self.labels.get(first..end).ok_or(TrialError::Unlabelled { first, end, points })?;
        let mut mapper = Mapper::new(Params { estimate: Some(Estimate { floor }), ..self.params })?;
        mapper.insert_from(scan, pose)?;
        match mapper.extract() {
            Ok(map) => Ok(Look::of(&map, labels, &self.planes)),
            Err(ExtractError::Empty) => Ok(Look::default()),
            Err(error) => Err(error.into()),
        }
    }
}

impl Look {
    fn of(map: &PlaneMap, reference: &[Option<PlaneId>], planes: &[(PlaneId, u64, Common)]) -> Self {
        // For each of its planes the labelled points, and those of them on each plane of the reference.
        let mut shared: Vec<(u64, BTreeMap<PlaneId, u64>)> = vec![Default::default(); map.planes.len()];
        for (own, reference) in map.labels.iter().zip(reference) {
            let Some((points, on)) = own.and_then(|own| shared.get_mut(own.index())) else { continue };
            *points += 1;
            if let Some(reference) = reference {
                *on.entry(*reference).or_default() += 1;
            }
        }
        let mut look = Self::default();
        let mut best: BTreeMap<PlaneId, Sighting> = BTreeMap::new();
        for (own, (points, on)) in map.planes.iter().zip(shared) {
            let same = on.iter().find(|(_, count)| **count as f64 >= PURE * points as f64);
            let Some((plane, _)) = same else {
                look.unmatched += 1;
                continue;
            };
            let Some(estimate) = own.estimate else {
                look.without += 1;
                continue;
            };
            let turned =
                |(id, _, common): &(PlaneId, u64, Common)| id == plane && common.angle(&estimate) > TURNED;
            if planes.iter().any(turned) {
                look.turned += 1;
                continue;
            }
            let sighting = Sighting { plane: *plane, points, estimate };
            match best.get_mut(plane) {
                None => {
                    best.insert(*plane, sighting);
                }
                Some(other) => {
                    look.lesser += 1;
                    if other.points < points {
                        *other = sighting;
                    }
                }
            }
        }
        look.sightings = best.into_values().collect();
        look
    }
}

/// Holds scans against each other that are in memory, each with how sure its pose is; planes seen by fewer than `views` of
/// them are left out. `done` is told of each scan, first when it is in the map of all, then when it was looked at; the
/// result does not depend on the number of threads.
///
/// # Errors
/// [`TrialError`] when the mapper refuses a scan or a parameter.
pub fn scans_against_each_other(
    scans: &[(Scan, Option<PoseNoise>)],
    params: Params,
    views: usize,
    done: impl Fn(usize) + Sync,
) -> Result<Agreement, TrialError> {
    let count = AtomicUsize::new(0);
    let step = || done(count.fetch_add(1, Ordering::Relaxed) + 1);
    let mut mapper = Mapper::new(params)?;
    let mut firsts = Vec::with_capacity(scans.len());
    for (scan, pose) in scans {
        firsts.push(mapper.len());
        mapper.insert_from(scan, *pose)?;
        step();
    }
    let reference = Reference::new(mapper.extract()?);
    drop(mapper);
    let floor = params.estimate.map_or(0.0, |estimate| estimate.floor);
    let looks: Vec<Look> = scans
        .par_iter()
        .zip(firsts)
        .map(|((scan, pose), first)| {
            let look = reference.look(scan, *pose, first, floor);
            step();
            look
        })
        .collect::<Result<_, _>>()?;
    reference.compare(&looks, views)
}
