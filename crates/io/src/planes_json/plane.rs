//! A plane as it stands in the file.

use serde::{Deserialize, Serialize};
use terrace_types::{Plane, PlaneId};

/// One plane.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlaneRecord {
    /// The plane's number, from 1: its label in `labels.npy`.
    pub id: u32,
    /// What it is, where that is known, as in synthetic scenes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// `[a, b, c, d]` with `a x + b y + c z + d = 0`, unit normal `(a, b, c)`, and `d` in metres.
    pub coefficients: [f64; 4],
    /// Mean of its points, in metres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub centroid: Option<[f64; 3]>,
    /// Standard error of each component of the normal (`s_x`, `s_y`, `s_z`), without unit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub normal_uncertainty: Option<[f64; 3]>,
    /// Covariance of the coefficients (a, b, c, d), of rank 3: without unit, in metres for those of d with another, in m² for
    /// that of d.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub covariance: Option<[[f64; 4]; 4]>,
    /// The same of two tilts and an offset, of full rank.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tilt_offset_covariance: Option<TiltOffset>,
    /// Mean squared distance of its points from it in units of their errors, without unit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reduced_chi_squared: Option<f64>,
    /// What the part of the covariance that comes from points was multiplied by, from 1, without unit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub growth: Option<f64>,
    /// Largest change of each component of the normal by the paper's min-max, without unit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub min_max: Option<[f64; 3]>,
    /// Number of points labelled with it.
    pub points: u64,
    /// Number of grid cells.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cells: Option<u64>,
    /// Area that its points cover, without holes, in square metres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub area: Option<f64>,
    /// Root mean square distance of its points from it, in metres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rms: Option<f64>,
    /// The orientation distance φ at which it was clustered, without unit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub phi: Option<f64>,
    /// The φ at which the same clusters come out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub phi_interval: Option<PhiInterval>,
}

impl PlaneRecord {
    /// A record of a plane with nothing but its number, coefficients and count of points.
    pub fn new(id: PlaneId, plane: &Plane, points: u64) -> Self {
        Self {
            id: id.get(),
            name: None,
            coefficients: plane.coefficients(),
            centroid: None,
            normal_uncertainty: None,
            covariance: None,
            tilt_offset_covariance: None,
            reduced_chi_squared: None,
            growth: None,
            min_max: None,
            points,
            cells: None,
            area: None,
            rms: None,
            phi: None,
            phi_interval: None,
        }
    }

    /// Every number with the name of its field.
    pub(super) fn numbers(&self) -> impl Iterator<Item = (&'static str, f64)> + '_ {
        let named = |name| move |value: &f64| (name, *value);
        let interval = self.phi_interval.iter().flat_map(|i| std::iter::once(i.lo).chain(i.hi));
        let own = self.tilt_offset_covariance.iter().flat_map(TiltOffset::numbers);
        (self.coefficients.iter().map(named("coefficients")))
            .chain(self.centroid.iter().flatten().map(named("centroid")))
            .chain(self.normal_uncertainty.iter().flatten().map(named("normal_uncertainty")))
            .chain(self.covariance.iter().flatten().flatten().map(named("covariance")))
            .chain(own.map(named("tilt_offset_covariance")))
            .chain(self.reduced_chi_squared.iter().map(named("reduced_chi_squared")))
            .chain(self.growth.iter().map(named("growth")))
            .chain(self.min_max.iter().flatten().map(named("min_max")))
            .chain(self.area.iter().map(named("area")))
            .chain(self.rms.iter().map(named("rms")))
            .chain(self.phi.iter().map(named("phi")))
            .chain(interval.map(|value| ("phi_interval", value)))
    }
}

/// The covariance of a plane in coordinates of its own.
///
/// ```
/// use terrace_io::planes_json::TiltOffset;
///
/// let floor = TiltOffset {
///     at: [2.0, 1.0, 0.0],
///     axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
///     matrix: [[4e-8, 0.0, 0.0], [0.0, 1e-8, 0.0], [0.0, 0.0, 9e-6]],
/// };
/// assert!((floor.largest_tilt() - 0.0002).abs() < 1e-12 && (floor.offset() - 0.003).abs() < 1e-12);
/// // Ten metres away along the first axis, tilt counts as well.
/// assert!((floor.distance([12.0, 1.0, 0.0]) - 13e-6_f64.sqrt()).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct TiltOffset {
    /// The point of the plane that the offset is measured at, in metres.
    pub at: [f64; 3],
    /// Unit vectors e₁ and e₂ in the plane, at right angles.
    pub axes: [[f64; 3]; 2],
    /// Covariance of (tilt₁, tilt₂, offset), radians and metres: the true normal is `n + tilt₁ e₁ + tilt₂ e₂`, and the true
    /// plane lies `offset` further along n at `at`, to first order.
    pub matrix: [[f64; 3]; 3],
}

impl TiltOffset {
    /// Standard error of the tilt in the direction where it is largest, in radians.
    pub fn largest_tilt(&self) -> f64 {
        let [[a, b, _], [_, c, _], _] = self.matrix;
        (f64::midpoint(a, c) + ((a - c) / 2.0).hypot(b)).max(0.0).sqrt()
    }

    /// Standard error of the offset at [`at`](Self::at), in metres.
    pub fn offset(&self) -> f64 {
        self.matrix[2][2].max(0.0).sqrt()
    }

    /// Standard error of the signed distance of a point of the world from the plane, in metres. That of the point itself is
    /// not part of it.
    pub fn distance(&self, point: [f64; 3]) -> f64 {
        let away = [0, 1, 2].map(|i| point[i] - self.at[i]);
        let [x, y] = self.axes.map(|axis| axis.iter().zip(away).map(|(e, d)| e * d).sum());
        let change = [x, y, -1.0_f64];
        let rows = self.matrix.iter().zip(change);
        let variance: f64 =
            rows.map(|(row, g)| g * row.iter().zip(change).map(|(m, h)| m * h).sum::<f64>()).sum();
        variance.max(0.0).sqrt()
    }

    fn numbers(&self) -> impl Iterator<Item = &f64> {
        self.at.iter().chain(self.axes.iter().flatten()).chain(self.matrix.iter().flatten())
    }
}

/// The half-open interval `[lo, hi)` of φ on which a result holds; `[lo, hi]` in the file.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(from = "(f64, Option<f64>)", into = "(f64, Option<f64>)")]
pub struct PhiInterval {
    /// The smallest φ.
    pub lo: f64,
    /// The end, not included; `None` (null in the file) when there is none.
    pub hi: Option<f64>,
}

impl From<(f64, Option<f64>)> for PhiInterval {
    fn from((lo, hi): (f64, Option<f64>)) -> Self {
        Self { lo, hi }
    }
}

impl From<PhiInterval> for (f64, Option<f64>) {
    fn from(interval: PhiInterval) -> Self {
        (interval.lo, interval.hi)
    }
}
