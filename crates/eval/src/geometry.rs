//! How far found planes are turned and shifted against the true ones.

use std::collections::BTreeMap;

use terrace_types::{Plane, PlaneId};

use crate::Evaluation;
use crate::evaluation::mean;

/// A plane and the centre of the points it was found in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaneAt {
    /// The plane.
    pub plane: Plane,
    /// Mean of its points in metres, where that is known.
    pub centre: Option<[f64; 3]>,
}

/// How far a found plane is turned and shifted against the true one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaneDeviation {
    /// The true plane.
    pub truth: PlaneId,
    /// The found one.
    pub found: PlaneId,
    /// Angle between the normals without regard to their sign, in radians, 0 to π/2.
    pub angle: f64,
    /// Distance of the found plane from the true one in metres, where the points of the found one are: of the foot of
    /// their centre on the found plane from the true plane. `None` when the centre is not known.
    pub offset: Option<f64>,
}

/// Median, mean and largest of some values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// The value in the middle; of an even number the mean of the two in the middle.
    pub median: f64,
    /// The mean.
    pub mean: f64,
    /// The largest.
    pub max: f64,
}

impl PlaneAt {
    /// Angle (radians) and offset (metres) of this found plane against a true one, as in [`PlaneDeviation`].
    pub fn against(&self, truth: &Plane) -> (f64, Option<f64>) {
        let ([a, b, c], [p, q, r]) = (truth.normal(), self.plane.normal());
        let cross = [b * r - c * q, c * p - a * r, a * q - b * p];
        let angle = cross.iter().map(|x| x * x).sum::<f64>().sqrt().atan2((a * p + b * q + c * r).abs());
        let offset = self.centre.map(|[x, y, z]| {
            let off = self.plane.signed_distance([x, y, z]);
            truth.signed_distance([x - off * p, y - off * q, z - off * r]).abs()
        });
        (angle, offset)
    }
}

impl Evaluation {
    /// Angle and offset of the planes that match above one half, in the order of the true ones. Pairs of which one is not
    /// among the given planes are left out.
    pub fn deviations(
        &self,
        truth: &BTreeMap<PlaneId, Plane>,
        found: &BTreeMap<PlaneId, PlaneAt>,
    ) -> Vec<PlaneDeviation> {
        let deviation = |true_plane: PlaneId, found_plane: PlaneId| {
            let (angle, offset) = found.get(&found_plane)?.against(truth.get(&true_plane)?);
            Some(PlaneDeviation { truth: true_plane, found: found_plane, angle, offset })
        };
        self.planes.iter().filter_map(|plane| deviation(plane.truth, plane.found?)).collect()
    }
}

impl Spread {
    /// Of these values; `None` of nothing.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut values: Vec<f64> = values.into_iter().collect();
        values.sort_unstable_by(f64::total_cmp);
        let max = *values.last()?;
        let upper = *values.get(values.len() / 2)?;
        let lower = *values.get((values.len() - 1) / 2)?;
        Some(Self { median: f64::midpoint(lower, upper), mean: mean(values.into_iter())?, max })
    }
}
