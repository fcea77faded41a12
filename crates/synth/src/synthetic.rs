//! What a scan of a scene yields.

use crate::merge::{errors_in_world, per_point};
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

    /// All scans as one, in the world: the points where their poses put them, in order. Which sensor saw a point is lost.
    ///
    /// Points keep their errors along the axes of the world: covariances where any scan has covariances, standard errors
    /// per axis where any has those. They are unknown where those of any scan are.
    pub fn merged(&self) -> LabelledScan {
        let points = self.scans.iter().flat_map(|s| s.scan.world_points());
        let points = points.map(|p| p.map_or([f64::NAN; 3], |p| p.position)).collect();
        let labels = self.scans.iter().flat_map(|s| s.labels.iter().copied()).collect();
        let scan = fitting(points, errors_in_world(&self.scans), Frame::World { sensor: None });
        LabelledScan { scan, labels }
    }
}

/// A scan of generated points; equal errors become one.
pub(crate) fn scan(points: Vec<[f64; 3]>, sigmas: Vec<f64>, frame: Frame) -> Scan {
    fitting(points, per_point(sigmas), frame)
}

/// A scan of points and errors that are known to fit each other: generated ones, those of another scan, and those that
/// were checked where they were turned.
///
/// It cannot panic: `perturbed` keeps number, errors and frame of a scan and only takes points away; `chunks` checked its
/// errors with the parameters, and its poses are poses; `errors_in_world` lets no error through that a scan would refuse.
#[expect(clippy::expect_used, reason = "see above")]
pub(crate) fn fitting(points: Vec<[f64; 3]>, sigma: Sigma, frame: Frame) -> Scan {
    Scan::new(points, sigma, frame).expect("the errors fit the points")
}
