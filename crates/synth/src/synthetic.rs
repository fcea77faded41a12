//! What a scan of a scene yields.

use terrace_types::{Frame, Plane, PlaneId, Scan, Sigma};

/// A scan whose points know their planes.
#[derive(Debug, Clone, PartialEq)]
pub struct LabelledScan {
    /// The points, in the frame of the sensor where there is one.
    pub scan: Scan,
    /// For each point the plane of the surface it was measured on; `None` on curved things and narrow trim.
    pub labels: Vec<Option<PlaneId>>,
}

/// A true plane and what the scan saw of it.
#[derive(Debug, Clone, PartialEq)]
pub struct TruePlane {
    /// Its identity in the labels.
    pub id: PlaneId,
    /// What it is, in English.
    pub name: &'static str,
    /// Where it is in the world; the normal points to the side from which it is seen.
    pub plane: Plane,
    /// Mean of the points before noise, in the world; `None` when no point fell on it.
    pub centroid: Option<[f64; 3]>,
    /// Number of points labelled with it.
    pub points: usize,
}

/// Scans of a scene, with the truth.
#[derive(Debug, Clone, PartialEq)]
pub struct Synthetic {
    /// One scan for each view that has points.
    pub scans: Vec<LabelledScan>,
    /// All planes of the scene, by identity, seen or not.
    pub planes: Vec<TruePlane>,
}

impl Synthetic {
    /// Number of points over all scans.
    pub fn points(&self) -> usize {
        self.scans.iter().map(|s| s.labels.len()).sum()
    }

    /// All scans as one, in the world: the points where their poses put them, in order, with their errors. Which sensor
    /// saw a point is lost.
    pub fn merged(&self) -> LabelledScan {
        let mut points = Vec::with_capacity(self.points());
        let mut sigmas = Vec::with_capacity(self.points());
        for LabelledScan { scan, .. } in &self.scans {
            for p in scan.world_points() {
                points.push(p.map_or([f64::NAN; 3], |p| p.position));
                // Errors of synthetic scans are the same along all axes.
                sigmas.push(p.and_then(|p| p.sigma).map_or(0.0, |s| s[0]));
            }
        }
        let labels = self.scans.iter().flat_map(|s| s.labels.iter().copied()).collect();
        LabelledScan { scan: scan(points, sigmas, Frame::World { sensor: None }), labels }
    }
}

/// A scan of generated points; equal errors become one.
#[expect(
    clippy::expect_used,
    reason = "the errors are as many as the points and were checked with the parameters"
)]
pub(crate) fn scan(points: Vec<[f64; 3]>, sigmas: Vec<f64>, frame: Frame) -> Scan {
    let sigma = match sigmas.first() {
        Some(first) if sigmas.iter().all(|s| s.to_bits() == first.to_bits()) => Sigma::Uniform(*first),
        _ => Sigma::PerPoint(sigmas),
    };
    Scan::new(points, sigma, frame).expect("generated errors fit generated points")
}
