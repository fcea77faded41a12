//! Places whose planes are known.

use terrace_noise::SensorNoise;
use terrace_normals::fit_plane;
use terrace_stats::{Stats, UncertainVector};
use terrace_synth::{LabelledScan, Params, perturbed, stated};
use terrace_types::{Plane, PlaneId, Sigma};

use crate::TrialError;

/// A plane as it really is.
#[derive(Debug, Clone, PartialEq)]
pub struct KnownPlane {
    /// Its label.
    pub id: PlaneId,
    /// What it is.
    pub name: String,
    /// Where it is.
    pub plane: Plane,
}

/// A place with known planes, of which noisy copies can be made.
#[derive(Debug, Clone)]
pub enum KnownPlace {
    /// A built scene: each copy samples its surfaces anew.
    Built {
        /// The scene.
        scene: Box<terrace_synth::Scene>,
        /// Points of a copy; `None`: as many as the scene has by itself.
        points: Option<usize>,
    },
    /// Scans whose points are exact: each copy has the same points, moved by its own noise.
    Given {
        /// The scans, with the plane of each point.
        scans: Vec<LabelledScan>,
        /// The planes of the labels.
        planes: Vec<KnownPlane>,
    },
}

/// How the points of a copy are wrong.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PointNoise {
    /// As the scene or the scans themselves say.
    Own,
    /// As a model of the sensor says; it is told the measured points, as in real use.
    Model(SensorNoise),
}

impl KnownPlace {
    /// Exact scans whose planes are those of least squares through the points of each label; labels of fewer than three points,
    /// or of points on a line, have none.
    pub fn of_exact_scans(scans: Vec<LabelledScan>) -> Self {
        let mut sums: Vec<Option<Stats>> = Vec::new();
        for LabelledScan { scan, labels } in &scans {
            for (point, label) in scan.world_points().zip(labels) {
                let (Some(point), Some(label)) = (point, label) else { continue };
                if sums.len() <= label.index() {
                    sums.resize(label.index() + 1, None);
                }
                if let Some(sum) = sums.get_mut(label.index()) {
                    sum.get_or_insert(Stats::new(point.position))
                        .push(&UncertainVector::exact(point.position));
                }
            }
        }
        let planes = sums.iter().enumerate().filter_map(|(index, sum)| {
            let id = PlaneId::from_index(index)?;
            let fit = fit_plane(sum.as_ref()?).ok()?;
            let plane = Plane::through(fit.centroid, fit.normal).ok()?;
            Some(KnownPlane { id, name: format!("plane {id}"), plane })
        });
        let planes = planes.collect();
        Self::Given { scans, planes }
    }

    /// The planes.
    pub fn planes(&self) -> Vec<KnownPlane> {
        match self {
            Self::Built { scene, .. } => {
                let known = |p: &terrace_synth::ScenePlane| KnownPlane {
                    id: p.id,
                    name: p.name.to_owned(),
                    plane: p.plane,
                };
                scene.planes().iter().map(known).collect()
            }
            Self::Given { planes, .. } => planes.clone(),
        }
    }

    /// One noisy copy, each scan with the errors it was drawn with. The same copy for the same seed and number.
    pub(crate) fn copy(
        &self,
        noise: PointNoise,
        seed: u64,
        copy: u64,
    ) -> Result<Vec<LabelledScan>, TrialError> {
        let drawn = seed.wrapping_add(copy.wrapping_mul(0x9E37_79B9_7F4A_7C15));
        let made;
        let (exact, axis) = match (self, noise) {
            (Self::Built { scene, points }, PointNoise::Own) => {
                return Ok(scene.generate(&Params { points: *points, sigma: None, seed: drawn })?.scans);
            }
            (Self::Built { scene, points }, PointNoise::Model(_)) => {
                made = scene.generate(&Params { points: *points, sigma: Some(0.0), seed: drawn })?.scans;
                (&made, scene.optical_axis())
            }
            (Self::Given { scans, .. }, _) => (scans, None),
        };
        exact
            .iter()
            .zip(0..)
            .map(|(LabelledScan { scan, labels }, stream)| {
                let scan = match noise {
                    PointNoise::Own if *scan.sigma() == Sigma::Unknown => return Err(TrialError::NoErrors),
                    PointNoise::Own => perturbed(scan, drawn, stream),
                    PointNoise::Model(model) => {
                        let moved = perturbed(&stated(scan, &model, axis)?, drawn, stream);
                        stated(&moved, &model, axis)?
                    }
                };
                Ok(LabelledScan { scan, labels: labels.clone() })
            })
            .collect()
    }
}
