//! Each scan's plane against that of all others.

use glam::{DMat3, DVec3};
use terrace_calibration::{Calibration, chi_squared_quantile, squared_mahalanobis};
use terrace_types::PlaneId;

use super::common::{Common, Seen, inverse};
use super::{Look, Reference, Sighting};
use crate::TrialError;

/// How well scans agree about the planes that they see.
#[derive(Debug, Clone, PartialEq)]
pub struct Agreement {
    /// Squared residuals of all planes: each scan against the others, in units of the covariances.
    pub all: Calibration,
    /// The scatter of all planes.
    pub scatter: Scatter,
    /// The planes seen by enough scans, in the order of their numbers.
    pub planes: Vec<PlaneAgreement>,
    /// Planes of the reference that too few scans see.
    pub seldom: usize,
    /// Planes of scans that are none of the reference.
    pub unmatched: usize,
    /// Planes of scans that have no estimate.
    pub without: usize,
    /// Planes of scans that are turned by more than [`TURNED`](crate::TURNED) from the plane of the reference that they are on.
    pub turned: usize,
    /// Further planes of a scan on a plane of the reference.
    pub lesser: usize,
}

/// How well scans agree about one plane.
#[derive(Debug, Clone, PartialEq)]
pub struct PlaneAgreement {
    /// Its number in the reference.
    pub id: PlaneId,
    /// Its points there.
    pub points: u64,
    /// Squared residuals, those of [`residuals`](Self::residuals).
    pub calibration: Calibration,
    /// Their scatter about their mean.
    pub scatter: Scatter,
    /// Each scan that sees it against the others, in the order of the scans.
    pub residuals: Vec<Residual>,
}

/// The plane of one scan against the mean of the others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Residual {
    /// Number of the scan, from 0.
    pub scan: usize,
    /// Points of the plane in the scan.
    pub points: u64,
    /// Columns of cells that the estimate rests on.
    pub columns: usize,
    /// What the covariance of the estimate was multiplied by.
    pub growth: f64,
    /// Reduced χ² of the points about the estimate.
    pub reduced_chi_squared: f64,
    /// Distance of the estimate from the place where planes are compared, the centroid of the plane of all scans, in metres.
    pub distance: f64,
    /// (tilt₁, tilt₂, height), radians and metres, along axes of the plane and at that place: the scan less the others.
    pub difference: [f64; 3],
    /// Its predicted standard deviations.
    pub predicted: [f64; 3],
    /// Its square in units of the predicted covariance; `None` for one without an inverse.
    pub squared: Option<f64>,
}

/// Squared distances of all from their weighted mean: a χ² variable if the covariances are right and the errors Gaussian
/// and independent from scan to scan.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Scatter {
    /// Their sum.
    pub squared: f64,
    /// Degrees of freedom: three for each scan but one.
    pub degrees: u32,
}

impl Scatter {
    /// The sum over the degrees of freedom, about 1 for covariances that are right; `None` with fewer than two scans.
    pub fn reduced(&self) -> Option<f64> {
        (self.degrees > 0).then(|| self.squared / f64::from(self.degrees))
    }

    /// Where [`reduced`](Self::reduced) falls with this probability when all is right; `None` as well when the level is not
    /// above 0 and below 1.
    pub fn band(&self, level: f64) -> Option<[f64; 2]> {
        self.reduced()?;
        let (degrees, tail) = (f64::from(self.degrees), (1.0 - level) / 2.0);
        let end = |probability| Some(chi_squared_quantile(degrees, probability)? / degrees);
        (level > 0.0 && level < 1.0).then_some([end(tail)?, end(1.0 - tail)?])
    }
}

/// How large errors are over how large they were predicted: roots of squared errors over their expectation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ratio {
    /// By means: the root of NEES per degree of freedom.
    pub rms: f64,
    /// By medians: the root of [`Calibration::median_ratio`]. Outliers do not move it.
    pub median: f64,
}

impl Ratio {
    /// `None` without values.
    pub fn of(calibration: &Calibration) -> Option<Self> {
        Some(Self { rms: calibration.nees()?.sqrt(), median: calibration.median_ratio()?.sqrt() })
    }
}

impl Reference {
    /// Compares what the scans saw, in the order of their numbers, for each plane seen by at least `views` (and two) of them.
    ///
    /// # Errors
    /// [`TrialError::Calibration`] when a squared residual is no number.
    pub fn compare(&self, looks: &[Look], views: usize) -> Result<Agreement, TrialError> {
        let mut agreement = Agreement {
            all: Calibration::new(3)?,
            scatter: Scatter::default(),
            planes: Vec::new(),
            seldom: 0,
            unmatched: looks.iter().map(|look| look.unmatched).sum(),
            without: looks.iter().map(|look| look.without).sum(),
            turned: looks.iter().map(|look| look.turned).sum(),
            lesser: looks.iter().map(|look| look.lesser).sum(),
        };
        for (id, points, common) in &self.planes {
            let seen: Vec<(usize, &Sighting)> = looks
                .iter()
                .enumerate()
                .flat_map(|(scan, look)| look.sightings.iter().map(move |sighting| (scan, sighting)))
                .filter(|(_, sighting)| sighting.plane == *id)
                .collect();
            if seen.len() < views.max(2) {
                agreement.seldom += 1;
                continue;
            }
            let plane = PlaneAgreement::of(*id, *points, common, &seen)?;
            agreement.all.merge(&plane.calibration)?;
            agreement.scatter.squared += plane.scatter.squared;
            agreement.scatter.degrees += plane.scatter.degrees;
            agreement.planes.push(plane);
        }
        Ok(agreement)
    }
}

/// What one scan says of a plane, and how much that weighs.
struct Voice {
    seen: Seen,
    information: DMat3,
}

impl PlaneAgreement {
    fn of(
        id: PlaneId,
        points: u64,
        common: &Common,
        sightings: &[(usize, &Sighting)],
    ) -> Result<Self, TrialError> {
        let mut calibration = Calibration::new(3)?;
        let mut voices = Vec::new();
        for (scan, sighting) in sightings {
            let seen = common.seen(&sighting.estimate);
            match inverse(seen.covariance) {
                Some(information) => voices.push((*scan, *sighting, Voice { seen, information })),
                None => calibration.refuse(),
            }
        }
        let all = || voices.iter().map(|(_, _, voice)| voice);
        let mut scatter = Scatter::default();
        if let Some((mean, _)) = mean(all()) {
            for voice in all() {
                let apart = voice.seen.at - mean;
                scatter.squared += apart.dot(voice.information * apart);
                scatter.degrees += 3;
            }
            scatter.degrees = scatter.degrees.saturating_sub(3);
        }
        let mut residuals = Vec::new();
        for (own, (scan, sighting, voice)) in voices.iter().enumerate() {
            let others = all().enumerate().filter(|(other, _)| *other != own).map(|(_, voice)| voice);
            let Some((mean, covariance)) = mean(others) else {
                calibration.refuse();
                continue;
            };
            let difference = (voice.seen.at - mean).to_array();
            let covariance = (voice.seen.covariance + covariance).to_cols_array_2d();
            let squared = squared_mahalanobis(difference, covariance);
            match squared {
                Some(squared) => calibration.push(squared)?,
                None => calibration.refuse(),
            }
            residuals.push(Residual {
                scan: *scan,
                points: sighting.points,
                columns: sighting.estimate.columns,
                growth: sighting.estimate.growth,
                reduced_chi_squared: sighting.estimate.reduced_chi_squared,
                distance: common.distance(&sighting.estimate),
                difference,
                predicted: [0, 1, 2].map(|i| covariance[i][i].sqrt()),
                squared,
            });
        }
        Ok(Self { id, points, calibration, scatter, residuals })
    }
}

/// The mean weighted by information, with its covariance; `None` of nothing.
fn mean<'a>(voices: impl Iterator<Item = &'a Voice>) -> Option<(DVec3, DMat3)> {
    let (sum, information) = voices.fold((DVec3::ZERO, DMat3::ZERO), |(sum, information), voice| {
        (sum + voice.information * voice.seen.at, information + voice.information)
    });
    let covariance = inverse(information)?;
    Some((covariance * sum, covariance))
}
